"""Gets the world from the turtlesim that runs, whichever it is, and draws it."""

from __future__ import annotations

import importlib
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import rclpy
from rclpy.context import Context
from rclpy.exceptions import InvalidServiceNameException
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from rclpy.signals import SignalHandlerOptions
from std_srvs.srv import Trigger

from spinbook.turtlesim.drawing import save
from spinbook.turtlesim.events import Pen
from spinbook.turtlesim.geometry import DT, SIDE
from spinbook.turtlesim.moving import moving_svg
from spinbook.turtlesim.program import Pose
from spinbook.turtlesim.trail import Point, Track, Trail
from spinbook.turtlesim.world_picture import BLUE, TurtlePicture, WorldPicture, strokes, tracks

#: The type of a turtle's poses.
POSE = "turtlesim/msg/Pose"


class Heard:
    """Listens to `topic`, one turtle's poses, from the first `look` that finds it; `node` must be spun meanwhile."""

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
            self._node.create_subscription(Pose, self.topic, self._hear, 50)
            self._listening = True

    def _published_types(self) -> list[str]:
        return sorted({each.topic_type for each in self._node.get_publishers_info_by_topic(self.topic)})

    def _hear(self, pose: Pose) -> None:
        here: Point = (pose.x, pose.y)
        before = here if self._last is None else (self._last.x, self._last.y)
        if here != before:
            self._trail.line(self._turtle, Pen(), before, here)
        self._last = pose
        # Poses do not tell their time; two that come together are a tick apart.
        self._last_tick = max(self._last_tick + 1, round(time.monotonic() / DT))
        self._track.add(self._last_tick, pose.x, pose.y, pose.theta, Pen())

    def picture(self, incomplete: str) -> WorldPicture | None:
        """The path heard so far in turtlesim's usual colours, which poses don't tell; None if nothing came."""
        if self._last is None:
            return None
        turtle = TurtlePicture(self._turtle, self._last.x, self._last.y, self._last.theta, Pen())
        trails, moved = strokes(self._trail.strokes), tracks({self._turtle: self._track})
        return WorldPicture(SIDE, BLUE, (turtle,), trails, incomplete, moved)

    def unreadable_types(self) -> list[str]:
        """What is published on the topic and is not a turtle's pose."""
        return [found for found in self._published_types() if found != POSE]


# `python -m spinbook.turtlesim.picture OUT.png|OUT.svg` does so from a command line.


#: The node's full name where nobody has put it elsewhere.
NODE = "/turtlesim"
#: How long to look for a turtlesim node, and how long to listen where it has no picture to give, in s.
TIMEOUT_S, LISTEN_S = 5.0, 7.0
# The node has been found and is answering: a big picture on a busy machine may take long.
_ANSWER_S = 30.0


class NoPictureError(Exception):
    """There is no picture to be had; the message says why and what to do."""


def fetch(timeout_s: float = TIMEOUT_S, listen_s: float = LISTEN_S, node: str = NODE) -> WorldPicture:
    """The world as the turtlesim node `node` tells it.

    Our own node is asked for its picture, for `timeout_s` s at most until it is found. Where none answers to that,
    as with the turtlesim of a ROS installation, the picture is the path of turtle1 as heard on its pose topic within
    `listen_s` s. Works beside other ROS code in the same process: it has a context of its own.

    Raises:
        NoPictureError: if nothing is found or heard.
    """
    namespace = node.rpartition("/")[0]
    with _spinning() as (executor, ears):
        heard = Heard(ears, f"{namespace}/turtle1/pose")
        try:
            client = ears.create_client(Trigger, f"{node}/picture")
        except InvalidServiceNameException as error:
            raise NoPictureError(f"{node!r} is no name of a node: give one such as {NODE}") from error
        start = time.monotonic()
        while not client.service_is_ready() and time.monotonic() < start + timeout_s:
            heard.look()
            executor.spin_once(timeout_sec=0.02)
        if client.service_is_ready():
            answer = client.call_async(Trigger.Request())
            executor.spin_until_future_complete(answer, timeout_sec=_ANSWER_S)
            return _read(node, answer.result() if answer.done() else None)
        while time.monotonic() < start + listen_s:
            heard.look()
            executor.spin_once(timeout_sec=0.02)
        return _heard(heard, node, time.monotonic() - start)


@contextmanager
def _spinning() -> Iterator[tuple[SingleThreadedExecutor, Node]]:
    """A node that nobody else in this process has to do with."""
    context = Context()
    rclpy.init(context=context, signal_handler_options=SignalHandlerOptions.NO)
    try:
        ears = Node(
            "turtle_picture",
            context=context,
            use_global_arguments=False,
            start_parameter_services=False,
            enable_rosout=False,
        )
        executor = SingleThreadedExecutor(context=context)
        executor.add_node(ears)
        yield executor, ears
        executor.shutdown()
        ears.destroy_node()
    finally:
        context.try_shutdown()


def _read(node: str, answer: Trigger.Response | None) -> WorldPicture:
    if answer is None:
        raise NoPictureError(f"{node} did not answer within {_ANSWER_S:.0f} s. Is it stopped or very busy?")
    try:
        return WorldPicture.from_json(answer.message)
    except ValueError as error:
        raise NoPictureError(f"{node}/picture answered with something else: {error}") from error


def _heard(heard: Heard, node: str, seconds: float) -> WorldPicture:
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


def write(file: Path, timeout_s: float, listen_s: float, node: str, moving: Path | None = None) -> WorldPicture:
    """Fetch the world and write its picture to `file`, and the moving one to `moving` if a turtle has moved.

    Raises:
        NoPictureError: if there is none, or it can't be written there.
    """
    if file.suffix.lower() not in (".png", ".svg"):
        raise NoPictureError(f"{file}: a picture's name must end in .png or .svg")
    world = fetch(timeout_s, listen_s, node)
    try:
        save(world, file)
        if moving is not None and (svg := moving_svg(world)) is not None:
            moving.write_text(svg, encoding="utf-8")
    except OSError as error:
        raise NoPictureError(f"{error.filename or file} can't be written: {error.strerror}") from error
    return world


if __name__ == "__main__":
    importlib.import_module("spinbook.turtlesim.command").turtle()
