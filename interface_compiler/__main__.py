"""`python -m interface_compiler`: install what every environment has, for setup.sh."""

from __future__ import annotations

import sys

from interface_compiler import shipped, toolchain
from interface_compiler.definition import CompileError
from interface_compiler.wheel import install


def main() -> int:
    """Install the standard packages that are missing or out of date; 3 if this machine can't compile them.

    With the word `needs`, only name the packages of Debian and Ubuntu that a compiler needs.
    """
    if sys.argv[1:] == ["needs"]:
        print(*toolchain.debian_packages())
        return 0
    if reason := toolchain.missing():
        print(reason, file=sys.stderr)
        return 3
    try:
        for package in shipped.standard():
            install(package)
    except CompileError as error:
        print(error, file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
