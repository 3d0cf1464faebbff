"""Several programs in one text: each begins with a line `# file: NAME.py`."""

from __future__ import annotations

import re
from collections.abc import Mapping

_BEGIN = re.compile(r"# file: (?P<name>[a-z_][a-z0-9_]*\.py)\s*")

#: Each is as long as the whole, by its empty lines.
MOST_FILES = 20


def files_in(source: str) -> int:
    """Return how many programs a text has."""
    return sum(1 for line in source.splitlines() if _BEGIN.fullmatch(line))


def parts(source: str) -> dict[str, str]:
    """Return the programs in a text, by their names. What stands before the first one belongs to none.

    Each has as many empty lines in front as it has lines before it, so that line numbers are those of the whole file.
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
    """Return several files as one."""
    texts = (f"# file: {name}\n{code.decode(errors='replace').rstrip()}\n" for name, code in files.items())
    return "\n\n".join(texts)
