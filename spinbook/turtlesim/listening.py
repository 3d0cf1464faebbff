"""The path of a turtle as its pose topic tells it, for a turtlesim that has no picture to give."""

from __future__ import annotations

import time
from typing import Any

from rclpy.node import Node

from spinbook.turtlesim.geometry import DT, SIDE
from spinbook.turtlesim.pen import Pen
from spinbook.turtlesim.track import Track
from spinbook.turtlesim.trail import Point, Trail
from spinbook.turtlesim.types import Pose
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
