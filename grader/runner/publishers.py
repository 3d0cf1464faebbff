"""The reference publishers, which publish over the hub."""

from __future__ import annotations

from grader.recording.recording import SentMessage
from grader.runner.cdr import serialized
from grader.runner.grader_side import hub_qos
from grader.runner.message import message_class
from grader.scenario.scenario import Message, Scenario
from rmw_lockstep.hub import HubNode, HubPublisher, QosPolicies
from rmw_lockstep.qos import TRANSIENT_LOCAL

#: Compatible with every QoS that a subscription can request.
OFFER = QosPolicies(depth=1_000, durability=TRANSIENT_LOCAL)


_prepared: dict[int, tuple[Scenario, dict[int, bytes]]] = {}


def prepare_messages(scenario: Scenario) -> None:
    """Serialize a scenario's messages, once for all its runs in this process and its forks. Both are kept."""
    _prepared[id(scenario)] = scenario, _serialized(scenario)


def _serialized(scenario: Scenario) -> dict[int, bytes]:
    """Return its messages by identity, because a stream may contain the same message several times."""
    return {id(one): serialized(message_class(one.type), one.fields) for one in scenario.messages}


class ReferencePublishers:
    """Publishes a scenario's messages, in order, when asked to.

    All publishers exist from the beginning, so that the student's node has discovered each of them before it
    publishes. A publisher that is replaced is removed when its successor begins.
    """

    def __init__(self, node: HubNode, scenario: Scenario) -> None:
        self._node, self._scenario = node, scenario
        self._ready: dict[tuple[str, int], HubPublisher] = {}
        self._current: dict[str, int] = {}
        for message in scenario.messages:
            self._add(message)
        prepared = _prepared.get(id(scenario))
        self._serialized = prepared[1] if prepared else _serialized(scenario)
        self.sent: list[SentMessage] = []
        self.stages: list[int] = []
        """The number of each message among everything the hub has published."""

    def _add(self, message: Message) -> None:
        key = (message.topic, message.publisher)
        if key not in self._ready:
            profile = self._scenario.qos.get(message.topic)
            offer = hub_qos(profile) if profile else OFFER
            self._ready[key] = self._node.publisher(message.topic, message.type, offer)
        self._current.setdefault(message.topic, message.publisher)

    def announce(self, topic: str, type_name: str) -> None:
        """Create a publisher on this topic, even if the scenario has no message for it."""
        self._add(Message(0, topic, type_name, {}))

    def has_subscriber(self, message: Message) -> bool:
        """Return whether the student's program subscribes to the message's topic."""
        publisher = self._ready.get((message.topic, message.publisher))
        return publisher is not None and bool(publisher.matched)

    def publish(self, message: Message) -> int:
        """Queue a message. Return its number among everything the hub has published."""
        self._add(message)
        former = self._current[message.topic]
        if former != message.publisher:
            self._ready.pop((message.topic, former)).close()
            self._current[message.topic] = message.publisher
        subscribed = self.has_subscriber(message)
        publisher = self._ready[message.topic, message.publisher]
        content = self._serialized.get(id(message)) or serialized(message_class(message.type), message.fields)
        self.stages.append(publisher.publish(content))
        self.sent.append(SentMessage(message.at, message.topic, message.type, message.fields, subscribed))
        return self.stages[-1]

    def leave(self, topic: str) -> None:
        """Remove the publisher on this topic; the next message creates another one."""
        for key in [key for key in self._ready if key[0] == topic]:
            self._ready.pop(key).close()
        self._current.pop(topic, None)

    @property
    def have_subscribers(self) -> bool:
        """Whether the student's program subscribes to every topic."""
        return all(publisher.matched for publisher in self._ready.values())
