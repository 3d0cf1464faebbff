"""The turtles' topics, services and action, and how their messages are filled."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Any

from geometry_msgs.msg import Twist
from rclpy.action.server import ActionServer, CancelResponse, GoalResponse
from rclpy.node import Node
from rclpy.task import Future
from std_srvs.srv import Empty

from ros_in_python.turtlesim.events import (
    ColorReport,
    Event,
    Outcome,
    PoseReport,
    RotationEnded,
    RotationFeedback,
    TurtleKilled,
    TurtleSpawned,
)
from ros_in_python.turtlesim.messages import (
    Color,
    Kill,
    Pose,
    RotateAbsolute,
    SetPen,
    Spawn,
    TeleportAbsolute,
    TeleportRelative,
)
from ros_in_python.turtlesim.world import TurtleWorld

#: Depth of every queue, as in turtlesim.
DEPTH = 7


@dataclass(frozen=True)
class TurtleEndpoints:
    """The topics, services and the action of one turtle."""

    pose: Any
    color: Any
    command: Any
    services: tuple[Any, ...]
    rotation: ActionServer


class Interface:
    """Offers the world on `node` exactly as turtlesim does.

    `perform` publishes and logs the events that a request has led to.
    """

    def __init__(self, node: Node, world: TurtleWorld, perform: Callable[[list[Event]], None]) -> None:
        self._node = node
        self._world = world
        self._perform = perform
        self._turtles: dict[str, TurtleEndpoints] = {}
        #: Goals that are under way, and what their clients wait for, by the number they have in the world.
        self._goals: dict[int, tuple[Any, Future]] = {}
        self._accepted = 0
        node.create_service(Spawn, "spawn", self._spawn)
        self._serve(Kill, "kill", lambda request: world.kill(request.name))
        self._serve(Empty, "clear", lambda _: world.clear())
        self._serve(Empty, "reset", lambda _: world.reset())

    def publish(self, event: Event) -> None:
        """Publish what has happened; a turtle's topics, services and action come and go with it."""
        if isinstance(event, TurtleSpawned):
            self._turtles[event.turtle] = self._open(event.turtle)
        elif isinstance(event, TurtleKilled):
            self._close(self._turtles.pop(event.turtle))
        elif isinstance(event, PoseReport):
            self._turtles[event.turtle].pose.publish(Pose(**_without_turtle(event)))
        elif isinstance(event, ColorReport):
            self._turtles[event.turtle].color.publish(Color(**_without_turtle(event)))
        elif isinstance(event, RotationFeedback):
            goal, _ = self._goals[event.goal]
            goal.publish_feedback(RotateAbsolute.Feedback(remaining=event.remaining))
        elif isinstance(event, RotationEnded):
            self._end(event)

    def _open(self, turtle: str) -> TurtleEndpoints:
        node, world = self._node, self._world
        services = (
            self._serve(SetPen, f"{turtle}/set_pen", lambda r: world.set_pen(turtle, r.r, r.g, r.b, r.width, r.off)),
            self._serve(
                TeleportAbsolute,
                f"{turtle}/teleport_absolute",
                lambda request: world.teleport_absolute(turtle, request.x, request.y, request.theta),
            ),
            self._serve(
                TeleportRelative,
                f"{turtle}/teleport_relative",
                lambda request: world.teleport_relative(turtle, request.linear, request.angular),
            ),
        )
        rotation = ActionServer(
            node,
            RotateAbsolute,
            f"{turtle}/rotate_absolute",
            # Each goal brings its own: see _begin.
            execute_callback=_wait_for,
            goal_callback=_accept_finite,
            handle_accepted_callback=partial(self._begin, turtle),
            cancel_callback=partial(self._cancel, turtle),
        )
        return TurtleEndpoints(
            node.create_publisher(Pose, f"{turtle}/pose", DEPTH),
            node.create_publisher(Color, f"{turtle}/color_sensor", DEPTH),
            node.create_subscription(Twist, f"{turtle}/cmd_vel", partial(self._command, turtle), DEPTH),
            services,
            rotation,
        )

    def _close(self, ends: TurtleEndpoints) -> None:
        self._node.destroy_publisher(ends.pose)
        self._node.destroy_publisher(ends.color)
        self._node.destroy_subscription(ends.command)
        for service in ends.services:
            self._node.destroy_service(service)
        ends.rotation.destroy()

    def _serve(self, kind: Any, name: str, act: Callable[[Any], list[Event]]) -> Any:
        """Offer a service whose requests `act` passes to the world, and whose answer is empty."""

        def answer(request: Any, response: Any) -> Any:
            self._perform(act(request))
            return response

        return self._node.create_service(kind, name, answer)

    def _spawn(self, request: Spawn.Request, response: Spawn.Response) -> Spawn.Response:
        events = self._world.spawn(request.x, request.y, request.theta, request.name)
        self._perform(events)
        response.name = next((event.turtle for event in events if isinstance(event, TurtleSpawned)), "")
        return response

    def _command(self, turtle: str, twist: Twist) -> None:
        left = twist.linear.y if self._node.get_parameter("holonomic").value else None
        now_ns = self._node.get_clock().now().nanoseconds
        self._perform(self._world.command(turtle, twist.linear.x, left, twist.angular.z, now_ns))

    def _begin(self, turtle: str, goal: Any) -> None:
        """Begin an accepted goal: from the next tick on, the world turns the turtle."""
        self._accepted += 1
        ended = Future()
        self._goals[self._accepted] = (goal, ended)
        goal.execute(partial(_wait_for, ended))
        self._perform(self._world.rotate(turtle, self._accepted, goal.request.theta))

    def _end(self, event: RotationEnded) -> None:
        goal, ended = self._goals.pop(event.goal)
        end = {Outcome.SUCCEEDED: goal.succeed, Outcome.CANCELED: goal.canceled, Outcome.ABORTED: goal.abort}
        end[event.outcome]()
        ended.set_result(RotateAbsolute.Result(delta=event.delta))

    def _cancel(self, turtle: str, goal: Any) -> CancelResponse:
        number = next((number for number, (known, _) in self._goals.items() if known is goal), None)
        if number is not None:
            self._world.cancel_rotation(turtle, number)
        return CancelResponse.ACCEPT


def _without_turtle(report: PoseReport | ColorReport) -> dict[str, Any]:
    """Return a report's fields as those of its message, which does not say whose it is."""
    return {name: value for name, value in vars(report).items() if name != "turtle"}


async def _wait_for(ended: Future, _: Any) -> RotateAbsolute.Result:
    return await ended


def _accept_finite(goal: RotateAbsolute.Goal) -> GoalResponse:
    return GoalResponse.ACCEPT if math.isfinite(goal.theta) else GoalResponse.REJECT
