"""Splits a text with several programs: each begins with a line `# file: NAME.py`."""

from __future__ import annotations

import re
from collections.abc import Mapping

_BEGIN = re.compile(r"# file: (?P<name>[a-z_][a-z0-9_]*\.py)\s*")

#: With its empty lines in front, each program is nearly as long as the whole text.
MOST_FILES = 20


def files_in(source: str) -> int:
    """Return the number of programs in a text."""
    return sum(1 for line in source.splitlines() if _BEGIN.fullmatch(line))


def parts(source: str) -> dict[str, str]:
    """Return the programs in a text, by name. The text before the first one belongs to none of them.

    Empty lines replace the text before a program, so its line numbers are those of the whole file.
    """
    found: dict[str, list[str]] = {}
    current: list[str] | None = None
    for number, line in enumerate(source.splitlines()):
        if begins := _BEGIN.fullmatch(line):
            current = found.setdefault(begins["name"], [""] * number)
        if current is not None:
            current.append(line)
    return {name: "\n".join(lines) + "\n" for name, lines in found.items()}


def joined(files: Mapping[str, bytes]) -> str:
    """Return several files as one text."""
    texts = (f"# file: {name}\n{code.decode(errors='replace').rstrip()}\n" for name, code in files.items())
    return "\n\n".join(texts)
