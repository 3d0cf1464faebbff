"""Programs that are edits of another: a Markdown file with one section per program, and a diff in each.

    ## adds_two

    It adds two.

    ```diff
    -        self.publish(2 * message.data)
    +        self.publish(2 + message.data)
    ```

The diff is a unified one, as `diff -u` and git write it, so editors and GitHub show its colors. It can be written by
hand: the numbers after `@@` may be missing, and lines of context are needed only if the base contains the removed lines
more than once. Libraries that apply patches (whatthepatch, patch-ng, unidiff) refuse a hunk without the right numbers,
or use the nearest place that fits, which may be the wrong one after the base has changed. Here an edit fits exactly one
place, or is an error.
"""

from __future__ import annotations

import difflib
import itertools
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from markdown_it import MarkdownIt

from grader.exercise.exercise import ExerciseError

#: `@@`, optionally git's numbers, and optionally a line of the base that is above the edit.
_HUNK = re.compile(r"^@@(?: -(\d+)\S* \+\d+\S* @@)?(.*)$")


@dataclass(frozen=True)
class Hunk:
    """One place of a diff: lines `old` of the base become `new`.

    `line` is its line in the file of edits, `start` the first line in the base if the diff says it; both count from 1.
    With `below`, the place is the first that fits at or below the base's line with this text.
    """

    line: int
    old: tuple[str, ...]
    new: tuple[str, ...]
    start: int | None = None
    below: str = ""


@dataclass(frozen=True)
class Edit:
    """One program of the file: its name, the text of its section except the diff, and the diff.

    `base` is the file that the diff changes, as the diff names it (`--- right/other.py`), relative to the file of
    edits; empty if it names none. `line` is that of the section's heading, counted from 1.
    """

    file: Path
    name: str
    line: int
    text: str
    hunks: tuple[Hunk, ...]
    base: str = ""

    def applied_to(self, base: Path) -> str:
        """Return the whole program: `base`, or the file that the diff names, with this edit.

        Raises `ExerciseError` if a hunk has no place in the base, or more than one.
        """
        base = self.file.parent / self.base if self.base else base
        try:
            lines = base.read_text(encoding="utf-8-sig").splitlines()
        except OSError:
            raise self._error(
                f"it changes {base.name}, and there is no such file", "Name a file that exists."
            ) from None
        if not self.hunks:
            raise self._error("it has no diff", "Write a fence ```diff with the lines to remove (-) and to add (+).")
        places = sorted(((self._place(hunk, lines, base.name), hunk) for hunk in self.hunks), key=lambda pair: pair[0])
        for at, hunk in reversed(places):
            lines[at : at + len(hunk.old)] = hunk.new
        return "\n".join(lines) + "\n"

    def _place(self, hunk: Hunk, lines: Sequence[str], base: str) -> int:
        """Return the index of the first line that the hunk replaces."""
        if not hunk.old:
            fix = "Write the line above the new one, too, with a space before it."
            raise self._error("the diff adds lines, and does not say where", fix, hunk.line)
        places = list(_places(hunk, lines))
        if hunk.start and hunk.start - 1 in places:
            return hunk.start - 1
        if len(places) == 1 or (places and hunk.below):
            return places[0]
        if places:
            numbers = ", ".join(str(place + 1) for place in places)
            fix = "Add lines of context, or write `@@ def NAME` above: the edit is then the first below that line."
            raise self._error(f"the diff fits {base} in lines {numbers}", fix, hunk.line)
        raise self._error(*_no_place(hunk, lines, base), hunk.line)

    def _error(self, problem: str, fix: str, line: int | None = None) -> ExerciseError:
        return ExerciseError(self.file, f"{self.name}: {problem}", fix, line or self.line)


