"""Simulated time: its unit, its beginning, and the moments of what is recorded."""

from __future__ import annotations

#: Simulated time counts nanoseconds.
SECOND = 1_000_000_000

#: Simulated time at which every scenario begins. Not 0, which means "no time yet" in ROS.
START = 100 * SECOND


def seconds(moment: int) -> float:
    """Return a moment of simulated time (ns) as seconds after the start."""
    return (moment - START) / SECOND


class RecordedMoment:
    """What happened at a moment."""

    at_ns: int

    @property
    def at(self) -> float:
        """Return when it was, in seconds after the start."""
        return seconds(self.at_ns)


class RecordedRequest(RecordedMoment):
    """What may be answered later."""

    answered_ns: int | None

    @property
    def answered(self) -> float | None:
        """Return when it was answered, in seconds after the start; None without an answer."""
        return None if self.answered_ns is None else seconds(self.answered_ns)
