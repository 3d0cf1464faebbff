"""The world of the turtles: its turtles, its requests, and what a tick does. It uses no ROS and has no clock."""

from __future__ import annotations

import math
import re

from ros_in_python.turtlesim.canvas import Canvas
from ros_in_python.turtlesim.events import CENTRE, SIDE, Event, LogLevel, LogLine, TurtleKilled, TurtleSpawned, single
from ros_in_python.turtlesim.trail import Track, Trail
from ros_in_python.turtlesim.turtle import SimulatedTurtle

# A turtle's name begins the names of its topics, so it must be good for one.
_NAME = re.compile(r"/?[A-Za-z]\w{0,40}(/[A-Za-z]\w{0,40}){0,2}", re.ASCII)


class TurtleWorld:
    """Turtles by name, the canvas they share and the trail they leave.

    Every request returns the events that follow from it. Lengths in units, angles in rad, y up, times in ns of one
    clock, whichever. Requests with a number that is not finite are refused with a warning: turtlesim accepts them, and
    its turtle disappears for good.
    """

    def __init__(self) -> None:
        self.turtles: dict[str, SimulatedTurtle] = {}
        self.canvas = Canvas()
        self.trail = Trail()
        #: The turtles' tracks since the last wipe, by name; one that is gone keeps its track.
        self.tracks: dict[str, Track] = {}
        self._spawned = 0
        self._ticking = False
        self._ticks = 0

    def start(self) -> list[Event]:
        """Put turtle1 into the middle."""
        return self.spawn(CENTRE, CENTRE, 0.0)

    def spawn(self, x: float, y: float, theta: float, name: str = "") -> list[Event]:
        """Add a turtle; without a name it gets the next free one of turtle1, turtle2 …."""
        x, y, theta = single(x), single(y), single(theta)
        if refusal := _refusal("spawn", x, y, theta):
            return refusal
        if name and not _NAME.fullmatch(name):
            text = f"[{name}] can't be the name of a turtle: topics begin with it. "
            return [LogLine(LogLevel.ERROR, text + "Begin with a letter, and use letters, digits and _ only.")]
        if name in self.turtles:
            text = f"A turtle named [{name}] already exists. Choose another name, or call /kill with this one first."
            return [LogLine(LogLevel.ERROR, text)]
        name = name or self._free_name()
        self.turtles[name] = SimulatedTurtle(name, x, y, theta)
        self.tracks.pop(name, None)
        text = f"Spawning turtle [{name}] at x=[{x:f}], y=[{y:f}], theta=[{theta:f}]"
        return [TurtleSpawned(name), LogLine(LogLevel.INFO, text), *_outside(name, x, y)]

    def _free_name(self) -> str:
        while True:
            self._spawned += 1
            if (name := f"turtle{self._spawned}") not in self.turtles:
                return name

    def kill(self, name: str) -> list[Event]:
        """Remove a turtle; what it drew stays."""
        if name not in self.turtles:
            there = ", ".join(sorted(self.turtles)) or "none"
            text = f"Tried to kill turtle [{name}], which does not exist. Turtles that do: {there}."
            return [LogLine(LogLevel.ERROR, text)]
        events = self.turtles[name].abort_rotation(f"Turtle [{name}] is gone. Aborting its rotation goal")
        del self.turtles[name]
        return [*events, TurtleKilled(name)]

    def clear(self) -> list[Event]:
        """Wipe what was drawn; the turtles stay as they are."""
        self._wipe()
        return [LogLine(LogLevel.INFO, "Clearing turtlesim.")]

    def reset(self) -> list[Event]:
        """Begin again with turtle1 alone."""
        events: list[Event] = [LogLine(LogLevel.INFO, "Resetting turtlesim.")]
        for name in sorted(self.turtles):
            events += self.kill(name)
        self._spawned = 0
        self._wipe()
        return events + self.start()

    def _wipe(self) -> None:
        self.canvas.clear()
        self.trail = Trail()
        self.tracks = {}

    def command(self, turtle: str, forward: float, left: float | None, turn: float, now_ns: int) -> list[Event]:
        """Set a turtle's velocities (units/s, rad/s); a `left` of None keeps the old one."""
        if refusal := _refusal(f"{turtle}/cmd_vel", forward, left or 0.0, turn):
            return refusal
        return self.turtles[turtle].command(forward, left, turn, now_ns)

    def set_pen(self, turtle: str, r: int, g: int, b: int, width: int, off: int) -> list[Event]:
        """Set the pen with which a turtle draws: colour and width in 0..255; `off`, unless it is 0, lifts it."""
        self.turtles[turtle].pen = self.turtles[turtle].pen.changed(r, g, b, width, off)
        return []

    def teleport_absolute(self, turtle: str, x: float, y: float, theta: float) -> list[Event]:
        """Set a turtle to a place and heading at the next tick; the walls act after that."""
        x, y, theta = single(x), single(y), single(theta)
        if refusal := _refusal(f"{turtle}/teleport_absolute", x, y, theta):
            return refusal
        self.turtles[turtle].teleport(x, y, theta)
        return _outside(turtle, x, y)

    def teleport_relative(self, turtle: str, linear: float, angular: float) -> list[Event]:
        """Turn a turtle by `angular`, then move it by `linear`, at the next tick."""
        linear, angular = single(linear), single(angular)
        if refusal := _refusal(f"{turtle}/teleport_relative", linear, angular):
            return refusal
        self.turtles[turtle].teleport_by(linear, angular)
        return []

    def rotate(self, turtle: str, goal: int, theta: float) -> list[Event]:
        """Turn a turtle to the heading `theta`; `goal` marks what is reported about it."""
        if refusal := _refusal(f"{turtle}/rotate_absolute", single(theta)):
            return refusal
        return self.turtles[turtle].rotate(goal, single(theta))

    def cancel_rotation(self, turtle: str, goal: int | None = None) -> bool:
        """End a rotation at the next tick, any one without a `goal`; return whether there is one."""
        rotation = self.turtles[turtle].rotation if turtle in self.turtles else None
        if rotation is None or goal not in (None, rotation.goal):
            return False
        rotation.cancel_requested = True
        return True

    def tick(self, now_ns: int) -> list[Event]:
        """Move every turtle on by 16 ms, in the order of their names. The very first tick only begins the count."""
        if not self._ticking:
            self._ticking = True
            return []
        turtles = [self.turtles[name] for name in sorted(self.turtles)]
        for turtle in turtles:
            if turtle.name not in self.tracks:
                self._track(turtle)
        self._ticks += 1
        events = [event for turtle in turtles for event in turtle.tick(now_ns, self.canvas, self.trail)]
        for turtle in turtles:
            self._track(turtle)
        return events

    def _track(self, turtle: SimulatedTurtle) -> None:
        track = self.tracks.setdefault(turtle.name, Track())
        track.add(self._ticks, turtle.x, turtle.y, turtle.theta, turtle.pen)


def _outside(turtle: str, x: float, y: float) -> list[Event]:
    """Return a warning if a turtle's new place is not in the window, otherwise nothing."""
    if 0 <= x <= SIDE and 0 <= y <= SIDE:
        return []
    text = f"[{turtle}] stops at the edge: x={x:g}, y={y:g} is outside. Choose both between 0 and {SIDE:.2f}."
    return [LogLine(LogLevel.WARN, text)]


def _refusal(what: str, *numbers: float) -> list[Event]:
    """Return a warning if a number is infinite or NaN, otherwise nothing."""
    if all(math.isfinite(number) for number in numbers):
        return []
    text = ", ".join(f"{number:f}" for number in numbers)
    return [
        LogLine(
            LogLevel.WARN,
            f"Ignoring a request for {what} with numbers that are not finite: {text}. Pass finite numbers.",
        )
    ]
