#!/bin/sh
# Makes the virtual environment in which everything runs. `make` calls this first each time; when nothing has
# changed it does nothing. Set by the caller, all optional:
#   PYTHON  the Python to use    (default: the environment's own, else python3 or a faster build of its version)
#   VENV    where to make it     (default: .venv)
#   TESTS   not empty: install what the tests and linters need, too
#
# What an environment was made for is written into $VENV/.spinbook, its pins last of all. Made for another Python, place
# or ROS 2, it is made anew; with other pins, it is brought up to date; without pins, an interrupted set-up goes on.
set -eu
cd "$(dirname "$0")"
VENV=${VENV:-.venv}
VENV=${VENV%/}
MARK=$VENV/.spinbook
LOG=$VENV/setup.log

# Root's environment is for students' programs, too, which run as another user.
umask 022

say() { printf '%s\n' "$@" >&2; }
fail() { say "" "$@"; exit 1; }

# Another environment's wheels mark what they have done to LD_LIBRARY_PATH; each Python here does it for itself. What
# another installation has set would keep Python from starting, or hide its modules; a sourced ROS 2 gets its path back.
MODULES=${PYTHONPATH:-}
unset _ROS_WHEELS_BOOTSTRAP_COMPLETE PYTHONPATH PYTHONHOME PYTHONSTARTUP PYTHONINSPECT PYTHONOPTIMIZE PYTHONWARNINGS LD_PRELOAD

refuse_read_only() {
    if [ -w . ]; then return; fi
    fail "This checkout can't be written: $(pwd -P)
Set-up and make write into it (.venv, build, spinbook.egg-info). Copy it to a folder of yours, and run make there."
}

# An environment runs the checkout that it was made in. Another checkout's may be in use.
refuse_another_checkouts() {
    other=$(cat "$VENV/.checkout" 2>/dev/null || true)
    if [ -z "$other" ] || [ "$other" = "$(pwd -P)" ] || ! [ -e "$other/setup.sh" ]; then return; fi
    fail "$VENV is the environment of another checkout, $other, so it is left alone.
Name another place: make VENV=/some/place ..."
}

