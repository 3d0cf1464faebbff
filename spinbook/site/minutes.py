"""How long a chapter takes: by its author's table of sections and minutes, otherwise by its words."""

from __future__ import annotations

import re

from groundwork.words import counted
from spinbook.chapter.chapter import Chapter
from spinbook.chapter.classify import CellKind

#: The number of words of a technical text that most people read in a minute.
WORDS_PER_MINUTE = 200
_TABLE = re.compile(r"^\|[^|\n]*\|\s*Minutes\s*\|\n\|[-:| ]+\|\n((?:\|.*\|\n?)+)", re.MULTILINE)
_ROW = re.compile(r"\|[^|]*?\(#(?P<anchor>[^)\s]+)\)[^|]*\|\s*(?P<minutes>\d+)\s*\|")


def section_minutes(chapter: Chapter) -> dict[str, int]:
    """Return the minutes of each section by its anchor, from the table whose second column is "Minutes"; {} if none."""
    for cell in chapter.cells:
        if cell.kind is CellKind.PROSE and (table := _TABLE.search(cell.source)):
            return {row["anchor"]: int(row["minutes"]) for row in _ROW.finditer(table[1])}
    return {}


def chapter_facts(chapter: Chapter) -> list[str]:
    """Return what a reader wants to know first, such as: Week 3, 3 hours, 13 nodes, 3 exercises."""
    week = [f"Week {chapter.week}"] if chapter.week else []
    numbers = ((len(list(chapter.nodes)), "node"), (len(list(chapter.exercises)), "exercise"))
    return [*week, _duration(chapter), *(counted(number, name) for number, name in numbers if number)]


def _duration(chapter: Chapter) -> str:
    """Return the time for reading and trying everything; without an author's table, the time to read the prose."""
    if total := sum(section_minutes(chapter).values()):
        halves = round(total / 30)
        hours = f"{halves // 2 or ''}{'½' if halves % 2 else ''}"
        return f"{total} minutes" if total < 60 else f"{hours} hour{'s' if halves > 2 else ''}"
    words = sum(len(cell.source.split()) for cell in chapter.cells if cell.kind is CellKind.PROSE)
    return f"About {counted(max(1, round(words / WORDS_PER_MINUTE)), 'minute')} to read"
