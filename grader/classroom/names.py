"""Names of students: how to compare different spellings, and how to use them as names of folders."""

from __future__ import annotations

import hashlib
import re
import unicodedata
from collections import defaultdict
from collections.abc import Iterable
from functools import cache

#: Zero-width (non-)joiners, which Indic and Persian names need between letters (Unicode 15, chapter 23.2).
JOINERS = "\u200c\u200d"

LONGEST = 120


def normal(text: str) -> str:
    """Return a text in Unicode's form NFC: macOS writes é as two characters, other systems as one."""
    return unicodedata.normalize("NFC", text)


def student_id(text: str) -> str:
    """Return `text` as a folder name that is valid on any system: letters with their marks, digits and `.@+-_`."""
    kept = "".join(char if _is_kept(char) else " " for char in normal(text))
    return _cut(re.sub(r"\s+", "_", kept).strip("._" + JOINERS), LONGEST) or "nameless"


def _is_kept(char: str) -> bool:
    # Vowel signs and accents are marks (M): without them, it would be another name.
    return char.isalnum() or char in ".@+-_" + JOINERS or unicodedata.category(char).startswith("M")


def _cut(text: str, most: int) -> str:
    while len(text.encode("utf-8", errors="replace")) > most:
        text = text[:-1]
    return text


def unique_ids(names: Iterable[str]) -> dict[str, str]:
    """Return a unique id for each name, also on systems that ignore the case of letters."""
    by_id: dict[str, list[str]] = defaultdict(list)
    for name in dict.fromkeys(map(normal, names)):
        by_id[student_id(name).casefold()].append(name)
    ids = {}
    for same in by_id.values():
        for name in same:
            digest = hashlib.sha256(name.encode("utf-8", errors="surrogateescape")).hexdigest()[:6]
            ids[name] = student_id(name) if len(same) == 1 else f"{_cut(student_id(name), LONGEST - 7)}-{digest}"
    return ids


@cache
def comparable(name: str) -> str:
    """Return only the letters and digits, in lower case, to compare names that platforms have shortened."""
    return "".join(char for char in normal(name).casefold() if _is_kept(char) and char not in ".@+-_")
