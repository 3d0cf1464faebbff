"""Where a turtle was when: few enough samples to tell, near enough to show it moving again."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from spinbook.turtlesim.pen import Pen

#: Between two samples the turtle is within this of a steady move (units; rad): half a pixel, one degree.
PLACE_TOLERANCE, HEADING_TOLERANCE = 0.01, 0.02
#: Beyond this many samples the oldest are forgotten, so many at a time.
MAX_SAMPLES, _FORGET = 3_000, 500


@dataclass(frozen=True)
class Sample:
    """A turtle at a tick (16 ms each): x and y in units, y up; theta in rad, counted on beyond a full turn.

    `pen` is what it drew with on its way from the sample before, None if it drew nothing.
    """

    tick: int
    x: float
    y: float
    theta: float
    pen: Pen | None


class Track:
    """The samples of one turtle, thinned as they come: between two of them everything changes steadily.

    The swing-door method on x, y and theta over time: E. H. Bristol, "Swinging door trending: adaptive trend
    recording?", 1990.
    """

    def __init__(self, place: float = PLACE_TOLERANCE, heading: float = HEADING_TOLERANCE) -> None:
        self.samples: list[Sample] = []
        #: Whether the oldest part has been forgotten because there was too much.
        self.forgotten = False
        self._tolerances = (place, place, heading)
        self._doors = [(-math.inf, math.inf)] * 3

    def add(self, tick: int, x: float, y: float, theta: float, pen: Pen | None) -> None:
        """Where the turtle is at `tick`, which is after all before; theta may be off by full turns."""
        if self.samples:
            before = self.samples[-1].theta
            theta = before + math.remainder(theta - before, 2 * math.pi)
        sample = Sample(tick, x, y, theta, None if pen is None or pen.off else pen)
        if len(self.samples) < 2 or sample.pen != self.samples[-1].pen or not self._admits(sample):
            self.samples.append(sample)
            self._doors = [(-math.inf, math.inf)] * 3
        else:
            self.samples[-1] = sample
        if len(self.samples) > 1:
            self._close_doors(sample)
        if len(self.samples) > MAX_SAMPLES:
            del self.samples[:_FORGET]
            self.forgotten = True

    def _admits(self, sample: Sample) -> bool:
        return all(low <= slope <= high for (low, high), slope in zip(self._doors, self._slopes(sample), strict=True))

    def _close_doors(self, sample: Sample) -> None:
        ticks = sample.tick - self.samples[-2].tick
        self._doors = [
            (max(low, slope - tolerance / ticks), min(high, slope + tolerance / ticks))
            for (low, high), slope, tolerance in zip(self._doors, self._slopes(sample), self._tolerances, strict=True)
        ]

    def _slopes(self, sample: Sample) -> list[float]:
        anchor = self.samples[-2]
        ticks = sample.tick - anchor.tick
        return [(getattr(sample, part) - getattr(anchor, part)) / ticks for part in ("x", "y", "theta")]


def thinned(samples: Sequence[Sample], place: float, heading: float) -> list[Sample]:
    """Fewer samples, of which it holds as of a track's that what lies between is within these (units, rad)."""
    track = Track(place, heading)
    for sample in samples:
        track.add(sample.tick, sample.x, sample.y, sample.theta, sample.pen)
    return track.samples


def moves(samples: Iterable[Sample]) -> bool:
    """Whether there is anything to see: two samples that differ."""
    return len({(sample.x, sample.y, sample.theta) for sample in samples}) > 1
