"""The figures of hz, bw and delay, by the formulas of the real command (package ros2topic, Jazzy)."""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass


@dataclass(frozen=True)
class Spread:
    """Mean, least, greatest and population standard deviation of `count` values, in the values' unit."""

    mean: float
    least: float
    greatest: float
    deviation: float
    count: int


def spread(values: deque[int]) -> Spread:
    """The spread of at least one value; the deviation is divided by n, not by n - 1."""
    count = len(values)
    mean = sum(values) / count
    deviation = math.sqrt(sum((value - mean) ** 2 for value in values) / count)
    return Spread(mean, min(values), max(values), deviation, count)


class Rate:
    """The rate of arrivals over the last `window` intervals. Times are in ns."""

    def __init__(self, window: int) -> None:
        self._intervals: deque[int] = deque(maxlen=window)
        self._latest: int | None = None
        self._told = 0

    def arrived(self, now: int) -> None:
        """A message came at `now`; a clock that went back begins anew."""
        if self._latest is None or now < self._latest:
            self._intervals.clear()
        else:
            self._intervals.append(now - self._latest)
        self._latest = now

    def reset(self) -> bool:
        """Forget the intervals, as when a simulation begins anew; whether there were any."""
        had = bool(self._intervals)
        self._intervals.clear()
        return had

    def report(self) -> str | None:
        """The two lines to print, at most once a second of arrivals; None if none are due."""
        if not self._intervals or self._latest is None:
            return None
        if self._told == 0 or self._latest < self._told:
            self._told = self._latest
            return None
        if self._latest < self._told + 1_000_000_000:
            return None
        self._told = self._latest
        result = spread(self._intervals)
        rate = 1e9 / result.mean if result.mean > 0 else 0.0
        return f"average rate: {rate:.3f}\n\t" + _seconds(result)


class Delay:
    """The age of messages on arrival over the last `window`. Times are in ns."""

    def __init__(self, window: int) -> None:
        self._delays: deque[int] = deque(maxlen=window)
        self._latest: int | None = None
        self._told: int | None = None

    def arrived(self, now: int, stamp: int) -> None:
        """A message with the header stamp `stamp` came at `now`. The first is left out, as the real one does."""
        if self._latest is None or now < self._latest:
            self._delays.clear()
        else:
            self._delays.append(now - stamp)
        self._latest = now

    def report(self) -> str | None:
        """The lines to print this second; None before there is anything."""
        if not self._delays:
            return None
        if self._latest == self._told:
            return "no new messages"
        self._told = self._latest
        result = spread(self._delays)
        return f"average delay: {result.mean * 1e-9:.3f}\n\t" + _seconds(result)


class Bandwidth:
    """Bytes a second over the last `window` messages. Times are in s."""

    def __init__(self, window: int) -> None:
        self._sizes: deque[int] = deque(maxlen=window)
        self._times: deque[float] = deque(maxlen=window)

    def arrived(self, now: float, size: int) -> None:
        """A message of `size` bytes came at `now`."""
        self._times.append(now)
        self._sizes.append(size)

    def report(self, now: float) -> str | None:
        """The two lines to print at `now`; None before there are two messages."""
        if len(self._times) < 2 or now <= self._times[0]:
            return None
        total, count = sum(self._sizes), len(self._sizes)
        rate = total / (now - self._times[0])
        unit = _unit(rate)
        mean, least, greatest = (unit(value) for value in (total / count, min(self._sizes), max(self._sizes)))
        return f"{unit(rate)}/s from {count} messages\n\tMessage size mean: {mean} min: {least} max: {greatest}"


def _seconds(result: Spread) -> str:
    return (
        f"min: {result.least * 1e-9:.3f}s max: {result.greatest * 1e-9:.3f}s "
        f"std dev: {result.deviation * 1e-9:.5f}s window: {result.count}"
    )


def _unit(rate: float) -> Callable[[float], str]:
    """The unit that suits a rate in bytes a second; everything beside it is told in the same one."""
    if rate < 1000:
        return lambda size: f"{size:.0f} B"
    if rate < 1_000_000:
        return lambda size: f"{size / 1000:.2f} KB"
    return lambda size: f"{size / 1_000_000:.2f} MB"
