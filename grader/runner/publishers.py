"""The reference publishers, over the hub."""

from __future__ import annotations

from rclpy.serialization import serialize_message

from grader.recording import Sent
from grader.runner.message import to_message
from grader.scenario import Message, Scenario
from rmw_lockstep.hub import HubNode, Publisher, Qos
from rmw_lockstep.hub.qos import TRANSIENT_LOCAL

#: Compatible with whatever a student's subscription asks for.
OFFER = Qos(depth=1_000, durability=TRANSIENT_LOCAL)


class ReferencePublishers:
    """Publishes a scenario's messages, in order, when it is told to.

    All publishers are there from the beginning, so that the student's node knows each of them before it speaks; one
    that is replaced by another is removed when the other begins.
    """

    def __init__(self, node: HubNode, scenario: Scenario) -> None:
        self._ready: dict[tuple[str, int], Publisher] = {}
        self._speaking: dict[str, int] = {}
        for message in scenario.messages:
            key = (message.topic, message.publisher)
            if key not in self._ready:
                self._ready[key] = node.publisher(message.topic, message.type, OFFER)
            self._speaking.setdefault(message.topic, message.publisher)
        self._serialized = [serialize_message(to_message(m.type, m.fields)) for m in scenario.messages]
        self.sent: list[Sent] = []
        self.stages: list[int] = []
        """The number of each message among all that the hub has published."""

    def is_heard(self, message: Message) -> bool:
        """Whether the student's program subscribes to the message's topic."""
        return bool(self._ready[message.topic, message.publisher].matched)

    def publish(self, message: Message) -> int:
        """Queue the next message. Returns its number among all that the hub has published."""
        former = self._speaking[message.topic]
        if former != message.publisher:
            self._ready.pop((message.topic, former)).close()
            self._speaking[message.topic] = message.publisher
        heard = self.is_heard(message)
        publisher = self._ready[message.topic, message.publisher]
        self.stages.append(publisher.publish(self._serialized[len(self.sent)]))
        self.sent.append(Sent(message.at, message.topic, message.type, message.fields, heard))
        return self.stages[-1]

    @property
    def heard(self) -> bool:
        """Whether the student's program subscribes to every topic."""
        return all(publisher.matched for publisher in self._ready.values())
