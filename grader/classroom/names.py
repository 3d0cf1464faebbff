"""Names of students: how to compare different spellings, and how to use them as names of folders."""

from __future__ import annotations

import difflib
import hashlib
import re
import unicodedata
from collections import defaultdict
from collections.abc import Iterable, Iterator
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


@cache
def words(name: str) -> frozenset[str]:
    """Return the words and numbers of a name without what people vary: Müller is Mueller and Muller, 0042 is 42."""
    letters = unicodedata.normalize("NFKD", name.casefold())
    bare = "".join(char for char in letters if not unicodedata.category(char).startswith("M"))
    return frozenset(word.lstrip("0") for word in re.findall(r"[^\W_]+", re.sub("([aou])e", r"\1", bare)))


def may_be_one(name: str, other: str) -> bool:
    """Return whether two names may be one student's: week1-anna and anna, Jorg_Muller and Jörg Müller, ana and anna."""
    mine, theirs = sorted((words(name), words(other)), key=len)
    if not mine or not theirs:
        return False
    if mine <= theirs:
        return True
    joined, others = "".join(sorted(mine)), "".join(sorted(theirs))
    if sorted(re.findall(r"\d+", joined)) != sorted(re.findall(r"\d+", others)):
        return False
    is_login = len(mine) == 1 and any(len(word) > 4 and word in joined for word in theirs)
    slips = difflib.SequenceMatcher(None, joined, others)
    return is_login or (slips.quick_ratio() > 0.85 and slips.ratio() > 0.85)


def without_numbers(name: str) -> frozenset[str]:
    """Return the words of a name without short numbers, dates and the like: those of week1-anna are those of anna."""
    return frozenset(word for word in words(name) if not re.fullmatch(r"[^\W\d]{0,8}\d{1,4}", word))


def same_but_for_numbers(names: Iterable[str]) -> Iterator[list[str]]:
    """Yield names that differ only in short numbers or in capitals, such as week1-anna and week2-anna.

    Names of which nothing else is left, such as s1 and s2, are not meant, nor a whole class of them: team-1 and team-2.
    """
    alike: dict[frozenset[str], list[str]] = defaultdict(list)
    for name in names:
        alike[without_numbers(name)].append(name)
    if len(alike.keys() - {frozenset()}) > 1:
        yield from (same for rest, same in alike.items() if rest and len(same) > 1)
