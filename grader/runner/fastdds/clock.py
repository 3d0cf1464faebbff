"""Simulated time."""

from __future__ import annotations

from typing import Any

from rosgraph_msgs.msg import Clock as ClockMessage

from grader.runner.fastdds.ros import OFFER
from grader.scenario.scenario import SECOND


class Clock:
    """The only clock a node under test should know: the topic /clock."""

    def __init__(self, node: Any) -> None:
        self._publisher = node.create_publisher(ClockMessage, "/clock", OFFER)
        self.now = 0

    def set(self, now: int) -> None:
        """Make it `now` (ns)."""
        self.now = now
        message = ClockMessage()
        message.clock.sec, message.clock.nanosec = divmod(now, SECOND)
        self._publisher.publish(message)

    @property
    def heard(self) -> bool:
        """Whether the student's node subscribes to it."""
        return bool(self._publisher.get_subscription_count())
