"""Finds the fences that repeat part of a whole program in the chapter: they explain it and need not run."""

from __future__ import annotations

from collections.abc import Sequence

from spinbook.chapter.classify import CellKind, ClassifiedFence
from spinbook.chapter.fence import Fence
from spinbook.chapter.python_code import facts_of


def excerpts(fences: Sequence[Fence]) -> dict[int, str]:
    """Map the line of each fence that is part of a longer program to where that program is, "above" or "below"."""
    python = [fence for fence in fences if fence.is_python]
    code = {fence.line: _lines(fence.code) for fence in python}
    programs = {fence.line: code[fence.line] for fence in python if _is_whole(fence.code)}
    places: dict[int, str] = {}
    for line in (fence.line for fence in python if not fence.attributes):
        lines = code[line]
        within = [at for at, whole in programs.items() if at != line and len(lines) < len(whole) and lines in whole]
        if lines.strip() and within:
            places[line] = "above" if min(within) < line else "below"
    return places


def is_excerpt(item: ClassifiedFence, place: str) -> bool:
    """Return whether a fence only explains the program that it is part of, which is `place` ("above", "below", "")."""
    if not place:
        return False
    if item.kind is CellKind.NODE:
        return place == "above"
    return item.is_static and (item.code is None or bool(item.code.fragment))


def _lines(code: str) -> str:
    """Return the lines of code, without the space around them, empty lines and comments."""
    lines = (line.strip() for line in code.split("\n"))
    return "\n" + "".join(f"{line}\n" for line in lines if line and not line.startswith("#"))


def _is_whole(code: str) -> bool:
    facts = facts_of(code)
    return facts.is_complete and facts.is_node and bool(facts.imports) and not facts.fragment
