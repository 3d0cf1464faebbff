"""Finds what repeats itself in a chapter, so that its page can show less of it."""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import dataclass
from difflib import SequenceMatcher

from spinbook.chapter.chapter import ChapterCell
from spinbook.chapter.classify import CellKind
from spinbook.chapter.terminal import MOVING_ABOUT

_TIDIES = re.compile(rf"(?:%stop|colcon|{'|'.join(map(re.escape, MOVING_ABOUT))})(?:\s|$)")
_CLASS = re.compile(r"^class (\w+)", re.MULTILINE)
#: A program's `main`, with the empty lines above it, up to the end of the program.
_MAIN = re.compile(r"\n+^def main\(.*\Z", re.MULTILINE | re.DOTALL)


@dataclass(frozen=True)
class Repetition:
    """What repeats itself in a cell's code.

    `housekeeping` says that it only stops nodes, builds or moves about. From the line `main_from` on (counted from 0),
    its `main` is that of an earlier node, apart from the names of the classes; None for any other. `changed` are the
    lines (from 1) that the version in an earlier cell did not have; () if there is no earlier version.
    """

    housekeeping: bool = False
    main_from: int | None = None
    changed: tuple[int, ...] = ()


def repetitions(cells: Iterable[ChapterCell]) -> dict[str, Repetition]:
    """Return what repeats itself in the code of each cell, by its id."""
    known: dict[str, Repetition] = {}
    versions: dict[str | None, str] = {}
    mains: set[str] = set()
    for cell in cells:
        code = cell.shown.rstrip("\n")
        if cell.kind is CellKind.NODE:
            main = _MAIN.search(code)
            form = _without_classes(main.group(), code) if main else ""
            start = code.count("\n", 0, main.start()) + 1 if main and form in mains else None
            known[cell.id] = Repetition(
                main_from=start, changed=_changed(versions.get(cell.replaces or cell.name), code)
            )
            versions[cell.name] = code
            mains.add(form)
        elif cell.kind in {CellKind.SHELL, CellKind.SNIPPET}:
            known[cell.id] = Repetition(bool(code) and all(map(_TIDIES.match, filter(str.strip, code.split("\n")))))
    return known


def _without_classes(main: str, code: str) -> str:
    names = "|".join(_CLASS.findall(code))
    return re.sub(rf"\b(?:{names})\b", "", main) if names else main


def _changed(before: str | None, code: str) -> tuple[int, ...]:
    if before is None:
        return ()
    matching = SequenceMatcher(None, before.split("\n"), code.split("\n"), autojunk=False)
    return tuple(
        line + 1
        for change, _, _, start, end in matching.get_opcodes()
        if change != "equal"
        for line in range(start, end)
    )
