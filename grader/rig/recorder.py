"""Keeps what the student's node publishes."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from rclpy.event_handler import SubscriptionEventCallbacks
from rclpy.serialization import deserialize_message

from grader.exercise.interface import Topic
from grader.recording import Received
from grader.rig.message import message_class, to_fields
from grader.rig.ros import ACCEPT
from grader.rig.stopped import Stopped

#: No exercise needs more than this from a node in one scenario.
MOST_MESSAGES = 5_000
MOST_BYTES = 1_000_000


class Recorder:
    """Subscribes to the topics that the exercise's node is to publish."""

    def __init__(self, node: Any, topics: tuple[Topic, ...], moment: Callable[[], tuple[int, int]]) -> None:
        self._moment = moment
        self.received: list[Received] = []
        self.too_much: Stopped | None = None
        self._matched: dict[str, int] = {}
        for topic in topics:
            self._subscribe(node, topic)

    def _subscribe(self, node: Any, topic: Topic) -> None:
        kind = message_class(topic.type)
        self._matched[topic.name] = 0

        def matched(status: Any) -> None:
            self._matched[topic.name] = status.current_count

        def keep(data: bytes) -> None:
            if len(data) > MOST_BYTES:
                self.too_much = Stopped("over-limit", f"Your node published a message of {len(data):,} bytes.")
            elif len(self.received) >= MOST_MESSAGES:
                self.too_much = Stopped("over-limit", f"Your node published more than {MOST_MESSAGES:,} messages.")
            else:
                at, after = self._moment()
                try:
                    fields = to_fields(deserialize_message(data, kind))
                except Exception as error:  # whatever a made-up packet leads to
                    self.too_much = Stopped("over-limit", f"Your node published bytes that are no message: {error}")
                else:
                    self.received.append(Received(at, after, topic.name, topic.type, fields))

        events = SubscriptionEventCallbacks(matched=matched, use_default_callbacks=False)
        node.create_subscription(kind, topic.name, keep, ACCEPT, raw=True, event_callbacks=events)

    @property
    def hears(self) -> bool:
        """Whether the student's node publishes every topic, in a way that reaches this recorder."""
        return all(self._matched.values())

    def check(self) -> None:
        """Raise `Stopped` when the node has published too much."""
        if self.too_much:
            raise self.too_much
