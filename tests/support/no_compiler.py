"""A PATH on which there is no compiler."""

from __future__ import annotations

import os
import re
from pathlib import Path

_COMPILER = re.compile(r"(.*-)?(gcc|g\+\+|cc|c\+\+|cpp|clang|clang\+\+|c89|c99)(-[\d.]+)?")


def without_compilers(folder: Path) -> str:
    """Make a folder of links to every program on PATH except compilers; return it, for use as PATH."""
    folder.mkdir()
    for place in os.environ["PATH"].split(os.pathsep):
        for program in Path(place).glob("*"):
            link = folder / program.name
            if not _COMPILER.fullmatch(program.name) and not link.is_symlink():
                link.symlink_to(program.absolute())
    return str(folder)
