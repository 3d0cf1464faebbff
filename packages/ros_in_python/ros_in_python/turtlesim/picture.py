"""Fetches the world from the running turtlesim, ours or the real one, and draws it."""

from __future__ import annotations

import time
from pathlib import Path
from typing import Any

from rclpy.exceptions import InvalidServiceNameException
from rclpy.node import Node
from std_srvs.srv import Trigger

from groundwork.files import write_if_changed
from ros_in_python.ros2.opening import open_graph
from ros_in_python.turtlesim.events import DT, SIDE, Pen
from ros_in_python.turtlesim.messages import Pose
from ros_in_python.turtlesim.moving import world_svg
from ros_in_python.turtlesim.trail import Point, Track, Trail
from ros_in_python.turtlesim.world_picture import BLUE, TurtlePicture, WorldPicture, strokes, tracks


def save(world: WorldPicture, file: Path, *, moves: bool = True) -> None:
    """Write the picture as SVG, all at once; the same bytes for the same world. Raises OSError if it can't be written.

    If `moves`, the turtles that have moved drive again.
    """
    write_if_changed(file, world_svg(world, moves=moves).encode())


#: The type of a turtle's poses.
POSE = "turtlesim/msg/Pose"


class PoseListener:
    """Listens to one turtle's poses on `topic`, from the first `look` that finds it; `node` must be spun meanwhile."""

    def __init__(self, node: Node, topic: str) -> None:
        self.topic = topic
        self._turtle = topic.split("/")[-2]
        self._node = node
        self._trail = Trail()
        self._track = Track()
        self._last: Any = None
        self._last_tick = -1
        self._listening = False

    def look(self) -> None:
        """Listen as soon as somebody publishes poses."""
        if not self._listening and POSE in self._published_types():
            self._node.create_subscription(Pose, self.topic, self._on_pose, 50)
            self._listening = True

    def _published_types(self) -> list[str]:
        return sorted({each.topic_type for each in self._node.get_publishers_info_by_topic(self.topic)})

    def _on_pose(self, pose: Pose) -> None:
        here: Point = (pose.x, pose.y)
        before = here if self._last is None else (self._last.x, self._last.y)
        if here != before:
            self._trail.line(self._turtle, Pen(), before, here)
        self._last = pose
        # Poses do not say their time; two that arrive together are a tick apart.
        self._last_tick = max(self._last_tick + 1, round(time.monotonic() / DT))
        self._track.add(self._last_tick, pose.x, pose.y, pose.theta, Pen())

    def picture(self, incomplete: str) -> WorldPicture | None:
        """Return the path so far, in turtlesim's usual colours, which poses don't say; None if there was no pose."""
        if self._last is None:
            return None
        turtle = TurtlePicture(self._turtle, self._last.x, self._last.y, self._last.theta, Pen())
        trails, moved = strokes(self._trail.strokes), tracks({self._turtle: self._track})
        return WorldPicture(SIDE, BLUE, (turtle,), trails, incomplete, moved)

    def unreadable_types(self) -> list[str]:
        """Return the types that are published on the topic and are not a turtle's pose."""
        return [found for found in self._published_types() if found != POSE]


#: The node's full name, unless it was remapped.
NODE = "/turtlesim"
#: How long to look for a turtlesim node, and how long to listen to one that has no picture, in s.
TIMEOUT_S, LISTEN_S = 5.0, 7.0
# The node has been found and is answering: a big picture on a busy machine may take long.
_ANSWER_S = 30.0


class NoPictureError(Exception):
    """There is no picture; the message says why and what to do."""


def fetch(timeout_s: float = TIMEOUT_S, listen_s: float = LISTEN_S, node: str = NODE) -> WorldPicture:
    """Return the world as the turtlesim node `node` reports it.

    Our own node is asked for its picture, for `timeout_s` s at most until it is found. Where none answers to that,
    as with the turtlesim of a ROS installation, the picture is the path of turtle1 as heard on its pose topic within
    `listen_s` s. Works next to other ROS code in the same process: it has its own context.

    Raises:
        NoPictureError: if nothing is found or heard.
        CommandError: if rclpy can't work in this environment.
    """
    namespace = node.rpartition("/")[0]
    with open_graph(node_name="turtle_picture") as graph:
        heard = PoseListener(graph.node, f"{namespace}/turtle1/pose")
        try:
            client = graph.node.create_client(Trigger, f"{node}/picture")
        except InvalidServiceNameException as error:
            raise NoPictureError(f"{node!r} is not a valid node name: give one such as {NODE}") from error

        def look(is_over: bool = False) -> bool:
            heard.look()
            return is_over

        start = time.monotonic()
        if graph.spin_until(lambda: look(client.service_is_ready()), timeout_s):
            answer = client.call_async(Trigger.Request())
            graph.spin_until(answer.done, _ANSWER_S)
            return _read(node, answer.result() if answer.done() else None)
        graph.spin_until(look, start + listen_s - time.monotonic())
        return _heard(heard, node, time.monotonic() - start)


def _read(node: str, answer: Trigger.Response | None) -> WorldPicture:
    if answer is None:
        raise NoPictureError(f"{node} did not answer within {_ANSWER_S:.0f} s. Is it stopped or very busy?")
    try:
        return WorldPicture.from_json(answer.message)
    except ValueError as error:
        raise NoPictureError(f"{node}/picture answered with something else: {error}") from error


def _heard(heard: PoseListener, node: str, seconds: float) -> WorldPicture:
    picture = heard.picture(f"only what was heard in {seconds:.0f} s")
    if picture is not None:
        return picture
    if types := heard.unreadable_types():
        raise NoPictureError(
            f"{heard.topic} carries {', '.join(types)}, which this Python can't read: "
            "source the ROS installation that the turtlesim belongs to."
        )
    raise NoPictureError(
        f"No turtlesim is running: no {node}, and nothing on {heard.topic} for {seconds:.0f} s.\n"
        "Start one with `ros2 run turtlesim turtlesim_node`. If one runs, does it have the same ROS_DOMAIN_ID?"
    )


def write(file: Path, timeout_s: float, listen_s: float, node: str, *, moves: bool = True) -> WorldPicture:
    """Fetch the world and write its picture to `file`, as `save` does.

    Raises:
        NoPictureError: if there is none, or it can't be written there.
    """
    world = fetch(timeout_s, listen_s, node)
    try:
        save(world, file, moves=moves)
    except OSError as error:
        raise NoPictureError(f"{error.filename or file} can't be written: {error.strerror}") from error
    return world
