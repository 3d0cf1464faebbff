"""What the turtles have drawn, and where each was when, in as few lines and samples as keep the shape."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field

from ros_in_python.thinning import SwingDoor
from ros_in_python.turtlesim.events import Pen

Point = tuple[float, float]

#: A point is left out if the line without it passes this near (units): a fifth of a pixel.
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
    _length: float = field(default=0.0, repr=False)
    _door: SwingDoor = field(default_factory=lambda: SwingDoor([TOLERANCE / math.sqrt(2)] * 2), repr=False)

    def __post_init__(self) -> None:
        self._door.replaces_latest(self._length, self.points[-1])

    def extend(self, point: Point) -> None:
        """Continue to `point` in a straight line."""
        self._length += math.dist(self.points[-1], point)
        if self._door.replaces_latest(self._length, point):
            self.points.pop()
        self.points.append(point)


class Trail:
    """The strokes of all turtles, oldest first."""

    def __init__(self) -> None:
        self.strokes: list[Stroke] = []
        #: Whether the oldest part has been forgotten because there was too much.
        self.forgotten = False
        self._latest: dict[str, Stroke] = {}
        self._size = 0

    def line(self, turtle: str, pen: Pen, start: Point, end: Point) -> None:
        """Draw from `start` to `end` as `turtle`: continue its last stroke, or begin a new one."""
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
class TrackSample:
    """A turtle at a tick (16 ms each): x and y in units, y up; theta in rad, counted on beyond a full turn.

    `pen` is what it drew with on its way from the sample before, None if it drew nothing.
    """

    tick: int
    x: float
    y: float
    theta: float
    pen: Pen | None


class Track:
    """The samples of one turtle, thinned as they come: between two of them everything changes steadily."""

    def __init__(self, place: float = PLACE_TOLERANCE, heading: float = HEADING_TOLERANCE) -> None:
        self.samples: list[TrackSample] = []
        #: Whether the oldest part has been forgotten because there was too much.
        self.forgotten = False
        self._door = SwingDoor([place, place, heading])

    def add(self, tick: int, x: float, y: float, theta: float, pen: Pen | None) -> None:
        """Add where the turtle is at `tick`, which is later than all before; theta may be off by full turns."""
        if self.samples:
            before = self.samples[-1].theta
            theta = before + math.remainder(theta - before, 2 * math.pi)
        sample = TrackSample(tick, x, y, theta, None if pen is None or pen.off else pen)
        has_other_pen = bool(self.samples) and sample.pen != self.samples[-1].pen
        if self._door.replaces_latest(tick, (x, y, theta), is_corner=has_other_pen):
            self.samples.pop()
        self.samples.append(sample)
        if len(self.samples) > MAX_SAMPLES:
            del self.samples[:_TRACK_FORGET]
            self.forgotten = True


def thinned(samples: Sequence[TrackSample], place: float, heading: float) -> list[TrackSample]:
    """Return fewer samples: between two of them, the track is within these tolerances (units, rad)."""
    track = Track(place, heading)
    for sample in samples:
        track.add(sample.tick, sample.x, sample.y, sample.theta, sample.pen)
    return track.samples


def moves(samples: Iterable[TrackSample]) -> bool:
    """Return whether two samples differ."""
    return len({(sample.x, sample.y, sample.theta) for sample in samples}) > 1
