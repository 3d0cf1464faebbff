#!/usr/bin/env bash
# Runs once, when Gradescope builds the container or another runner is prepared: installs Python, the sandbox, the grader and ROS 2 from PyPI.
set -euo pipefail
EXERCISE=@EXERCISE@
ISOLATION=@ISOLATION@
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)

missing=()
python3 -c 'import ensurepip, venv' 2>/dev/null || missing+=(python3 python3-venv)
command -v bwrap >/dev/null || missing+=(bubblewrap)
if [ "${#missing[@]}" -gt 0 ]; then
    as_root=
    if [ "$(id -u)" != 0 ]; then as_root="sudo -n"; fi
    $as_root apt-get update -qq
    $as_root env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends "${missing[@]}"
fi

# Nothing is built. A checkout's pins have hashes; an installed Spinbook only knows the versions that it ran with. The
# other wheels are what would have to be compiled: the grader's middleware, the course's interfaces, and those that PyPI
# lacks. Python compiles what it runs.
python3 -m venv "$here/venv"
pip() { "$here/venv/bin/python" -m pip --quiet --disable-pip-version-check "$@"; }
pins=$here/course/pins.txt
software=$(echo "$here"/course/spinbook-*.whl)
if grep -q -e --hash= "$pins"; then
    pip install --no-compile --no-deps --require-hashes --only-binary :all: -r "$pins"
    pip install --no-compile --no-deps "$software"
else
    pip install --no-compile -c "$pins" "$software[grade]"
fi
pip install --no-compile --no-deps "$here"/course/wheels/*.whl
# What the exercise lets programs use, in the versions with which its solution ran.
if [ -e "$here/course/packages.txt" ]; then pip install -r "$here/course/packages.txt"; fi

# Test that grading works here, and store what the solution publishes. Problems are in the build's output.
"$here/venv/bin/python" -I -m grader.gradescope.run prepare "$here/course/exercises/$EXERCISE" $ISOLATION
