"""One turtle: how it moves in a tick. turtlesim's arithmetic (1.8.2), in its order and precision."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass

from ros_in_python.turtlesim.canvas import Canvas
from ros_in_python.turtlesim.events import (
    COMMAND_TIMEOUT_NS,
    DT,
    SIDE,
    ColorReport,
    Event,
    LogLevel,
    LogLine,
    Outcome,
    Pen,
    PoseReport,
    RotationEnded,
    RotationFeedback,
    normalized,
    single,
)
from ros_in_python.turtlesim.trail import Trail

#: A rotation has reached its goal when less than this remains, in rad.
_ROTATION_TOLERANCE = 0.02
#: A rotation turns at this speed, in rad/s.
_ROTATION_SPEED = 1.0


@dataclass
class Rotation:
    """A goal of rotate_absolute that is under way: heading to reach and at the start, in rad."""

    goal: int
    theta: float
    start: float
    delta: float = 0.0
    cancel_requested: bool = False


class SimulatedTurtle:
    """A turtle with its pen. `y` is kept downwards from the upper edge, as turtlesim does."""

    def __init__(self, name: str, x: float, y: float, theta: float) -> None:
        self.name = name
        self.x, self.y_down, self.theta = x, single(SIDE - y), theta
        self.pen = Pen()
        self.rotation: Rotation | None = None
        self._forward = self._left = self._turn = 0.0
        self._commanded_ns = 0
        self._jumps: list[Callable[[], None]] = []

    @property
    def y(self) -> float:
        """The distance from the lower edge, in units."""
        return SIDE - self.y_down

    def command(self, forward: float, left: float | None, turn: float, now_ns: int) -> list[Event]:
        """Take velocities (units/s, rad/s); a `left` of None leaves the old one. Ends a rotation."""
        self._forward, self._turn = forward, turn
        if left is not None:
            self._left = left
        self._commanded_ns = now_ns
        return self.abort_rotation("Velocity command received during rotation goal. Aborting goal")

    def teleport(self, x: float, y: float, theta: float) -> None:
        """Jump to a place (units, y up) and heading (rad), at the next tick."""

        def jump() -> None:
            self.x, self.theta = x, theta
            self.y_down = max(0.0, single(SIDE - y))

        self._jumps.append(jump)

    def teleport_by(self, linear: float, angular: float) -> None:
        """Turn by `angular` (rad), then jump by `linear` units along the new heading, at the next tick."""

        def jump() -> None:
            self.theta += angular
            self.x += math.cos(self.theta) * linear
            self.y_down -= math.sin(self.theta) * linear

        self._jumps.append(jump)

    def rotate(self, goal: int, theta: float) -> list[Event]:
        """Turn to the heading `theta` (rad), instead of any rotation that is under way."""
        events = self.abort_rotation("Rotation goal received before a previous goal finished. Aborting previous goal")
        self.rotation = Rotation(goal, theta, self.theta)
        return events

    def abort_rotation(self, why: str) -> list[Event]:
        """End the rotation that is under way, if any, and warn."""
        if self.rotation is None:
            return []
        return [LogLine(LogLevel.WARN, why), self._end_rotation(self.rotation, Outcome.ABORTED)]

    def tick(self, now_ns: int, canvas: Canvas, trail: Trail) -> Iterator[Event]:
        """Move on by DT. `now_ns` gives the age of the last command."""
        self._jump(canvas, trail)
        yield from self._steer(now_ns)
        if now_ns - self._commanded_ns > COMMAND_TIMEOUT_NS:
            self._stop()
        before = (self.x, self.y_down)
        yield from self._move()
        yield self._pose()
        yield ColorReport(self.name, *canvas.color((self.x, self.y_down)))
        if (self.x, self.y_down) != before:
            self._draw(before, canvas, trail)

    def _jump(self, canvas: Canvas, trail: Trail) -> None:
        for jump in self._jumps:
            before = (self.x, self.y_down)
            jump()
            self._draw(before, canvas, trail)
        self._jumps.clear()

    def _steer(self, now_ns: int) -> Iterator[Event]:
        """Let the rotation that is under way set the velocities."""
        rotation = self.rotation
        if rotation is None:
            return
        if rotation.cancel_requested:
            yield LogLine(LogLevel.INFO, "Rotation goal canceled")
            yield self._end_rotation(rotation, Outcome.CANCELED)
            self._stop()
            return
        remaining = normalized(normalized(rotation.theta) - single(self.theta))
        rotation.delta = single(normalized(single(rotation.start - self.theta)))
        yield RotationFeedback(self.name, rotation.goal, single(remaining))
        if abs(remaining) < _ROTATION_TOLERANCE:
            yield LogLine(LogLevel.INFO, "Rotation goal completed successfully")
            yield self._end_rotation(rotation, Outcome.SUCCEEDED)
            self._stop()
            return
        self._stop()
        self._turn = -_ROTATION_SPEED if remaining < 0 else _ROTATION_SPEED
        self._commanded_ns = now_ns

    def _end_rotation(self, rotation: Rotation, outcome: Outcome) -> Event:
        self.rotation = None
        return RotationEnded(self.name, rotation.goal, outcome, rotation.delta)

    def _stop(self) -> None:
        self._forward = self._left = self._turn = 0.0

    def _move(self) -> Iterator[Event]:
        """Change the heading first, then the place along the new heading, then apply the walls."""
        self.theta = normalized(self.theta + self._turn * DT)
        cos, sin = math.cos(self.theta), math.sin(self.theta)
        self.x += cos * self._forward * DT - sin * self._left * DT
        self.y_down -= (cos * self._left + sin * self._forward) * DT
        if not (0 <= self.x <= SIDE and 0 <= self.y_down <= SIDE):
            wall = f"Oh no! I hit the wall! (Clamping from [x={self.x:f}, y={self.y_down:f}])"
            yield LogLine(LogLevel.WARN, wall)
        self.x = min(max(self.x, 0.0), SIDE)
        self.y_down = min(max(self.y_down, 0.0), SIDE)

    def _pose(self) -> PoseReport:
        speed = math.hypot(self._forward, self._left)
        parts = (self.x, self.y, self.theta, speed, self._turn)
        return PoseReport(self.name, *(single(part) for part in parts))

    def _draw(self, before: tuple[float, float], canvas: Canvas, trail: Trail) -> None:
        if self.pen.off:
            return
        x, y_down = before
        canvas.line(before, (self.x, self.y_down), self.pen)
        trail.line(self.name, self.pen, (x, SIDE - y_down), (self.x, self.y))
