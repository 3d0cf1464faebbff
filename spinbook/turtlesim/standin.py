"""The turtles' topics where turtlesim's own message types are missing: which ROS type stands in for which.

turtlesim's types need compiled type support, which PyPI does not have. The names stay; every type is one that the
reader can write on a command line. docs/turtlesim.md holds the table for users.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

from action_msgs.msg import GoalStatus
from geometry_msgs.msg import Pose2D, Twist
from rclpy.node import Node
from std_msgs.msg import ColorRGBA, Float32, String
from std_srvs.srv import Trigger

from spinbook.turtlesim import fields
from spinbook.turtlesim.events import ColorReport, Event, Outcome, PoseReport, RotationEnded, RotationFeedback
from spinbook.turtlesim.requests import SetPenRequest, SpawnRequest, read_request
from spinbook.turtlesim.world import World

#: Depth of every queue, as in turtlesim.
DEPTH = 7

STATEMENT = (
    "turtlesim's message types are not installed. In their place: pose is geometry_msgs/msg/Pose2D, color_sensor "
    "std_msgs/msg/ColorRGBA (0 to 1); spawn, kill, set_pen, teleport_absolute, teleport_relative and rotate_absolute "
    "are topics (ros2 topic list -t shows their types)."
)

_STATUS = {
    Outcome.SUCCEEDED: GoalStatus.STATUS_SUCCEEDED,
    Outcome.CANCELED: GoalStatus.STATUS_CANCELED,
    Outcome.ABORTED: GoalStatus.STATUS_ABORTED,
}


def pose_message(pose: PoseReport) -> Pose2D:
    """x, y (units) and theta (rad); Pose2D has no place for the velocities."""
    return Pose2D(x=pose.x, y=pose.y, theta=pose.theta)


def color_message(color: ColorReport) -> ColorRGBA:
    """The colour with each part in 0..1, opaque."""
    return ColorRGBA(r=color.r / 255, g=color.g / 255, b=color.b / 255, a=1.0)


class StandIn:
    """Offers the world on `node` with the types that are at hand.

    `perform` publishes and logs the events that a request has led to.
    """

    statement = STATEMENT

    def __init__(self, node: Node, world: World, perform: Callable[[list[Event]], None]) -> None:
        self._node = node
        self._world = world
        self._perform = perform
        self._goals = 0
        self._publishers: dict[str, dict[str, Any]] = {}
        self._listeners: dict[str, list[Any]] = {}
        self._cancels: dict[str, Any] = {}
        node.create_subscription(String, "spawn", self._spawn, DEPTH)
        node.create_subscription(String, "kill", self._kill, DEPTH)

    def add(self, turtle: str) -> None:
        """Open the topics of a turtle."""
        node = self._node
        self._publishers[turtle] = {
            "pose": node.create_publisher(Pose2D, f"{turtle}/pose", DEPTH),
            "color": node.create_publisher(ColorRGBA, f"{turtle}/color_sensor", DEPTH),
            "remaining": node.create_publisher(Float32, f"{turtle}/rotate_absolute/remaining", DEPTH),
            "delta": node.create_publisher(Float32, f"{turtle}/rotate_absolute/delta", DEPTH),
            "status": node.create_publisher(GoalStatus, f"{turtle}/rotate_absolute/status", DEPTH),
        }
        requests: list[tuple[str, type, Callable[[str, Any], None]]] = [
            ("set_pen", String, self._set_pen),
            ("teleport_absolute", Pose2D, self._teleport_absolute),
            ("teleport_relative", Twist, self._teleport_relative),
            ("rotate_absolute", Float32, self._rotate),
        ]
        self._listeners[turtle] = [
            node.create_subscription(kind, f"{turtle}/{name}", partial(answer, turtle), DEPTH)
            for name, kind, answer in requests
        ]
        self._cancels[turtle] = node.create_service(
            Trigger, f"{turtle}/rotate_absolute/cancel", partial(self._cancel, turtle)
        )

    def remove(self, turtle: str) -> None:
        """Close the topics of a turtle."""
        for publisher in self._publishers.pop(turtle).values():
            self._node.destroy_publisher(publisher)
        for listener in self._listeners.pop(turtle):
            self._node.destroy_subscription(listener)
        self._node.destroy_service(self._cancels.pop(turtle))

    def publish(self, event: Event) -> None:
        """Send what has happened to whoever listens."""
        if isinstance(event, PoseReport):
            self._publishers[event.turtle]["pose"].publish(pose_message(event))
        elif isinstance(event, ColorReport):
            self._publishers[event.turtle]["color"].publish(color_message(event))
        elif isinstance(event, RotationFeedback):
            self._publishers[event.turtle]["remaining"].publish(Float32(data=event.remaining))
        elif isinstance(event, RotationEnded):
            status = GoalStatus(status=_STATUS[event.outcome])
            status.goal_info.stamp = self._node.get_clock().now().to_msg()
            self._publishers[event.turtle]["status"].publish(status)
            self._publishers[event.turtle]["delta"].publish(Float32(data=event.delta))

    def _spawn(self, request: String) -> None:
        try:
            wanted = read_request(SpawnRequest, request.data)
        except ValueError as error:
            self._node.get_logger().error(f"spawn: {error}")
            return
        self._perform(fields.spawn(self._world, wanted))

    def _kill(self, name: String) -> None:
        self._perform(self._world.kill(name.data.strip()))

    def _set_pen(self, turtle: str, request: String) -> None:
        try:
            pen = read_request(SetPenRequest, request.data)
        except ValueError as error:
            self._node.get_logger().error(f"{turtle}/set_pen: {error}")
            return
        self._perform(fields.set_pen(self._world, turtle, pen))

    def _teleport_absolute(self, turtle: str, to: Pose2D) -> None:
        self._perform(fields.teleport_absolute(self._world, turtle, to))

    def _teleport_relative(self, turtle: str, by: Twist) -> None:
        self._perform(self._world.teleport_relative(turtle, by.linear.x, by.angular.z))

    def _rotate(self, turtle: str, theta: Float32) -> None:
        self._goals += 1
        self._perform(self._world.rotate(turtle, self._goals, theta.data))

    def _cancel(self, turtle: str, _: Trigger.Request, response: Trigger.Response) -> Trigger.Response:
        response.success = self._world.cancel_rotation(turtle)
        response.message = "" if response.success else "no rotation is under way"
        return response
