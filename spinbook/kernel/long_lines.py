"""Lines that nobody reads to their end, such as a printed image: their beginning is shown, the whole is in a file."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable
from pathlib import Path

#: A line of more characters than this is shortened to so many.
LONGEST, SHOWN = 2_000, 500
_FOLDER = "long_lines"


def whole_in(folder: Path, name: str) -> Callable[[str], str]:
    """Return a function that shortens a line and keeps the whole in `folder`, in a file of this name."""
    file = folder / _FOLDER / f"{re.sub(r'[^A-Za-z0-9_.-]+', '_', name)}.txt"

    def shown(line: str) -> str:
        if len(line) <= LONGEST:
            return line
        file.parent.mkdir(exist_ok=True)
        with file.open("a", encoding="utf-8", errors="replace") as whole:
            whole.write(f"{line}\n")
        return shortened(line, f"; the whole line is in {_FOLDER}/{file.name}")

    return shown


def shortened(line: str, rest_is: str = "") -> str:
    """Return the beginning of a line that is too long to be read; `rest_is` says where the rest is."""
    return line if len(line) <= LONGEST else f"{line[:SHOWN]} … {len(line) - SHOWN:,} more characters{rest_is}"


def with_short_lines(outputs: Iterable[dict[str, object]], shown: Callable[[str], str]) -> None:
    """Shorten the lines of a cell's outputs in place: what it printed, and the text of its result."""
    for output in outputs:
        data = output.get("data")
        holder, key = (data, "text/plain") if isinstance(data, dict) else (output, "text")
        if isinstance(text := holder.get(key), str) and len(text) > LONGEST:
            holder[key] = "\n".join(map(shown, text.split("\n")))
