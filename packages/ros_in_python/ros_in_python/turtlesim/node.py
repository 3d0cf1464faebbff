"""The node `turtlesim`: `python -m ros_in_python.turtlesim.node` is what `ros2 run turtlesim turtlesim_node` runs."""

from __future__ import annotations

import sys

from rcl_interfaces.msg import IntegerRange, ParameterDescriptor
from rclpy.clock import ROSClock
from rclpy.exceptions import InvalidParameterTypeException, InvalidParameterValueException
from rclpy.node import Node
from std_srvs.srv import Trigger

from ros_in_python.spinning import spin_until_stopped
from ros_in_python.turtlesim.events import TICK_NS, Event, LogLevel, LogLine
from ros_in_python.turtlesim.interface import Interface
from ros_in_python.turtlesim.world import TurtleWorld
from ros_in_python.turtlesim.world_picture import BLUE, picture_of

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
        """Yield the times (ns) of the ticks that are due now."""
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


_NS_PER_S = 1_000_000_000


class Turtlesim:
    """The world of the turtles on ROS: parameters, services and topics of turtlesim, and ~/picture for drawing."""

    def __init__(self) -> None:
        self.node = Node("turtlesim")
        self._declare_parameters()
        self._world = TurtleWorld()
        self._pacing = Pacing()
        self._interface = Interface(self.node, self._world, self._perform)
        self.node.create_service(Trigger, "~/picture", self._picture)
        self.node.get_logger().info(f"Starting turtlesim with node name {self.node.get_fully_qualified_name()}")
        self._perform(self._world.start())
        self.node.create_timer(TICK_NS / _NS_PER_S, self._tick)

    def _declare_parameters(self) -> None:
        part = IntegerRange(from_value=0, to_value=255, step=1)
        for name, default in zip(("r", "g", "b"), BLUE, strict=True):
            text = f"How much of {name} is in the background's colour"
            descriptor = ParameterDescriptor(description=text, integer_range=[part])
            self.node.declare_parameter(f"background_{name}", default, descriptor)
        text = "Whether linear.y of a command moves a turtle sideways"
        self.node.declare_parameter("holonomic", False, ParameterDescriptor(description=text))

    def _perform(self, events: list[Event]) -> None:
        """Log and publish what has happened."""
        for event in events:
            if isinstance(event, LogLine):
                self._log(event)
            else:
                self._interface.publish(event)

    def _log(self, line: LogLine) -> None:
        # rclpy wants a source line of its own for each severity.
        if line.severity is LogLevel.INFO:
            self.node.get_logger().info(line.text)
        elif line.severity is LogLevel.WARN:
            self.node.get_logger().warning(line.text)
        else:
            self.node.get_logger().error(line.text)

    def _picture(self, _: Trigger.Request, response: Trigger.Response) -> Trigger.Response:
        r, g, b = (self.node.get_parameter(f"background_{part}").value for part in "rgb")
        response.success = True
        response.message = picture_of(self._world, (r, g, b)).to_json()
        return response

    def _tick(self) -> None:
        clock = self.node.get_clock()
        simulated = isinstance(clock, ROSClock) and clock.ros_time_is_active
        for now_ns in self._pacing.due(clock.now().nanoseconds, simulated):
            self._perform(self._world.tick(now_ns))


def main() -> int:
    """Run the node until it is stopped; return the exit code."""
    try:
        return spin_until_stopped(lambda: Turtlesim().node)
    except (InvalidParameterTypeException, InvalidParameterValueException) as error:
        print(f"turtlesim: a parameter can't be used: {error}", file=sys.stderr)
        return 1


if __name__ == "__main__":
    sys.exit(main())
