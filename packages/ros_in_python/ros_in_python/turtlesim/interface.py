"""The turtles' topics, services and action, and how their messages are filled."""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import partial
from typing import Any, TypeVar

from rclpy.action.server import ActionServer, CancelResponse, GoalResponse
from rclpy.node import Node
from rclpy.task import Future

from ros_in_python.turtlesim.events import (
    ColorReport,
    Event,
    Outcome,
    PoseReport,
    RotationEnded,
    RotationFeedback,
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

# No message type is imported here: whatever has the fields will do.


Message = TypeVar("Message", bound=Any)


def fill_pose(message: Message, pose: PoseReport) -> Message:
    """Fill a turtlesim/msg/Pose."""
    message.x, message.y, message.theta = pose.x, pose.y, pose.theta
    message.linear_velocity, message.angular_velocity = pose.linear_velocity, pose.angular_velocity
    return message


def fill_color(message: Message, color: ColorReport) -> Message:
    """Fill a turtlesim/msg/Color."""
    message.r, message.g, message.b = color.r, color.g, color.b
    return message


def spawn(world: TurtleWorld, request: Any) -> list[Event]:
    """Spawn a turtle; `request` has the fields of turtlesim/srv/Spawn."""
    return world.spawn(request.x, request.y, request.theta, request.name)


def set_pen(world: TurtleWorld, turtle: str, request: Any) -> list[Event]:
    """Set a pen; `request` has the fields of turtlesim/srv/SetPen."""
    return world.set_pen(turtle, request.r, request.g, request.b, request.width, request.off)


def teleport_absolute(world: TurtleWorld, turtle: str, request: Any) -> list[Event]:
    """Teleport a turtle; `request` has the fields of turtlesim/srv/TeleportAbsolute."""
    return world.teleport_absolute(turtle, request.x, request.y, request.theta)


def teleport_relative(world: TurtleWorld, turtle: str, request: Any) -> list[Event]:
    """Teleport a turtle; `request` has the fields of turtlesim/srv/TeleportRelative."""
    return world.teleport_relative(turtle, request.linear, request.angular)


#: Depth of every queue, as in turtlesim.
DEPTH = 7


class Interface:
    """Offers the world on `node` exactly as turtlesim does.

    `perform` publishes and logs the events that a request has led to.
    """

    def __init__(self, node: Node, world: TurtleWorld, perform: Callable[[list[Event]], None]) -> None:
        self._node = node
        self._world = world
        self._perform = perform
        self._poses: dict[str, Any] = {}
        self._colors: dict[str, Any] = {}
        self._services: dict[str, list[Any]] = {}
        self._actions: dict[str, ActionServer] = {}
        #: Goals that are under way, and what their clients wait for, by the number they have in the world.
        self._goals: dict[int, tuple[Any, Future]] = {}
        self._accepted = 0
        node.create_service(Spawn, "spawn", self._spawn)
        node.create_service(Kill, "kill", self._kill)

    def add(self, turtle: str) -> None:
        """Open the topics, services and the action of a turtle."""
        node = self._node
        self._poses[turtle] = node.create_publisher(Pose, f"{turtle}/pose", DEPTH)
        self._colors[turtle] = node.create_publisher(Color, f"{turtle}/color_sensor", DEPTH)
        requests: list[tuple[str, type, Callable[[TurtleWorld, str, Any], list[Event]]]] = [
            ("set_pen", SetPen, set_pen),
            ("teleport_absolute", TeleportAbsolute, teleport_absolute),
            ("teleport_relative", TeleportRelative, teleport_relative),
        ]
        self._services[turtle] = [
            node.create_service(kind, f"{turtle}/{name}", partial(self._answer, act, turtle))
            for name, kind, act in requests
        ]
        self._actions[turtle] = ActionServer(
            node,
            RotateAbsolute,
            f"{turtle}/rotate_absolute",
            # Each goal brings its own: see _begin.
            execute_callback=_wait_for,
            goal_callback=_accept_finite,
            handle_accepted_callback=partial(self._begin, turtle),
            cancel_callback=partial(self._cancel, turtle),
        )

    def remove(self, turtle: str) -> None:
        """Close the topics, services and the action of a turtle."""
        self._node.destroy_publisher(self._poses.pop(turtle))
        self._node.destroy_publisher(self._colors.pop(turtle))
        for service in self._services.pop(turtle):
            self._node.destroy_service(service)
        self._actions.pop(turtle).destroy()

    def publish(self, event: Event) -> None:
        """Publish what has happened."""
        if isinstance(event, PoseReport):
            self._poses[event.turtle].publish(fill_pose(Pose(), event))
        elif isinstance(event, ColorReport):
            self._colors[event.turtle].publish(fill_color(Color(), event))
        elif isinstance(event, RotationFeedback):
            goal, _ = self._goals[event.goal]
            goal.publish_feedback(RotateAbsolute.Feedback(remaining=event.remaining))
        elif isinstance(event, RotationEnded):
            self._end(event)

    def _spawn(self, request: Spawn.Request, response: Spawn.Response) -> Spawn.Response:
        events = spawn(self._world, request)
        self._perform(events)
        response.name = next((event.turtle for event in events if isinstance(event, TurtleSpawned)), "")
        return response

    def _kill(self, request: Kill.Request, response: Kill.Response) -> Kill.Response:
        self._perform(self._world.kill(request.name))
        return response

    def _answer(
        self, act: Callable[[TurtleWorld, str, Any], list[Event]], turtle: str, request: Any, response: Any
    ) -> Any:
        self._perform(act(self._world, turtle, request))
        return response

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


async def _wait_for(ended: Future, _: Any) -> RotateAbsolute.Result:
    return await ended


def _accept_finite(goal: RotateAbsolute.Goal) -> GoalResponse:
    return GoalResponse.ACCEPT if math.isfinite(goal.theta) else GoalResponse.REJECT
