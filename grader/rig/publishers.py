"""The reference publishers."""

from __future__ import annotations

from typing import Any

from grader.recording import Sent
from grader.rig.ros import OFFER
from grader.runner.message import message_class, to_message
from grader.scenario import Message, Scenario


class ReferencePublishers:
    """Publishes a scenario's messages, in order, when the rig says so.

    All publishers are there from the beginning, so that the student's node knows each of them before it speaks;
    one that is replaced by another is destroyed when the other begins.
    """

    def __init__(self, node: Any, scenario: Scenario) -> None:
        self._node = node
        self._ready: dict[tuple[str, int], Any] = {}
        self._speaking: dict[str, int] = {}
        for message in scenario.messages:
            key = (message.topic, message.publisher)
            if key not in self._ready:
                self._ready[key] = node.create_publisher(message_class(message.type), message.topic, OFFER)
            self._speaking.setdefault(message.topic, message.publisher)
        self.sent: list[Sent] = []

    def publish(self, message: Message) -> None:
        """Publish one message."""
        former = self._speaking[message.topic]
        if former != message.publisher:
            self._node.destroy_publisher(self._ready.pop((message.topic, former)))
            self._speaking[message.topic] = message.publisher
        ros_message = to_message(message.type, message.fields)
        publisher = self._ready[message.topic, message.publisher]
        heard = publisher.get_subscription_count() > 0
        publisher.publish(ros_message)
        self.sent.append(Sent(message.at, message.topic, message.type, message.fields, heard))

    @property
    def heard(self) -> bool:
        """Whether the student's node subscribes to every topic."""
        return all(publisher.get_subscription_count() for publisher in self._ready.values())
