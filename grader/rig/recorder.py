"""Keeps what the student's node publishes."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from rclpy.event_handler import SubscriptionEventCallbacks
from rclpy.qos import QoSProfile
from rclpy.serialization import deserialize_message

from grader.exercise.interface import Topic
from grader.recording import Received
from grader.rig.message import message_class, to_fields
from grader.rig.ros import ACCEPT, ACCEPT_ANY
from grader.rig.stopped import Stopped

#: No exercise needs more than this from a node in one scenario.
MOST_MESSAGES = 5_000
MOST_BYTES = 1_000_000


class Recorder:
    """Subscribes to the topics that the exercise's node is to publish.

    Reliably, and as best effort goes where a publisher of the student's offers no more: see `adapt`.
    """

    def __init__(self, node: Any, topics: tuple[Topic, ...], moment: Callable[[], tuple[int, int]]) -> None:
        self._node = node
        self._topics = topics
        self._moment = moment
        self.received: list[Received] = []
        self.too_much: Stopped | None = None
        self._matched: dict[str, int] = {}
        self._subscriptions: dict[str, Any] = {}
        self._refused: list[Topic] = []
        self._known: set[bytes] = set()
        for topic in topics:
            self._subscribe(topic, ACCEPT)

    def adapt(self) -> None:
        """Ask for less where what was asked for is not offered. Not to be called in a callback."""
        while self._refused:
            topic = self._refused.pop()
            self._node.destroy_subscription(self._subscriptions[topic.name])
            self._subscribe(topic, ACCEPT_ANY)

    def _subscribe(self, topic: Topic, quality: QoSProfile) -> None:
        kind = message_class(topic.type)
        self._matched[topic.name] = 0

        def matched(status: Any) -> None:
            self._matched[topic.name] = status.current_count

        def refused(status: Any) -> None:
            if quality is ACCEPT and topic not in self._refused:
                self._refused.append(topic)

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

        events = SubscriptionEventCallbacks(matched=matched, incompatible_qos=refused, use_default_callbacks=False)
        self._subscriptions[topic.name] = self._node.create_subscription(
            kind, topic.name, keep, quality, raw=True, event_callbacks=events
        )

    @property
    def hears(self) -> bool:
        """Whether the student's node publishes every topic, in a way that reaches this recorder."""
        return all(self._matched.values())

    def newcomers(self) -> list[Topic]:
        """Topics that have got a publisher since this was asked the last time.

        A publisher of another type counts as none: nothing of it can ever reach this recorder.
        """
        found = []
        for topic in self._topics:
            identities = {bytes(info.endpoint_gid) for info in self._publishers(topic)}
            if identities - self._known:
                found.append(topic)
            self._known |= identities
        return found

    def hears_all(self, topic: Topic) -> bool:
        """Whether every publisher of `topic` has found this recorder."""
        return self._matched[topic.name] >= len(self._publishers(topic))

    def _publishers(self, topic: Topic) -> list[Any]:
        infos = self._node.get_publishers_info_by_topic(topic.name)
        return [info for info in infos if info.topic_type == topic.type]

    def since(self, count: int, topic: Topic) -> bool:
        """Whether anything came on `topic` after the first `count` messages."""
        return any(received.topic == topic.name for received in self.received[count:])

    def check(self) -> None:
        """Raise `Stopped` when the node has published too much."""
        if self.too_much:
            raise self.too_much
