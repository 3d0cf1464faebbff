"""The further hints of the last check, one step at a time, and how many were taken.

`.spinbook/hints.json` in the student's folder has, for each exercise, the hints of the first check that failed last,
and how many steps were shown of each check, ever. Counts go into the upload if exercise.toml says `count_hints = true`.
"""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import TYPE_CHECKING, Any

from grader.exercise.exercise import Exercise
from grader.report.checks import first_hints
from groundwork.files import json_object, write_if_changed

if TYPE_CHECKING:
    from grader.grading.grade import Grade

FILE = Path(".spinbook") / "hints.json"

#: The last line of a program from an exercise's page: see browser/static/exercise.js.
_IN_PAGE = re.compile(r"^# Hints shown in the page: (\{.{0,10000}\})$", re.MULTILINE)


def last_hints(grade: Grade) -> dict[str, Any]:
    """Return what `remember` stores about a self-check: the first check that fails, and its further hints."""
    check, hints = first_hints(grade)
    return {"check": check, "hints": hints}


def remember(exercise: Exercise, last: dict[str, Any], folder: Path) -> None:
    """Store the hints of the last check of an exercise. Steps that were shown before stay counted."""
    entries = _read(folder)
    entries[exercise.name] = {**last, "taken": taken(exercise, folder)}
    write_if_changed(folder / FILE, json.dumps(entries, indent=2, ensure_ascii=False) + "\n")


def next_hint(exercise: Exercise, folder: Path) -> str:
    """Return the hint steps of the last check that were shown so far, and one more, and count it."""
    entries = _read(folder)
    last = entries.get(exercise.name)
    if last is None:
        return "Check your node first: hints are about the first check that fails."
    check, hints = str(last.get("check", "")), list(last.get("hints", []))
    if not hints:
        return "There is nothing to give a hint for: no check failed, or the message says it all."
    steps = min(taken(exercise, folder).get(check, 0) + 1, len(hints))
    entries[exercise.name] = {**last, "taken": {**taken(exercise, folder), check: steps}}
    write_if_changed(folder / FILE, json.dumps(entries, indent=2, ensure_ascii=False) + "\n")
    left = len(hints) - steps
    shown = [f"{label}: {hint}" for label, hint in hints[:steps]]
    return "\n".join([check, *shown, "There is one more hint." if left else "There are no more hints."])


def taken(exercise: Exercise, folder: Path) -> dict[str, int]:
    """Return how many steps of further hints were shown of each check, by its title."""
    return _counts(_read(folder).get(exercise.name, {}).get("taken", {}))


def taken_in_page(source: str) -> dict[str, int]:
    """Return what the last line of a program says that was downloaded from an exercise's page: the same as `taken`."""
    line = _IN_PAGE.search(source)
    try:
        return _counts(json.loads(line[1]) if line else {})
    except ValueError:
        return {}


def _counts(entries: Any) -> dict[str, int]:
    pairs = entries.items() if isinstance(entries, dict) else ()
    return {str(check): steps for check, steps in pairs if isinstance(steps, int)}


def _read(folder: Path) -> dict[str, Any]:
    """Return what the file has; nothing if there is none, or one that somebody else wrote."""
    return {name: entry for name, entry in json_object(folder / FILE).items() if isinstance(entry, dict)}
