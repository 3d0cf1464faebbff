"""Keeps what the student's node publishes."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from rclpy.impl.implementation_singleton import rclpy_implementation
from rclpy.qos import ReliabilityPolicy
from rclpy.serialization import deserialize_message

from grader.exercise.interface import Topic
from grader.recording import Received
from grader.rig.ros import ACCEPT, ACCEPT_ANY
from grader.runner.message import message_class, to_fields
from grader.runner.stopped import Stopped

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
        self._modest: set[str] = set()
        self._known: set[bytes] = set()
        self._subscriptions = {topic.name: self._subscription(topic, ACCEPT) for topic in topics}

    def _subscription(self, topic: Topic, quality: Any) -> Any:
        # Never called back: what comes is taken when the rig says so.
        return self._node.create_subscription(
            message_class(topic.type), topic.name, lambda data: None, quality, raw=True
        )

    def adapt(self) -> None:
        """Ask for less where what was asked for is not offered."""
        for topic in self._topics:
            offers = [info["qos_profile"]["reliability"] for info in self._publishers(topic)]
            if topic.name not in self._modest and ReliabilityPolicy.BEST_EFFORT in offers:
                self._node.destroy_subscription(self._subscriptions[topic.name])
                self._subscriptions[topic.name] = self._subscription(topic, ACCEPT_ANY)
                self._modest.add(topic.name)

    def take(self) -> None:
        """Take what has come."""
        for topic in self._topics:
            kind, handle = message_class(topic.type), self._subscriptions[topic.name].handle
            while not self.too_much:
                taken = handle.take_message(kind, True)
                if taken is None:
                    break
                self._keep(topic, taken[0], kind)

    def _keep(self, topic: Topic, data: bytes, kind: Any) -> None:
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

    def hear(self) -> None:
        """Take what has come. Raises `Stopped` when it is too much."""
        self.take()
        if self.too_much:
            raise self.too_much

    @property
    def hears(self) -> bool:
        """Whether the student's node publishes every topic, in a way that reaches this recorder."""
        return all(subscription.get_publisher_count() for subscription in self._subscriptions.values())

    def newcomers(self) -> list[Topic]:
        """Topics that have got a publisher since this was asked the last time.

        A publisher of another type counts as none: nothing of it can ever reach this recorder.
        """
        found = []
        for topic in self._topics:
            identities = {bytes(info["endpoint_gid"]) for info in self._publishers(topic)}
            if identities - self._known:
                found.append(topic)
            self._known |= identities
        return found

    def hears_all(self, topic: Topic) -> bool:
        """Whether every publisher of `topic` has found this recorder."""
        return bool(self._subscriptions[topic.name].get_publisher_count() >= len(self._publishers(topic)))

    def _publishers(self, topic: Topic) -> list[dict[str, Any]]:
        # What the node's get_publishers_info_by_topic makes objects of, which would cost more than all that is done
        # for a message else.
        with self._node.handle:
            infos = rclpy_implementation.rclpy_get_publishers_info_by_topic(self._node.handle, topic.name, False)
        return [info for info in infos if info["topic_type"] == topic.type]

    def since(self, count: int, topic: Topic) -> bool:
        """Whether anything came on `topic` after the first `count` messages."""
        return any(received.topic == topic.name for received in self.received[count:])