refuse_bad_folder() {
    case "$VENV" in /*) place=$VENV ;; *) place=$(pwd -P)/$VENV ;; esac
    case "$(pwd -P)$place" in
        *[[:space:]:]*)
            fail "Spinbook can't be set up in a path with a space or a colon: colcon and ROS's search paths fall apart there.
    here:         $(pwd -P)
    environment:  $place
Move the folder, then run make again." ;;
    esac
    # Only what this script has made is ever removed.
    if [ -d "$VENV" ] && [ ! -e "$MARK" ] && [ -n "$(ls -A "$VENV")" ]; then
        fail "$VENV is a folder that Spinbook's set-up has not made, so it is left alone.
Remove it, or name another one: make VENV=/some/place ..."
    fi
}

# Two makes at once: the second waits for the first.
wait_for_turn() {
    if command -v flock >/dev/null 2>&1; then
        exec 9<setup.sh
        flock -n 9 || { say "Another set-up is under way here: waiting for it ..."; flock 9; }
    fi
}

made_for() { sed -n "s/^$1 //p" "$MARK" 2>/dev/null || true; }

choose_python() {
    faster=no
    if [ -z "${PYTHON:-}" ]; then
        PYTHON=$(made_for python)
        if [ -z "$PYTHON" ] || ! [ -x "$PYTHON" ]; then PYTHON=python3 faster=wanted; fi
    fi
    command -v "$PYTHON" >/dev/null 2>&1 ||
        fail "There is no '$PYTHON' here. Install Python 3.10 to 3.14 (sudo apt-get install python3), or name one:
    make PYTHON=python3.12 ..."
    [ "$("$PYTHON" -c 'print("Python")' 2>/dev/null)" = Python ] ||
        fail "'$PYTHON' is not a Python that works. Name another one: make PYTHON=python3.12 ..."
    "$PYTHON" - <<'PY' || exit 1
import sys
if not (3, 10) <= sys.version_info[:2] <= (3, 14):
    sys.exit("\nSpinbook needs Python 3.10 to 3.14, and '%s' is %s.\nName another one: make PYTHON=python3.12 ..."
             % (sys.executable, sys.version.split()[0]))
PY
    # An environment is made from the Python that stands behind the active one, if there is one.
    if [ "$("$PYTHON" -c 'import sys; print(sys.prefix != sys.base_prefix)')" = True ]; then
        PYTHON=$("$PYTHON" -c 'import sys; print(sys._base_executable)')
    fi
    if [ "$faster" = wanted ]; then prefer_faster_build; fi
}

# The same version: which one that is, is the caller's choice.
prefer_faster_build() {
    build=$("$PYTHON" -I spinbook/doctor/python_build.py)
    if [ -z "$build" ]; then return; fi
    say "python3 was compiled without optimizations. This uses $build, which runs programs a quarter faster.
To use python3 all the same: make PYTHON=python3 ..."
    PYTHON=$build
}

read_wishes() {
    wanted=$("$PYTHON" -c 'import os, sys; print("python", os.path.realpath(sys.executable))')
    ros=$(PYTHONPATH=$MODULES "$PYTHON" -I spinbook/doctor/ros_origin.py) || exit 1
    if [ "$ros" != wheels ]; then export PYTHONPATH="$MODULES"; fi
    wanted=$(printf '%s\nplace %s\nros %s' "$wanted" "$place" "$ros")
    LOCKS=constraints.txt
    # Nothing may shadow a sourced ROS 2, so its wheels are then left out.
    if [ "$ros" = wheels ]; then LOCKS="$LOCKS constraints-ros.txt"; fi
    pins=$(cat $LOCKS pyproject.toml | cksum)
    # What the interfaces are compiled from; where ROS 2 is sourced, its own tools compile them.
    interfaces=none
    if [ "$ros" = wheels ]; then
        interfaces=$(find packages/interface_compiler/interface_compiler -name __pycache__ -prune -o -type f -print 2>/dev/null | LC_ALL=C sort |
            while read -r file; do echo "$file"; cat "$file"; done | cksum)
    fi
}

need_venv_module() {
    if "$PYTHON" -c 'import ensurepip, venv' 2>/dev/null; then return; fi
    # Debian and Ubuntu keep ensurepip in a package of its own.
    package=$("$PYTHON" -c 'import sys; print("python%d.%d-venv" % sys.version_info[:2])')
    command -v apt-get >/dev/null 2>&1 ||
        fail "'$PYTHON' has no ensurepip, so it can't make virtual environments. Name another one: make PYTHON=python3.12 ..."
    say "Python's venv module is not installed: installing the system package $package ..."
    install_system "$package" ||
        fail "It could not be installed from here. Install it, then run make again:
    sudo apt-get install $package"
}

# Whether these packages of Debian's or Ubuntu's could be installed.
install_system() {
    command -v apt-get >/dev/null 2>&1 || return 1
    if [ "$(id -u)" = 0 ]; then as_root=""; else as_root="sudo -n"; fi
    { $as_root apt-get update -qq && $as_root apt-get install -y -qq --no-install-recommends "$@"; } >/dev/null 2>&1
}

make_environment() {
    rm -rf "$VENV"
    mkdir -p "$VENV"
    : >"$MARK"
    "$PYTHON" -m venv "$VENV" >"$LOG" 2>&1 || give_up "The virtual environment could not be made."
    begin
}

# From now on, an interrupted set-up goes on where it was.
begin() {
    pwd -P >"$VENV/.checkout"
    printf '%s\n' "$wanted" >"$MARK"
}

# pip sees this environment alone: neither what PYTHONPATH names nor what is set for other uses of pip.
pip() {
    env -u PYTHONPATH -u PIP_TARGET -u PIP_PREFIX -u PIP_CONSTRAINT -u PIP_NO_DEPS PIP_USER=0 \
        "$VENV/bin/python" -m pip --disable-pip-version-check --quiet "$@" >>"$LOG" 2>&1
}

# A package that has moved into packages/ leaves a folder of compiled files behind, which Python would take for the package.
remove_former_packages() {
    for package in packages/*/; do
        former=$(basename "$package")
        if [ -d "$former" ] && [ -z "$(find "$former" -name '*.py' -print -quit)" ]; then rm -rf "$former"; fi
    done
}

