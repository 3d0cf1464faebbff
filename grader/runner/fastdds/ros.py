"""The runner's own part of the ROS graph: its participant, simulated time, reference publishers and recorder."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import rclpy
from rclpy.context import Context
from rclpy.impl.implementation_singleton import rclpy_implementation
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, HistoryPolicy, QoSProfile, ReliabilityPolicy
from rclpy.serialization import deserialize_message
from rclpy.signals import SignalHandlerOptions
from rosgraph_msgs.msg import Clock as ClockMessage

from grader.exercise.exercise import Topic
from grader.recording.recording import Received, Sent
from grader.runner.message import message_class, to_fields, to_message
from grader.runner.student import Stopped
from grader.scenario.scenario import SECOND, Message, Scenario

# The grader's end has no executor. It publishes, calls services (see `call`) and takes what has arrived (see
# `recorder`) in an order that it decides itself; waiting by executor costs more than everything else together.


#: Compatible with whatever a student's subscription requests.
OFFER = QoSProfile(
    history=HistoryPolicy.KEEP_LAST,
    depth=1000,
    reliability=ReliabilityPolicy.RELIABLE,
    durability=DurabilityPolicy.TRANSIENT_LOCAL,
)

#: Loses nothing of what a student publishes, not even what is published before the two ends know each other.
ACCEPT = QoSProfile(
    history=HistoryPolicy.KEEP_LAST,
    depth=10_000,
    reliability=ReliabilityPolicy.RELIABLE,
    durability=DurabilityPolicy.VOLATILE,
)

#: Compatible with whatever a student's publisher offers.
ACCEPT_ANY = QoSProfile(
    history=HistoryPolicy.KEEP_LAST,
    depth=10_000,
    reliability=ReliabilityPolicy.BEST_EFFORT,
    durability=DurabilityPolicy.VOLATILE,
)


class Ros:
    """The runner's participant in one ROS domain. Use it as a context manager."""

    def __init__(self, domain: int | None = None) -> None:
        self.context = Context()
        rclpy.init(context=self.context, domain_id=domain, args=[], signal_handler_options=SignalHandlerOptions.NO)
        self.names: list[str] = []
        self._nodes: list[Any] = []

    def node(self, name: str) -> Any:
        """Return a new node of the runner's, as light as a node can be."""
        node = Node(
            name,
            context=self.context,
            use_global_arguments=False,
            enable_rosout=False,
            start_parameter_services=False,
            parameter_overrides=[rclpy.Parameter("start_type_description_service", value=False)],
        )
        self.names.append(f"/{name}")
        self._nodes.append(node)
        return node

    def __enter__(self) -> Ros:
        return self

    def __exit__(self, *error: object) -> None:
        for node in self._nodes:
            node.destroy_node()
        self.context.try_shutdown()


class Clock:
    """The only clock that a node under test should use: the topic /clock."""

    def __init__(self, node: Any) -> None:
        self._publisher = node.create_publisher(ClockMessage, "/clock", OFFER)
        self.now = 0

    def set(self, now: int) -> None:
        """Set the time to `now` (ns)."""
        self.now = now
        message = ClockMessage()
        message.clock.sec, message.clock.nanosec = divmod(now, SECOND)
        self._publisher.publish(message)

    @property
    def has_subscriber(self) -> bool:
        """Whether the student's node subscribes to it."""
        return bool(self._publisher.get_subscription_count())


class ReferencePublishers:
    """Publishes a scenario's messages, in order, when the runner says so.

    All publishers exist from the beginning, so that the student's node knows each of them before it publishes;
    one that is replaced by another is destroyed when the other begins.
    """

    def __init__(self, node: Any, scenario: Scenario) -> None:
        self._node = node
        self._ready: dict[tuple[str, int], Any] = {}
        self._current: dict[str, int] = {}
        for message in scenario.messages:
            key = (message.topic, message.publisher)
            if key not in self._ready:
                self._ready[key] = node.create_publisher(message_class(message.type), message.topic, OFFER)
            self._current.setdefault(message.topic, message.publisher)
        self.sent: list[Sent] = []

    def publish(self, message: Message) -> None:
        """Publish one message."""
        former = self._current[message.topic]
        if former != message.publisher:
            self._node.destroy_publisher(self._ready.pop((message.topic, former)))
            self._current[message.topic] = message.publisher
        ros_message = to_message(message.type, message.fields)
        publisher = self._ready[message.topic, message.publisher]
        subscribed = publisher.get_subscription_count() > 0
        publisher.publish(ros_message)
        self.sent.append(Sent(message.at, message.topic, message.type, message.fields, subscribed))

    @property
    def have_subscribers(self) -> bool:
        """Whether the student's node subscribes to every topic."""
        return all(publisher.get_subscription_count() for publisher in self._ready.values())


#: No exercise needs more than this from a node in one scenario.
MOST_MESSAGES = 5_000
MOST_BYTES = 1_000_000


class Recorder:
    """Subscribes to the topics that the exercise's node is to publish.

    It is reliable, and best effort if one of the student's publishers offers no more: see `adapt`.
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
        # Never called back: what has arrived is taken when the runner says so.
        return self._node.create_subscription(
            message_class(topic.type), topic.name, lambda data: None, quality, raw=True
        )

    def adapt(self) -> None:
        """Request less if what was requested is not offered."""
        for topic in self._topics:
            offers = [info["qos_profile"]["reliability"] for info in self._publishers(topic)]
            if topic.name not in self._modest and ReliabilityPolicy.BEST_EFFORT in offers:
                self._node.destroy_subscription(self._subscriptions[topic.name])
                self._subscriptions[topic.name] = self._subscription(topic, ACCEPT_ANY)
                self._modest.add(topic.name)

    def take(self) -> None:
        """Take what has arrived."""
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
            except Exception as error:  # made-up packets can raise anything
                self.too_much = Stopped("over-limit", f"Your node published bytes that are not a message: {error}")
            else:
                self.received.append(Received(at, after, topic.name, topic.type, fields))

    def receive(self) -> None:
        """Take what has arrived. Raises `Stopped` when it is too much."""
        self.take()
        if self.too_much:
            raise self.too_much

    @property
    def is_connected(self) -> bool:
        """Whether the student's node publishes every topic, in a way that reaches this recorder."""
        return all(subscription.get_publisher_count() for subscription in self._subscriptions.values())

    def new_publishers(self) -> list[Topic]:
        """Return the topics that have got a publisher since the last call.

        A publisher of another type does not count: nothing from it can ever reach this recorder.
        """
        found = []
        for topic in self._topics:
            identities = {bytes(info["endpoint_gid"]) for info in self._publishers(topic)}
            if identities - self._known:
                found.append(topic)
            self._known |= identities
        return found

    def is_connected_to_all(self, topic: Topic) -> bool:
        """Return whether every publisher of `topic` has found this recorder."""
        return bool(self._subscriptions[topic.name].get_publisher_count() >= len(self._publishers(topic)))

    def _publishers(self, topic: Topic) -> list[dict[str, Any]]:
        # These are what the node's get_publishers_info_by_topic turns into objects, which would cost more than
        # everything else that is done for a message.
        with self._node.handle:
            infos = rclpy_implementation.rclpy_get_publishers_info_by_topic(self._node.handle, topic.name, False)
        return [info for info in infos if info["topic_type"] == topic.type]

    def since(self, count: int, topic: Topic) -> bool:
        """Return whether anything arrived on `topic` after the first `count` messages."""
        return any(received.topic == topic.name for received in self.received[count:])
