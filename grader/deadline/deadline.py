"""The table `[deadline]` of exercise.toml: when work is due, and what it costs to be late."""

from __future__ import annotations

import re
import sys
from dataclasses import dataclass
from datetime import date, datetime, timedelta
from pathlib import Path
from typing import Any

from grader.exercise import Exercise, ExerciseError

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

UNITS = {
    "minute": timedelta(minutes=1),
    "hour": timedelta(hours=1),
    "day": timedelta(days=1),
    "week": timedelta(weeks=1),
}
LENGTH = re.compile(r"(\d+) *(minute|hour|day|week)s?")
RULE = re.compile(r"(\d+(?:\.\d+)?) *% +(?:an?|per) +(minute|hour|day|week)(?: +up +to +(\d+(?:\.\d+)?) *%)?")

KEYS = ("due", "grace", "penalty", "closes")


@dataclass(frozen=True)
class Deadline:
    """When work is due and what lateness costs.

    Work that comes within `grace` after `due` is on time. Later work loses `percent` of its score for each `unit` that
    has begun since `due`, at most `at_most` percent; after `closes` it loses everything.
    """

    due: datetime
    grace: timedelta = timedelta()
    percent: float = 0.0
    unit: timedelta = UNITS["day"]
    at_most: float = 100.0
    closes: datetime | None = None

    def lost(self, submitted: datetime, due: datetime | None = None) -> float:
        """How many percent of its score work loses that was handed in then; `due` is a later due date of one student's.

        A student's own due date moves the closing, too, where it lies before.
        """
        due = due or self.due
        if self.closes and submitted > max(self.closes, due):
            return 100.0
        if submitted <= due + self.grace:
            return 0.0
        begun = -((due - submitted) // self.unit)
        return min(self.at_most, self.percent * begun)


def deadline_of(exercise: Exercise) -> Deadline | None:
    """What exercise.toml says of it; None where it says nothing. Raises `ExerciseError` where that is not clear."""
    file = exercise.folder / "exercise.toml"
    entries = tomllib.loads(file.read_text(encoding="utf-8")).get("deadline")
    if entries is None:
        return None
    if not isinstance(entries, dict):
        raise ExerciseError(
            file, f"deadline = {entries!r}", "Write a table, [deadline], with due = 2026-11-22T23:59:00."
        )
    for key in entries:
        if key not in KEYS:
            raise ExerciseError(file, f"[deadline] has {key!r}", f"It may have {', '.join(KEYS)}.")
    if "due" not in entries:
        raise ExerciseError(file, "[deadline] has no due", "Write due = 2026-11-22T23:59:00+01:00.")
    percent, unit, at_most = _rule(entries.get("penalty", "0 % a day"), file)
    return Deadline(
        due=_moment(entries["due"], "due", file),
        grace=_length(entries.get("grace", "0 minutes"), file),
        percent=percent,
        unit=unit,
        at_most=at_most,
        closes=_moment(entries["closes"], "closes", file) if "closes" in entries else None,
    )


def _moment(value: Any, key: str, file: Path) -> datetime:
    if isinstance(value, datetime):
        return value if value.tzinfo else value.astimezone()
    if isinstance(value, date):
        return datetime(value.year, value.month, value.day, 23, 59, 59).astimezone()
    raise ExerciseError(file, f"{key} = {value!r}", f"Write a time without quotes, {key} = 2026-11-22T23:59:00+01:00.")


def _length(value: Any, file: Path) -> timedelta:
    match = LENGTH.fullmatch(value.strip()) if isinstance(value, str) else None
    if not match:
        raise ExerciseError(file, f"grace = {value!r}", "Write a number and a unit, such as grace = '15 minutes'.")
    return int(match[1]) * UNITS[match[2]]


def _rule(value: Any, file: Path) -> tuple[float, timedelta, float]:
    match = RULE.fullmatch(value.strip()) if isinstance(value, str) else None
    if not match or float(match[1]) > 100 or float(match[3] or 0) > 100:
        raise ExerciseError(file, f"penalty = {value!r}", "Write it so: penalty = '10 % a day up to 50 %'.")
    return float(match[1]), UNITS[match[2]], float(match[3] or 100)
