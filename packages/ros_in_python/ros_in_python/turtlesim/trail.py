"""What the turtles have drawn, and where each was when, in as few lines and samples as keep the shape."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field

from ros_in_python.turtlesim.events import Pen

Point = tuple[float, float]

#: A point is left out where the line without it passes this near (units): a fifth of a pixel.
TOLERANCE = 0.004
#: Beyond this many points the oldest are forgotten, so that a turtle may drive forever.
MAX_POINTS = 30_000
#: A stroke's colour, width and name count as this many points: they take that much room in a message.
_STROKE_COST = 6
#: How many points of a long stroke are forgotten at a time.
_FORGET = 1_000


@dataclass
class Stroke:
    """A polyline (units, y up) that one turtle drew with one pen; `points` are thinned as they come."""

    turtle: str
    pen: Pen
    points: list[Point]
    _cone: _Cone | None = field(default=None, repr=False)

    def extend(self, point: Point) -> None:
        """Go on to `point` in a straight line."""
        if self._cone is not None and self._cone.admits(point):
            self.points[-1] = point
        else:
            self._cone = _Cone(self.points[-1])
            self.points.append(point)
        self._cone.narrow(point)


class _Cone:
    """The directions in which a straight line from `apex` passes within TOLERANCE of every point since.

    The sector-intersection method: C. M. Williams, "An efficient algorithm for the piecewise linear approximation
    of planar curves", 1978. Angles are in rad, from the direction of the first point that is not at the apex.
    """

    def __init__(self, apex: Point) -> None:
        self._apex = apex
        self._axis: Point | None = None
        self._low, self._high = -math.pi, math.pi
        self._reach = 0.0

    def admits(self, point: Point) -> bool:
        """Whether the line may end at `point` instead; never where the way has turned back."""
        if self._axis is None:
            return True
        offset = self._offset(point)
        return math.hypot(*offset) >= self._reach and self._low <= self._direction(offset) <= self._high

    def narrow(self, point: Point) -> None:
        """Leave only the directions that pass near `point` too."""
        offset = self._offset(point)
        distance = math.hypot(*offset)
        if distance <= TOLERANCE:
            return
        if self._axis is None:
            self._axis = offset
        direction, spread = self._direction(offset), math.asin(TOLERANCE / distance)
        self._low, self._high = max(self._low, direction - spread), min(self._high, direction + spread)
        self._reach = max(self._reach, distance)

    def _offset(self, point: Point) -> Point:
        return (point[0] - self._apex[0], point[1] - self._apex[1])

    def _direction(self, offset: Point) -> float:
        assert self._axis is not None
        (ax, ay), (x, y) = self._axis, offset
        return math.atan2(ax * y - ay * x, ax * x + ay * y)


class Trail:
    """The strokes of all turtles, oldest first."""

    def __init__(self) -> None:
        self.strokes: list[Stroke] = []
        #: Whether the oldest part has been forgotten because there was too much.
        self.forgotten = False
        self._latest: dict[str, Stroke] = {}
        self._size = 0

    def line(self, turtle: str, pen: Pen, start: Point, end: Point) -> None:
        """`turtle` draws from `start` to `end`: its last stroke continues, or a new one begins."""
        stroke = self._latest.get(turtle)
        if stroke is None or stroke.pen != pen or stroke.points[-1] != start:
            stroke = self._latest[turtle] = Stroke(turtle, pen, [start])
            self.strokes.append(stroke)
            self._size += 1 + _STROKE_COST
        points_before = len(stroke.points)
        stroke.extend(end)
        self._size += len(stroke.points) - points_before
        self._forget_the_oldest()

    def _forget_the_oldest(self) -> None:
        while self._size > MAX_POINTS:
            self.forgotten = True
            oldest = self.strokes[0]
            if len(oldest.points) > 2 * _FORGET:
                del oldest.points[:_FORGET]
                self._size -= _FORGET
            else:
                del self.strokes[0]
                self._size -= len(oldest.points) + _STROKE_COST
                if self._latest.get(oldest.turtle) is oldest:
                    del self._latest[oldest.turtle]


#: Between two samples the turtle is within this of a steady move (units; rad): half a pixel, one degree.
PLACE_TOLERANCE, HEADING_TOLERANCE = 0.01, 0.02
#: Beyond this many samples the oldest are forgotten, this many at a time.
MAX_SAMPLES, _TRACK_FORGET = 3_000, 500


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
            del self.samples[:_TRACK_FORGET]
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
    """Fewer samples. As in a track, everything between two of them is within these tolerances (units, rad)."""
    track = Track(place, heading)
    for sample in samples:
        track.add(sample.tick, sample.x, sample.y, sample.theta, sample.pen)
    return track.samples


def moves(samples: Iterable[Sample]) -> bool:
    """Whether there is anything to see: two samples that differ."""
    return len({(sample.x, sample.y, sample.theta) for sample in samples}) > 1
