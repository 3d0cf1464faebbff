"""The hints that belong to what a recording shows, and to how a run ended. Their texts are in hints.md."""

from __future__ import annotations

import builtins
import pkgutil
import re
from functools import cache


def hints(name: str, **words: str) -> tuple[str, str]:
    """Return where to look and what to do, with `words` in place of those in braces.

    Raises KeyError if hints.md has no section of this name.
    """
    where, todo = texts()[name]
    for word, text in words.items():
        where, todo = where.replace(f"{{{word}}}", text), todo.replace(f"{{{word}}}", text)
    return where, todo


#: What a program without an exception does, by how its run ended.
_DOES = {
    "did-not-start": "does not start",
    "crashed": "ends",
    "timed-out": "stops responding",
    "over-limit": "does something without end",
}


def hints_of_ending(outcome: str, message: str = "", line: int | None = None) -> tuple[str, str]:
    """Return where to look and what to do if a program ended, which a student may read even of a hidden check.

    Of an exception in `message`, they have the line, and the class if that is Python's own.
    """
    if not (message or line):
        return hints("ended", does=_DOES.get(outcome, "ends"))
    number = line or next(iter(re.findall(r" in line (\d+)\b", message)), "")
    known = (name for name in re.findall(r"\b[A-Z]\w+", message) if isinstance(getattr(builtins, name, None), type))
    error = f"Line {number} ends with {next(known, 'an exception')}." if number else "Which line raises this exception?"
    return hints("exception", error=error)


@cache
def texts() -> dict[str, tuple[str, str]]:
    """Return the two paragraphs of each section of hints.md, each on one line."""
    content = pkgutil.get_data(__package__, "hints.md")  # in a page, this package is in an archive
    assert content
    sections = re.split(r"^## (\w+)$", content.decode(), flags=re.MULTILINE)[1:]
    return dict(zip(sections[::2], map(_paragraphs, sections[1::2]), strict=True))


def _paragraphs(section: str) -> tuple[str, str]:
    where, todo = (" ".join(paragraph.split()) for paragraph in section.strip().split("\n\n"))
    return where, todo
