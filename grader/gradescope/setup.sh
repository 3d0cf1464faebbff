#!/usr/bin/env bash
# Runs once, when Gradescope builds the container or another runner is prepared: installs Python, the sandbox, the grader and ROS 2 from PyPI.
#   setup.sh without-trial    without matplotlib, and without testing that grading works here
#   setup.sh plots            adds matplotlib, for programs that use it
set -euo pipefail
EXERCISE=@EXERCISE@
ISOLATION=@ISOLATION@
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)

pip() { "$here/venv/bin/python" -m pip --quiet --disable-pip-version-check install --no-compile "$@"; }
with_hashes="--no-deps --require-hashes --only-binary :all:"
plots() {
    if [ -e pins-plots.txt ]; then pip $with_hashes -r pins-plots.txt; else pip -c pins.txt matplotlib; fi
}
if [ "${1:-}" = plots ]; then
    cd "$here/course"
    plots
    exit
fi

missing=()
python3 -c 'import ensurepip, venv' 2>/dev/null || missing+=(python3 python3-venv)
# Without it, the grader makes the same namespaces itself.
if [ "$ISOLATION" = bubblewrap ] && ! command -v bwrap >/dev/null; then missing+=(bubblewrap); fi
if [ "${#missing[@]}" -gt 0 ]; then
    as_root=
    if [ "$(id -u)" != 0 ]; then as_root="sudo -n"; fi
    $as_root apt-get update -qq
    $as_root env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends "${missing[@]}"
fi

# A half environment must not be taken for one. What is installed at once ends with this.
trap 'status=$?; kill $(jobs -p) 2>/dev/null || true; [ $status = 0 ] || rm -rf "$here/venv"' EXIT
# Debian's and Ubuntu's own pip, as venv would install it, but without compiling all of it: 2 s less.
quick_venv() {
    rm -rf "$here/venv"
    python3 -m venv --without-pip "$here/venv"
    "$here/venv/bin/python" -m zipfile -e /usr/share/python-wheels/pip-*.whl "$here"/venv/lib/python3*/site-packages
    "$here/venv/bin/python" -m pip --version
}
quick_venv >/dev/null 2>&1 || python3 -m venv --clear "$here/venv"

# Nothing is built. A checkout's pins have hashes; an installed Spinbook only knows the versions that it ran with. The
# other wheels are what would have to be compiled: the grader's middleware, the course's interfaces, and those that PyPI
# lacks. Python compiles what it runs.
cd "$here/course"
software=$(echo "$PWD"/spinbook-*.whl)
if [ -e pins-ros.txt ]; then
    # Two at once: one downloads while the other unpacks.
    { pip $with_hashes -r pins-ros.txt && pip --no-deps "$software" wheels/*.whl; } &
    pip $with_hashes -r pins.txt
    wait $!
else
    pip -c pins.txt "$software[grade]" wheels/*.whl
fi
# What the exercise lets programs use, in the versions with which its solution ran.
if [ -e packages.txt ]; then pip -r packages.txt; fi

# Test that grading works here, and store what the solution publishes. Problems are in the build's output.
if [ "${1:-}" != without-trial ]; then
    plots
    "$here/venv/bin/python" -I -m grader.gradescope.run prepare "$here/course/exercises/$EXERCISE" $ISOLATION
fi
