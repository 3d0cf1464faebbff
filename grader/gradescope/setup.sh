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

# Install a wheel with the versions that it ran with, or a checkout with the pinned ones. Hashes are left out, because
# pip would then require one for everything, and a folder has none. The other wheels are what would have to be compiled:
# the grader's middleware, the course's interfaces, and those that PyPI lacks.
software=$(ls "$here"/course/spinbook-*.whl 2>/dev/null || echo "$here/course")
if [ -f "$here/course/pins.txt" ]; then
    cp "$here/course/pins.txt" "$here/pins.txt"
else
    cat "$here/course/constraints.txt" "$here/course/constraints-ros.txt" |
        sed -n 's/^\([A-Za-z0-9].*[^ \\]\) *\\$/\1/p' >"$here/pins.txt"
fi
python3 -m venv "$here/venv"
"$here/venv/bin/python" -m pip install --quiet --disable-pip-version-check -c "$here/pins.txt" \
    "$software[ros]" "$here"/course/wheels/*.whl

# Test that grading works here, and store what the solution publishes. Problems are in the build's output.
"$here/venv/bin/python" -m grader.gradescope.run prepare "$here/course/exercises/$EXERCISE" $ISOLATION
