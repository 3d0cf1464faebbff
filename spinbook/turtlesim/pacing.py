"""How many ticks are due when the timer fires."""

from __future__ import annotations

from spinbook.turtlesim.geometry import TICK_NS

#: A simulated clock that moves on by more than this at once has been set, and time has not passed.
_LEAP_NS = 1_000_000_000


class Pacing:
    """One tick each time, as turtlesim does: a process that lags makes its turtles slow.

    With a simulated clock, whose steps are often longer than a tick, every 16 ms that it has moved on are a tick, so
    that the same clock always gives the same path.
    """

    def __init__(self) -> None:
        self._last_ns: int | None = None

    def due(self, now_ns: int, simulated: bool) -> list[int]:
        """The times (ns) of the ticks that are due now."""
        if not simulated:
            self._last_ns = None
            return [now_ns]
        if self._last_ns is None or not 0 <= now_ns - self._last_ns <= _LEAP_NS:
            self._last_ns = now_ns
            return [now_ns]
        times = list(range(self._last_ns + TICK_NS, now_ns + 1, TICK_NS))
        if times:
            self._last_ns = times[-1]
        return times
