"""`python -m interface_compiler`: called by the scripts that set up an environment.

python -m interface_compiler                  install what every environment has
python -m interface_compiler install COURSE   the same, and compile the folder interfaces/ of a course
python -m interface_compiler needs            the packages of Debian and Ubuntu that are missing for that
"""

from __future__ import annotations

import sys
from pathlib import Path

from interface_compiler import shipped, toolchain
from interface_compiler.definition import CompileError, DefinitionError, read_folder
from interface_compiler.near import make_current
from interface_compiler.store import ensure
from interface_compiler.wheel import install


def main() -> int:
    """Do what the command line says; the exit code is 3 if this machine can't compile."""
    if sys.argv[1:] == ["needs"]:
        print(*toolchain.debian_packages())
        return 0
    if reason := toolchain.missing():
        print(reason, file=sys.stderr)
        return 3
    try:
        for package in shipped.standard():
            install(package)
        if sys.argv[1:2] == ["install"]:
            _compile(Path(sys.argv[2]))
    except (CompileError, DefinitionError) as error:
        print(error, file=sys.stderr)
        return 1
    return 0


def _compile(course: Path) -> None:
    """Compile the definitions in a course's folder interfaces/, where grading finds them."""
    definitions, faults = read_folder(course / "interfaces", course)
    if faults:
        raise DefinitionError(faults)
    if definitions:
        folder = course / "build" / "interfaces"
        make_current(folder, ensure(definitions, folder).prefix)


if __name__ == "__main__":
    sys.exit(main())
