#!/bin/sh
# Makes the virtual environment $VENV from the pinned and hashed files $LOCKS. Called by the Makefile.
set -eu

say() { printf '\n%s\n' "$*" >&2; }

"$PYTHON" - <<'PY' || exit 1
import sys
if not (3, 10) <= sys.version_info[:2] <= (3, 14):
    sys.exit(f"Spinbook needs Python 3.10 to 3.14, and this is {sys.version.split()[0]} ({sys.executable}).\n"
             "Name another one: make PYTHON=python3.12 ...")
PY

# Debian and Ubuntu keep `ensurepip` in a package of its own: python3-venv.
if ! "$PYTHON" -c 'import ensurepip, venv' 2>/dev/null; then
    version=$("$PYTHON" -c 'import sys; print("python%d.%d-venv" % sys.version_info[:2])')
    say "Python's venv module is not installed: installing the system package $version."
    if [ "$(id -u)" = 0 ]; then as_root=""; else as_root="sudo -n"; fi
    if ! { $as_root apt-get update -qq && $as_root apt-get install -y -qq --no-install-recommends "$version"; }; then
        say "Could not install $version. Install it yourself, then run make again:
    sudo apt-get install $version"
        exit 1
    fi
fi

# bubblewrap is the grader's best sandbox. Without it the same namespaces are made by other means, so this may fail.
if ! command -v bwrap >/dev/null 2>&1 && [ "$(id -u)" = 0 ] && command -v apt-get >/dev/null 2>&1; then
    { apt-get update -qq && apt-get install -y -qq --no-install-recommends bubblewrap; } >/dev/null 2>&1 ||
        say "bubblewrap could not be installed; the grader will make its sandbox without it (see: spinbook doctor)."
fi

[ -x "$VENV/bin/python" ] || "$PYTHON" -m venv "$VENV"

case "$LOCKS" in
    *constraints-ros.txt*) say "Installing Spinbook's pinned dependencies, with ROS 2 Jazzy from PyPI (about a minute) ..." ;;
    *) say "Installing Spinbook's pinned dependencies; ROS 2 is the one that you have sourced ..." ;;
esac
set --
for lock in $LOCKS; do set -- "$@" -r "$lock"; done
"$VENV/bin/python" -m pip install --quiet --disable-pip-version-check --require-hashes "$@"
"$VENV/bin/python" -m pip install --quiet --disable-pip-version-check --no-deps --no-build-isolation --editable .
