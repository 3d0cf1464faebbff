"""Deadlines: the table `[deadline]` of exercise.toml, exceptions per student, and the penalty for late work."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from datetime import date, datetime, timedelta, timezone, tzinfo
from pathlib import Path
from typing import Any

from grader.classroom.archive import OF_FILES
from grader.classroom.names import normal
from grader.classroom.submissions import StudentSubmission, Submissions, SubmissionsError
from grader.classroom.tables import table_rows
from grader.classroom.times import UNKNOWN, later, localized, moment, units_begun, zone_named
from grader.exercise.exercise import Exercise, ExerciseError
from grader.exercise.exercise_toml import read_toml
from grader.grading.grade import Adjustment, Entry
from groundwork.words import counted, did_you_mean

UNITS = {unit: timedelta(**{f"{unit}s": 1}) for unit in ("minute", "hour", "day", "week")}
LENGTH = re.compile(r"(\d+) *(minute|hour|day|week)s?")
RULE = re.compile(r"(\d+(?:\.\d+)?) *% +(?:an?|per) +(minute|hour|day|week)(?: +up +to +(\d+(?:\.\d+)?) *%)?")

KEYS = ("due", "zone", "grace", "penalty", "closes")


@dataclass(frozen=True)
class Deadline:
    """When work is due, and the penalty for late work.

    Work submitted within `grace` after `due` is on time. Later work loses `percent` of its score for each `unit` begun
    since `due`, at most `at_most` percent; after `closes` it loses everything. Days and weeks follow the calendar of
    `zone` (None: this machine's): they end at the time of day of `due`, even if the clocks change.
    """

    due: datetime
    grace: timedelta = timedelta()
    percent: float = 0.0
    unit: timedelta = UNITS["day"]
    at_most: float = 100.0
    closes: datetime | None = None
    zone: tzinfo | None = None

    @property
    def costs(self) -> bool:
        """Whether lateness costs anything."""
        return bool(self.percent or self.closes)

    def lost(self, submitted: datetime, due: datetime | None = None) -> float:
        """Return the percentage of the score that is lost; `due` is the student's own due date, if any.

        If the student's due date is later than the closing date, work is accepted until then.
        """
        due, submitted = (due or self.due).astimezone(timezone.utc), submitted.astimezone(timezone.utc)
        if self.closes and submitted > max(self.closes, due):
            return 100.0
        if submitted <= later(due, self.grace, self.zone):
            return 0.0
        return min(self.at_most, self.percent * units_begun(due, submitted, self.unit, self.zone))

    def __str__(self) -> str:
        """Return when work is due, and by which calendar days are counted."""
        calendar = f"the calendar of {self.zone}" if self.zone else "this machine's calendar"
        if isinstance(self.zone, timezone) and self.zone is not timezone.utc:
            calendar += ', whose clocks never change (if they do, write zone = "Europe/Berlin" or the like)'
        return f"due {date_shown(self.due.astimezone(self.zone))}, days by {calendar}"


def deadline_of(exercise: Exercise) -> Deadline | None:
    """Return the deadline in exercise.toml; None if there is none. Raises `ExerciseError` for a mistake in it."""
    file = exercise.folder / "exercise.toml"
    entries = read_toml(file).get("deadline")
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
    zone = _zone(entries, file)
    due = _moment(entries["due"], "due", file, zone)
    closes = _moment(entries["closes"], "closes", file, zone) if "closes" in entries else None
    if closes and closes < due:
        raise ExerciseError(file, f"closes = {closes} is before due", "Write a time after due, or leave it out.")
    return Deadline(due, _length(entries.get("grace", "0 minutes"), file), percent, unit, at_most, closes, zone)


def _zone(entries: dict[str, Any], file: Path) -> tzinfo | None:
    """Return the zone that [deadline] names; otherwise the offset of `due`, or None for this machine's zone."""
    if "zone" in entries:
        try:
            return zone_named(str(entries["zone"]))
        except ValueError as error:
            raise ExerciseError(file, str(error), 'Write one of the IANA names, zone = "Europe/Berlin".') from None
    due = entries["due"]
    if isinstance(due, datetime) and due.tzinfo and due.utcoffset() != due.astimezone().utcoffset():
        return due.tzinfo
    return None


def _moment(value: Any, key: str, file: Path, zone: tzinfo | None) -> datetime:
    if isinstance(value, datetime):
        return value if value.tzinfo else localized(value, zone)
    if isinstance(value, date):
        return localized(datetime(value.year, value.month, value.day, 23, 59, 59), zone)
    raise ExerciseError(file, f"{key} = {value!r}", f"Write a time without quotes, {key} = 2026-11-22T23:59:00+01:00.")


def _length(value: Any, file: Path) -> timedelta:
    match = LENGTH.fullmatch(value.strip()) if isinstance(value, str) else None
    if not match:
        raise ExerciseError(file, f"grace = {value!r}", "Write a number and a unit, such as grace = '15 minutes'.")
    return int(match[1]) * UNITS[match[2]]


def _rule(value: Any, file: Path) -> tuple[float, timedelta, float]:
    match = RULE.fullmatch(value.strip()) if isinstance(value, str) else None
    if not match or float(match[1]) > 100 or float(match[3] or 0) > 100:
        raise ExerciseError(file, f"penalty = {value!r}", "Write it like this: penalty = '10 % a day up to 50 %'.")
    return float(match[1]), UNITS[match[2]], float(match[3] or 100)


NUMBER = re.compile(r"[+-]?\d+(\.\d+)?")


@dataclass(frozen=True)
class Override:
    """One row: `points` that replace the score or, if `added`, are added to it; or another `due` date."""

    student: str
    reason: str
    points: float | None = None
    added: float | None = None
    due: datetime | None = None


def overrides_in(file: Path, students: set[str], zone: tzinfo | None = None) -> dict[str, tuple[Override, ...]]:
    """Return the rows by student. Each student must be one of `students`.

    Columns: student, reason, and either points or due. A due date without a zone is in `zone`. `85` replaces the
    points; `+5` and `-5` are added to the score. Raises `SubmissionsError`.
    """
    found: dict[str, tuple[Override, ...]] = {}
    for number, row in table_rows(file, ("student", "reason"), ("points", "due")):
        override = _override(row, f"{file}:{number}", students, zone)
        found[override.student] = (*found.get(override.student, ()), override)
    return found


def _override(row: dict[str, str], place: str, students: set[str], zone: tzinfo | None) -> Override:
    student, points, due = normal(row["student"]), row.get("points", ""), row.get("due", "")
    if student not in students:
        advice = did_you_mean(student, students, "Write the name of a folder in the results.")
        raise SubmissionsError(f"{place}: no student is called {student!r}. {advice}")
    if not row["reason"]:
        raise SubmissionsError(f"{place}: the reason is missing. Write one: the student will read it.")
    if bool(points) == bool(due):
        raise SubmissionsError(f"{place}: points = {points!r}, due = {due!r}. Give one of the two.")
    if due:
        date = moment(due if ":" in due else f"{due} 23:59:59", zone)
        if date is None:
            raise SubmissionsError(f"{place}: due = {due!r}. Write it as 2026-11-22 23:59.")
        return Override(student, row["reason"], due=date)
    if not NUMBER.fullmatch(points):
        raise SubmissionsError(
            f"{place}: points = {points!r}. Write 85 to replace the points, +5 or -5 to change them."
        )
    if points[0] in "+-":
        return Override(student, row["reason"], added=float(points))
    return Override(student, row["reason"], points=float(points))


@dataclass(frozen=True)
class Adjuster:
    """The deadline and the instructor's overrides, applied to entries."""

    deadline: Deadline | None = None
    overrides: Mapping[str, tuple[Override, ...]] = field(default_factory=dict)

    def __call__(self, entry: Entry) -> tuple[Adjustment, ...]:
        """Return the adjustments to this entry's score, with reasons. Earlier adjustments are ignored.

        Lateness depends on when the work was submitted, not on when it was graded. Points set by the instructor count
        even if the work is late. If several rows set a student's points or due date, the last one counts.
        """
        theirs = self.overrides.get(entry.student.id, ())
        fixed = [override for override in theirs if override.points is not None]
        if fixed:
            last = fixed[-1]
            assert last.points is not None
            return (Adjustment("override", last.points - entry.grade.score, last.reason),)
        extended = [override for override in theirs if override.due]
        made = [
            Adjustment("override", 0.0, f"due {date_shown(one.due)}: {one.reason}") for one in extended[-1:] if one.due
        ]
        if late := self._late(entry, extended[-1].due if extended else None):
            made.append(late)
        made += [Adjustment("override", one.added, one.reason) for one in theirs if one.added is not None]
        return tuple(made)

    def without_dates_of_a_copy(self, collected: Submissions) -> Submissions:
        """Return the submissions without their dates, if copying gave all files one, for which they would be late."""
        dates = [one.file.submitted for one in collected.handed_in if one.file.submitted_from in OF_FILES]
        known = [date for date in dates if date]
        if len(known) < max(3, len(collected.handed_in)) or max(known) - min(known) > UNITS["minute"]:
            return collected
        if not self.deadline or not self.deadline.lost(max(known)):
            return collected
        handed_in = (replace(one, file=replace(one.file, time=UNKNOWN)) for one in collected.handed_in)
        why = f"All files have one date, {date_shown(max(known))}: that of a copy, not of a submission."
        return replace(collected, handed_in=tuple(handed_in), dates=why)

    def undated(self, handed_in: Sequence[StudentSubmission]) -> list[StudentSubmission]:
        """Return the submissions of unknown date for which lateness would cost points."""
        if not self.deadline or not self.deadline.costs:
            return []
        decided = {
            who for who, theirs in self.overrides.items() if any(override.points is not None for override in theirs)
        }
        return [
            one
            for one in handed_in
            if one.student.id not in decided
            and any(file.submitted is None and file.time.late is not False for file in one.files)
        ]

    def _late(self, entry: Entry, due: datetime | None) -> Adjustment | None:
        if not self.deadline or not entry.submitted or not entry.grade.has_score:
            return None
        percent = self.deadline.lost(entry.submitted, due)
        if not percent:
            return None
        behind = lateness(due or self.deadline.due, entry.submitted, self.deadline.zone)
        reason = f"handed in {behind} late, by {entry.submitted_from}: {percent:g} % of {entry.grade.score:g} points"
        return Adjustment("late", -round(entry.grade.score * percent / 100, 6), reason)


def date_shown(moment: datetime | None) -> str:
    """Return a time as text, with its zone."""
    return moment.strftime("%Y-%m-%d %H:%M %z") if moment else ""


def lateness(due: datetime, submitted: datetime, zone: tzinfo | None) -> str:
    """Return `2 days 3 h`, `3 h 20 min` or `5 min`; minutes are rounded up, and days are calendar days."""
    submitted = submitted.astimezone(timezone.utc)
    days = units_begun(due, submitted, UNITS["day"], zone)
    if later(due, days * UNITS["day"], zone) > submitted:
        days -= 1
    minutes = -((later(due, days * UNITS["day"], zone) - submitted) // UNITS["minute"])
    hours, minutes = divmod(minutes, 60)
    if days:
        return f"{counted(days, 'day')} {hours} h"
    return f"{hours} h {minutes} min" if hours else f"{minutes} min"
