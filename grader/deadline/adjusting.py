"""From a score to what counts."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from datetime import datetime, timedelta

from grader.classroom import Adjustment, Entry
from grader.deadline.deadline import Deadline
from grader.deadline.overrides import Override


@dataclass(frozen=True)
class Adjusting:
    """The deadline and the instructor's overrides, applied to entries."""

    deadline: Deadline | None = None
    overrides: Mapping[str, tuple[Override, ...]] = field(default_factory=dict)

    def __call__(self, entry: Entry) -> tuple[Adjustment, ...]:
        """What is added to or taken from this entry's score, with reasons. Its own adjustments don't count.

        Lateness is that of the hand-in, whenever it is graded. Points that the instructor sets are what counts, late
        or not; of several rows for one student the last that sets points, or a due date, holds.
        """
        theirs = self.overrides.get(entry.student.id, ())
        fixed = [override for override in theirs if override.points is not None]
        if fixed:
            last = fixed[-1]
            assert last.points is not None
            return (Adjustment("override", last.points - entry.grade.score, last.reason),)
        extended = [override for override in theirs if override.due]
        made = [Adjustment("override", 0.0, f"due {told(one.due)}: {one.reason}") for one in extended[-1:] if one.due]
        if late := self._late(entry, extended[-1].due if extended else None):
            made.append(late)
        made += [Adjustment("override", one.added, one.reason) for one in theirs if one.added is not None]
        return tuple(made)

    def _late(self, entry: Entry, due: datetime | None) -> Adjustment | None:
        if not self.deadline or not entry.submitted or entry.grade.outcome == "host-error":
            return None
        percent = self.deadline.lost(entry.submitted, due)
        if not percent:
            return None
        behind = entry.submitted - (due or self.deadline.due)
        reason = (
            f"handed in {length(behind)} late, by {entry.submitted_from}: {percent:g} % of {entry.grade.score:g} points"
        )
        return Adjustment("late", -round(entry.grade.score * percent / 100, 6), reason)


def told(moment: datetime | None) -> str:
    """A time for people, with its zone."""
    return moment.strftime("%Y-%m-%d %H:%M %z") if moment else ""


def length(time: timedelta) -> str:
    """`2 days 3 h`, `3 h 20 min` or `5 min`; a minute that has begun counts."""
    minutes = -(-time // timedelta(minutes=1))
    days, minutes = divmod(minutes, 24 * 60)
    hours, minutes = divmod(minutes, 60)
    if days:
        return f"{days} day{'s' if days > 1 else ''} {hours} h"
    return f"{hours} h {minutes} min" if hours else f"{minutes} min"