install_pins() {
    # First the pinned setuptools: with it empy is built, the only one of them for which PyPI has no wheel.
    awk '/^[^ #]/ { on = /^setuptools==/ } on' constraints.txt >"$VENV/build-tool.txt"
    pip install --require-hashes --only-binary :all: -r "$VENV/build-tool.txt" ||
        give_up "Dependencies could not be installed."
    # In batches, so that an interrupted set-up has those that were finished.
    rm -f "$VENV"/pins-*.txt
    cat $LOCKS | awk -v place="$VENV" '/^[^ #]/ { file = sprintf("%s/pins-%02d.txt", place, count / 50); count += 1 } file { print >file }'
    for batch in "$VENV"/pins-*.txt; do install_batch "$batch"; done
    pip install --no-deps --no-build-isolation --editable . || give_up "Spinbook itself could not be installed."
}

# The pins are all that is needed: pip need not look for more, which it would want hashes of. A batch in which pip was
# killed may have half a package, so it is installed again.
install_batch() {
    again=
    if [ -e "$1.unfinished" ]; then again=--force-reinstall; fi
    : >"$1.unfinished"
    pip install $again --no-deps --require-hashes --only-binary :all: --no-binary empy --no-build-isolation --use-pep517 -r "$1" ||
        give_up "Dependencies could not be installed."
    rm "$1.unfinished"
}

# What only tests and linters need is more than a quarter of everything, so courses do without.
install_for_tests() {
    if [ -z "${TESTS:-}" ]; then return; fi
    pins_of_tests=$(cksum <constraints-test.txt)
    if [ "$(cat "$VENV/.tests" 2>/dev/null)" = "$pins_of_tests" ]; then return; fi
    say "Installing what the tests need ..."
    cp constraints-test.txt "$VENV/pins-of-tests.txt"
    install_batch "$VENV/pins-of-tests.txt"
    printf '%s\n' "$pins_of_tests" >"$VENV/.tests"
}

# What ended it, from the log: pip's errors, then what to do.
give_up() {
    say "" "$1" ""
    { grep -E '^ *(ERROR|error|[A-Za-z.]*Error):' "$LOG" || tail -n 5 "$LOG"; } | cut -c 1-300 | head -n 8 >&2
    if grep -q CERTIFICATE_VERIFY_FAILED "$LOG"; then
        say "" "Python does not trust the certificate of this network. Name the file with its authorities: export PIP_CERT=/etc/ssl/certs/..."
    elif grep -qiE 'connection|name resolution|max retries|timed out|proxy' "$LOG"; then
        say "" "PyPI can't be reached. Is there a network? Behind a proxy: export HTTPS_PROXY=...; with a mirror: export PIP_INDEX_URL=..."
    elif grep -q 'DO NOT MATCH THE HASHES' "$LOG"; then
        say "" "A download is not the file that was pinned. Try again; if it stays so, something on the way alters it."
    elif grep -qi 'no space left' "$LOG"; then
        say "" "The disk is full: about 0.8 GB is needed in $VENV, and as much for a moment in ${TMPDIR:-/tmp}."
    fi
    say "" "The whole log: $LOG. Run make again when it is fixed; set-up goes on where it was."
    exit 1
}

# It is ready when rclpy really loads, whichever it is.
try_ros() {
    "$VENV/bin/python" -c '
import os, sys
from groundwork.clean_environment import without_foreign
test = "import spinbook, std_msgs.msg, rclpy.impl.implementation_singleton"
os.execve(sys.executable, [sys.executable, "-c", test], without_foreign(dict(os.environ)))' >>"$LOG" 2>&1 && return
    : >"$MARK"  # what is installed may be damaged, so the next set-up starts over
    case "$ros" in
        wheels) give_up "Everything is installed, but ROS 2's Python library does not load." ;;
        *) give_up "The sourced ROS 2 (${ros#sourced }) does not load in $VENV. Was its setup file sourced in this terminal?" ;;
    esac
}

