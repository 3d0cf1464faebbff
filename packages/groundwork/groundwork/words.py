"""Words in messages."""

from __future__ import annotations

import difflib
import unicodedata
from collections.abc import Iterable


def counted(number: int, noun: str) -> str:
    """Return `1 student` or `2 students`, `1 entry` or `2 entries`."""
    if number == 1:
        return f"1 {noun}"
    if noun.endswith("y") and noun[-2] not in "aeou":
        return f"{number} {noun[:-1]}ies"
    return f"{number} {noun}s"


def similar(name: str, known: Iterable[str], cutoff: float = 0.6) -> str:
    """Return the most similar of the `known` names; "" if none is as alike as `cutoff` (0 to 1)."""
    return next(iter(difflib.get_close_matches(name, list(known), n=1, cutoff=cutoff)), "")


def did_you_mean(name: str, known: Iterable[str], otherwise: str, shown: str = "{}", cutoff: float = 0.6) -> str:
    """Return the question whether the most similar of the `known` names was meant; `otherwise` if none is similar.

    `shown` is how the name is written, such as "`{}`".
    """
    near = similar(name, known, cutoff)
    return f"Did you mean {shown.format(near)}?" if near else otherwise


def look_alike(text: str, expected: str) -> str:
    """Return a sentence on the character because of which `text` is not `expected`, although both look the same.

    "" if there is none, or if nothing is expected.
    """
    bare = "".join(filter(str.isascii, text))
    replaced = len(text) == len(expected) and all(
        not a.isascii() or a == b for a, b in zip(text, expected, strict=True)
    )
    looks_alike = bool(expected) and expected.isascii() and (bare == expected or replaced)
    return beyond_ascii(text, "is easily overlooked: type it again") if looks_alike else ""


def beyond_ascii(text: str, what: str) -> str:
    """Return a sentence that names the first character beyond ASCII, and says this of it; "" if there is none."""
    strange = next((char for char in text if not char.isascii()), "")
    if not strange:
        return ""
    name = unicodedata.name(strange, "a character without a name")
    return f"It has the character U+{ord(strange):04X} ({name}), which {what}."
