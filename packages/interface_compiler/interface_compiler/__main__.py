"""`python -m interface_compiler`: called by the scripts that set up an environment.

python -m interface_compiler                        install the packages that PyPI lacks, such as turtlesim
python -m interface_compiler compile FOLDER STORE   compile FOLDER/PACKAGE/{msg,srv,action}/, print the prefix
python -m interface_compiler add PACKAGE            install another package whose definitions come with this one
python -m interface_compiler needs                  print the packages of Debian and Ubuntu that are missing for that
"""

from __future__ import annotations

import sys
from pathlib import Path

from interface_compiler import shipped, toolchain
from interface_compiler.definition import CompileError, DefinitionError, read_folder
from interface_compiler.near import make_current
from interface_compiler.store import ensure
from interface_compiler.wheel import install, needed


def main() -> int:
    """Do what the command line says; the exit code is 3 if this machine can't compile."""
    if sys.argv[1:] == ["needs"]:
        print(*toolchain.debian_packages())
        return 0
    try:
        if sys.argv[1:2] == ["compile"]:
            _compile(Path(sys.argv[2]), Path(sys.argv[3]))
        else:
            for package in sys.argv[2:] if sys.argv[1:2] == ["add"] else shipped.standard():
                _add(package)
    except (CompileError, DefinitionError) as error:
        print(error, file=sys.stderr)
        return 3 if isinstance(error, CompileError) and toolchain.missing() else 1
    return 0


def _add(package: str) -> None:
    """Install a package that comes with this one, after those that it needs."""
    known = shipped.known()
    if package not in known:
        raise CompileError(f"There is no package {package!r} to add. There are: {', '.join(known)}.")
    for each in (*needed(package), package):
        install(each)


def _compile(folder: Path, store: Path) -> None:
    """Compile the definitions in a folder, if it has any, and make them the store's current ones."""
    definitions, faults = read_folder(folder, folder.parent)
    if faults:
        raise DefinitionError(faults)
    if definitions:
        prefix = ensure(definitions, store).prefix
        make_current(store, prefix)
        print(prefix)


if __name__ == "__main__":
    sys.exit(main())