# The grader's own middleware is C++. It is compiled here, and again when its sources have changed. Chapters run without
# it, so a failure ends nothing.
compile_middleware() {
    middleware=packages/rmw_lockstep/rmw_lockstep
    sources=$(cat $middleware/*.py $middleware/lockstep/* $middleware/src/* 2>/dev/null | cksum)
    if [ "$(cat "$VENV/.middleware" 2>/dev/null)" = "$sources" ]; then return; fi
    if [ "$1" != anew ]; then say "Compiling the grader's middleware ..."; fi
    if said=$(build_middleware) || { install_compiler && said=$(build_middleware); }; then
        printf '%s\n' "$sources" >"$VENV/.middleware"
    else
        say "$said" "Until then nothing can be graded or checked. $WITHOUT"
    fi
}

WITHOUT="A release's wheels need no compiler: docs/installing.md."

build_middleware() { "$VENV/bin/python" -m rmw_lockstep.build 2>&1; }

install_compiler() {
    if command -v "${CXX:-g++}" >/dev/null 2>&1 || ! command -v apt-get >/dev/null 2>&1; then return 1; fi
    say "The C++ compiler is not installed: installing the system package g++ ..."
    install_system g++
}

# What was compiled elsewhere, for machines without a compiler.
install_wheels() {
    for wheel in wheels/*-manylinux*.whl; do
        if [ -e "$wheel" ]; then pip install --no-deps --no-index "$wheel" || say "$wheel does not fit this computer."; fi
    done
}

# The interfaces that PyPI lacks: example_interfaces, tf2_msgs and turtlesim. A failure ends nothing.
compile_interfaces() {
    if [ "$ros" != wheels ]; then return; fi
    say "Compiling example_interfaces, tf2_msgs and turtlesim: about 20 seconds ..."
    code=0
    "$VENV/bin/python" -m interface_compiler >"$VENV/interfaces.txt" 2>&1 || code=$?
    if [ "$code" = 3 ]; then
        needs=$("$VENV/bin/python" -m interface_compiler needs)
        if [ -n "$needs" ] && install_system $needs; then
            code=0
            "$VENV/bin/python" -m interface_compiler >"$VENV/interfaces.txt" 2>&1 || code=$?
        fi
    fi
    if [ "$code" = 0 ]; then return; fi
    interfaces=missing
    say "$(cat "$VENV/interfaces.txt")" \
        "Until then example_interfaces, tf2_msgs, turtlesim and a course's own interfaces can't be used. $WITHOUT"
}

mark() { printf '%s\npins %s\ninterfaces %s\n' "$wanted" "$pins" "$1"; }

refuse_bad_folder
refuse_another_checkouts
refuse_read_only
wait_for_turn
remove_former_packages
choose_python
read_wishes
if [ "$(cat "$MARK" 2>/dev/null)" = "$(mark "$interfaces")" ] && [ -x "$VENV/bin/python" ]; then
    compile_middleware again
    install_for_tests
    exit 0
fi

made=$(sed '/^interfaces /d' "$MARK" 2>/dev/null || true)
if [ "$made" = "$(mark - | sed '/^interfaces /d')" ] && [ -x "$VENV/bin/python" ]; then
    : # Only the interfaces have changed, or are still missing.
else
    if [ "$(sed '/^pins /d; /^interfaces /d' "$MARK" 2>/dev/null)" = "$wanted" ] && [ -x "$VENV/bin/python" ]; then
        if [ -n "$(made_for pins)" ]; then
            say "The pinned dependencies have changed: bringing $VENV up to date ..."
        else
            say "Going on with the set-up of $VENV that was interrupted ..."
        fi
        begin
        : >"$LOG"
    else
        need_venv_module
        if [ -s "$MARK" ]; then say "$VENV was made for something else ($(made_for ros), $(made_for python)): making it anew."; fi
        case "$ros" in
            wheels) say "Installing Spinbook's pinned dependencies and ROS 2 Jazzy from PyPI into $VENV: about a minute ..." ;;
            *) say "Installing Spinbook's pinned dependencies into $VENV; ROS 2 is the sourced one in ${ros#sourced } ..." ;;
        esac
        make_environment
    fi
    install_pins
    try_ros
    "$VENV/bin/python" -m ros_in_python.path_file >>"$LOG" 2>&1 || give_up "tf2 and its kin could not be installed."
    # Where the file system has no hard links, all works too.
    "$VENV/bin/python" -m spinbook doctor --save-space >>"$LOG" 2>&1 || true
fi
install_wheels
compile_middleware anew
compile_interfaces
pwd -P >"$VENV/.checkout"
mark "$interfaces" >"$MARK"
install_for_tests
