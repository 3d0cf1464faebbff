"""What the turtles have drawn, as few straight lines as keep its shape."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

from spinbook.turtlesim.pen import Pen

Point = tuple[float, float]

#: A point is left out where the line without it passes this near (units): a fifth of a pixel.
TOLERANCE = 0.004
#: Beyond this many points the oldest are forgotten, so that a turtle may drive for ever.
MAX_POINTS = 30_000
#: A stroke's colour, width and name count as so many points: they take that much room in a message.
_STROKE_COST = 6
#: So many points of a long stroke are forgotten at a time.
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
        """`turtle` draws from `start` to `end`: its last stroke goes on, or a new one begins."""
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