def read_edits(file: Path) -> tuple[Edit, ...]:
    """Return the programs of a Markdown file: one for each heading of the second level.

    Raises `ExerciseError` if two have the same name, or a name is not valid.
    """
    text = file.read_text(encoding="utf-8-sig")
    lines = text.splitlines()
    tokens = MarkdownIt().parse(text)
    headings = [token.map[0] for token in tokens if token.type == "heading_open" and token.tag == "h2" and token.map]
    blocks = [token for token in tokens if token.type == "fence" and token.info.split()[:1] in (["diff"], ["patch"])]
    fences = [(token.map[0], token.map[1]) for token in blocks if token.map]
    edits = []
    for start, end in itertools.pairwise([*headings, len(lines)]):
        inside = [fence for fence in fences if start < fence[0] < end]
        edits.append(_edit(file, lines, start, end, inside))
    _refuse_odd_names(edits)
    return tuple(edits)


def _edit(file: Path, lines: Sequence[str], start: int, end: int, fences: Sequence[tuple[int, int]]) -> Edit:
    name = lines[start].lstrip("# ").strip(" `#")
    text = [line for i, line in enumerate(lines[start + 1 : end], start + 1) if not any(a <= i < b for a, b in fences)]
    diff = [(i + 1, lines[i]) for a, b in fences for i in range(a + 1, b - 1)]
    base = next((line[4:].split("\t")[0].strip() for _, line in diff if line.startswith("--- ")), "")
    return Edit(file, name, start + 1, "\n".join(text).strip(), tuple(_hunks(diff)), base.removeprefix("a/"))


def _hunks(diff: Sequence[tuple[int, str]]) -> Iterator[Hunk]:
    """Yield the hunks of numbered lines. Each `@@` begins one, and so does each fence."""
    current: list[tuple[int, str]] = []
    head: tuple[int | None, str] = (None, "")
    last = None
    for number, line in diff:
        mark = _HUNK.match(line)
        if mark or (last is not None and number != last + 1):
            yield from _hunk(current, *head)
            current, head = [], (None, "")
        if mark:
            head = (int(mark[1]) if mark[1] else None, mark[2].strip(" @"))
        elif not line.startswith(("--- ", "+++ ", "\\")):
            current.append((number, line))
        last = number
    yield from _hunk(current, *head)


def _hunk(lines: Sequence[tuple[int, str]], start: int | None, below: str) -> Iterator[Hunk]:
    while lines and not lines[-1][1]:
        lines = lines[:-1]
    if lines:
        old = tuple(line[1:] for _, line in lines if not line.startswith("+"))
        new = tuple(line[1:] for _, line in lines if not line.startswith("-"))
        yield Hunk(lines[0][0], old, new, start, below)


def _places(hunk: Hunk, lines: Sequence[str]) -> Iterator[int]:
    first = next((i for i, line in enumerate(lines) if hunk.below in line), len(lines)) if hunk.below else 0
    old = [line.rstrip() for line in hunk.old]
    for at in range(first, len(lines) - len(old) + 1):
        if [line.rstrip() for line in lines[at : at + len(old)]] == old:
            yield at


def _no_place(hunk: Hunk, lines: Sequence[str], base: str) -> tuple[str, str]:
    """Return what is wrong with a hunk that fits nowhere, and what to do."""
    known = {line.rstrip() for line in lines}
    lost = next((line for line in hunk.old if line.rstrip() not in known), None)
    if hunk.below and not any(hunk.below in line for line in lines):
        return f"the diff is for a place below “{hunk.below}”, which is not in {base}", f"Write it as {base} has it."
    if lost is None:
        fix = f"Copy the lines from {base} as they are now, and mark the changes again."
        return f"the diff no longer fits: {base} has its lines, but not in this order", fix
    near = difflib.get_close_matches(lost, known, 1)
    like = f" It has “{near[0].strip()}”." if near else ""
    fix = f"Write the line as {base} has it now.{like}"
    return f"the diff no longer fits: {base} has no line “{lost.strip()}”", fix


def _refuse_odd_names(edits: Sequence[Edit]) -> None:
    lines: dict[str, int] = {}
    for edit in edits:
        if not re.fullmatch(r"\w+", edit.name):
            fix = "A heading is the program's name: letters, digits and underscores."
            raise ExerciseError(edit.file, f"“{edit.name}” can't be the name of a program", fix, edit.line)
        if edit.name in lines:
            problem = f"there are two programs called {edit.name}; the other is in line {lines[edit.name]}"
            raise ExerciseError(edit.file, problem, "Give each its own name.", edit.line)
        lines[edit.name] = edit.line
