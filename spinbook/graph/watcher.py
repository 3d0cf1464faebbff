"""Watches the node graph of a ROS domain, and counts messages to measure rates.

`python -m spinbook.graph.watcher now [SECONDS]` prints the current graph of ROS_DOMAIN_ID as JSON. For SECONDS, it
subscribes to every published topic to measure its rate.

`python -m spinbook.graph.watcher` watches for another process. It reads commands from standard input, one per line,
until the input ends:

    domain N    watch this ROS domain from now on
    count       subscribe to topics that have a subscriber anyway, to measure their rates, until the next command
    look        stop counting, wait until the graph is complete, and print it as one line of JSON
"""

from __future__ import annotations

import json
import math
import os
import queue
import sys
import threading
import time
from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import Any

from rclpy.qos import DurabilityPolicy, QoSCompatibility, QoSProfile, ReliabilityPolicy, qos_check_compatible
from rclpy.subscription import Subscription
from rclpy.topic_endpoint_info import TopicEndpointInfo
from rclpy.topic_or_service_is_hidden import topic_or_service_is_hidden

from ros_in_python.ros2.cli import CommandError
from ros_in_python.ros2.domain import domain_id, hears_other_hosts, participants
from ros_in_python.ros2.graph import LOOK, GraphView
from ros_in_python.ros2.interfaces import message_class
from ros_in_python.ros2.opening import prepare
from spinbook.graph.model import INTERNAL, GraphEndpoint, GraphNode, GraphTopic, NodeGraph, one_each

#: A rate is measured over at least this long (s).
ENOUGH_S = 0.8
_NS = 1e9
#: Usual rates of timers, as first digits. A rate within 4 % of one is shown as that: 9.94 Hz is a 10 Hz timer.
_USUAL = (1.0, 1.25, 1.5, 2.0, 2.5, 3.0, 3.3, 4.0, 5.0, 6.0, 6.25, 7.0, 7.5, 8.0, 9.0, 10.0)
_NEAR = 0.04


@dataclass
class _Stream:
    """One publisher's messages: the sequence number and source time stamp (ns) of the first and the last."""

    first: tuple[int, int]
    last: tuple[int, int]


@dataclass
class MessageCounter:
    """Counts the messages on a topic with this many publishers, separately for each publisher.

    Each publisher numbers its messages, so lost messages count, too (RTPS 2.5, 8.3.5.4). It stamps them when it sends
    them, so latency does not matter.
    """

    publishers: int = 1
    _streams: list[_Stream] = field(default_factory=list)

    def count(self, number: int, sent_ns: int) -> None:
        """Count a message with this sequence number and source time stamp."""
        following = [stream for stream in self._streams if stream.last[0] < number and stream.last[1] <= sent_ns]
        # The next number continues a stream. A gap means another publisher, as long as one of them is still missing;
        # otherwise messages were lost, in the stream with the smallest gap.
        nearest = max(following, key=lambda stream: stream.last[0], default=None)
        is_one_missing = len(self._streams) < self.publishers
        if nearest is None or (is_one_missing and number - nearest.last[0] > 1):
            self._streams.append(_Stream((number, sent_ns), (number, sent_ns)))
        else:
            nearest.last = (number, sent_ns)

    def rate_hz(self) -> float | None:
        """Return the messages per second of all publishers together; None until each has sent for long enough."""
        rates = []
        for stream in self._streams:
            seconds = (stream.last[1] - stream.first[1]) / _NS
            if seconds < ENOUGH_S:
                return None
            rates.append((stream.last[0] - stream.first[0]) / seconds)
        return sum(rates) if rates else None


def rounded(rate_hz: float) -> float:
    """Return a rate as it is shown: two digits, or the rate of a usual timer nearby (9.99 and 10.01 are 10)."""
    if not rate_hz > 0 or not math.isfinite(rate_hz):
        return 0.0
    scale = 10.0 ** math.floor(math.log10(rate_hz))
    digits = rate_hz / scale
    usual = min(_USUAL, key=lambda each: abs(digits / each - 1))
    shown = usual if abs(digits / usual - 1) <= _NEAR else round(digits, 1)
    return float(f"{shown * scale:.6g}")


#: Quiet time after which the graph counts as complete, and the deadline for that (s).
_QUIET_S, _DEADLINE_S = 0.15, 8.0
#: The messages of a topic are counted for this long (s).
_COUNTING_S = 2.5
#: Compatible with publishers of every reliability and durability.
_COMPATIBLE_WITH_ALL = QoSProfile(
    depth=50, reliability=ReliabilityPolicy.BEST_EFFORT, durability=DurabilityPolicy.VOLATILE
)


class GraphWatcher(GraphView):
    """Reads nodes, topics and endpoints. Its own node is hidden: the name begins with an underscore.

    It subscribes to topics only between `count` and `stop_counting`, and only to those whose rate is unknown.
    """

    def __init__(self) -> None:
        prepare()
        super().__init__(node_name=f"_spinbook_graph_{os.getpid()}", spin_time=None, use_sim_time=False)
        self._known: tuple[Any, ...] = ()
        self._gone_before = 0
        self._counting: dict[str, tuple[Subscription, MessageCounter, float]] = {}
        #: Topic -> how many publishers it had when it was counted, and its rate.
        self._rates: dict[str, tuple[int, float]] = {}

    def __enter__(self) -> GraphWatcher:
        return self

    def wait_until_idle(self) -> None:
        """Wait until all participants of this host are known and nothing changes, or return at once if nothing has."""
        deadline = time.monotonic() + _DEADLINE_S
        seen, changed = self._look(), time.monotonic()
        while not (seen == self._known or time.monotonic() - changed >= _QUIET_S) or not self._complete():
            if time.monotonic() >= deadline:
                break
            time.sleep(LOOK)
            look = self._look()
            if look != seen:
                seen, changed = look, time.monotonic()
        self._known, self._gone_before = seen, self._gone()

    def _complete(self) -> bool:
        # A participant announces that it leaves, maybe late. A killed one does not: wait for each of those only once.
        return super()._complete() and self._gone() <= self._gone_before

    def _gone(self) -> int:
        """Return how many known participants are no longer on this host."""
        here = None if hears_other_hosts() else participants(domain_id())
        return 0 if here is None else max(0, len(self._heard()) - here)

    def _look(self) -> tuple[Any, ...]:
        # A node that has started and is not discovered yet is a change, too.
        return (*super()._look(), participants(domain_id()))

    def graph(self) -> NodeGraph:
        """Return the current graph, with the rates that have been measured so far."""
        nodes = {node.full_name for node in self.nodes() if not node.hidden}
        topics = (self._topic(name.name) for name in self.topics() if _is_shown(name.name))
        shown = sorted(topic for topic in topics if topic.publishers or topic.subscriptions)
        return NodeGraph(tuple(GraphNode(name) for name in sorted(nodes)), tuple(shown))

    def _topic(self, name: str) -> GraphTopic:
        publishers, subscriptions = (_shown(ends) for ends in (self.publishers(name), self.subscriptions(name)))
        _, rate = self._rates.get(name, (0, None))
        return GraphTopic(name, _ends(publishers, subscriptions), _ends(subscriptions, publishers), rate)

    # --- rates

    def count(self, without_subscribers: bool = False) -> bool:
        """Count messages for a moment on topics whose rate is unknown; return False if there is nothing left to count.

        Topics without subscribers are included only if `without_subscribers`. Call this repeatedly, and
        `stop_counting` at the end. Meanwhile, publishers see one more subscription.
        """
        self.spin_once()
        for name, (_, counted, until) in list(self._counting.items()):
            if time.monotonic() > until:
                self._conclude(name, counted)
        for topic in self.topics():
            if _is_shown(topic.name) and topic.name not in self._counting:
                self._begin(topic.name, without_subscribers)
        return bool(self._counting)

    def _begin(self, name: str, without_subscribers: bool) -> None:
        publishers = _shown(self.publishers(name))
        is_used = without_subscribers or _shown(self.subscriptions(name))
        if not publishers or not is_used or self._rates.get(name, (0, 0))[0] >= len(publishers):
            return
        counted = MessageCounter(len(publishers))
        try:
            kind = message_class(publishers[0].topic_type)
        except CommandError:
            return  # a type that is not installed here
        subscription = self.node.create_subscription(kind, name, _callback(counted), _COMPATIBLE_WITH_ALL, raw=True)
        self._counting[name] = (subscription, counted, time.monotonic() + _COUNTING_S)

    def _conclude(self, name: str, counted: MessageCounter) -> None:
        subscription, *_ = self._counting.pop(name)
        self.node.destroy_subscription(subscription)
        rate = counted.rate_hz()
        if rate:
            self._rates[name] = (len(_shown(self.publishers(name))), rounded(rate))

    def stop_counting(self) -> None:
        """Unsubscribe from all topics, and keep the rates that were measured for long enough."""
        for name, (_, counted, _) in list(self._counting.items()):
            self._conclude(name, counted)


def _callback(counted: MessageCounter) -> Any:
    """Return a callback with two parameters: rclpy then also passes the message's information."""

    def callback(data: bytes, information: dict[str, int]) -> None:
        counted.count(information["publication_sequence_number"], information["source_timestamp"])

    return callback


def _is_shown(topic: str) -> bool:
    return topic not in INTERNAL and not topic_or_service_is_hidden(topic)


def _shown(ends: Iterable[TopicEndpointInfo]) -> list[TopicEndpointInfo]:
    """Return the endpoints of nodes that are not hidden."""
    return [end for end in ends if not topic_or_service_is_hidden(_node(end))]


def _node(end: TopicEndpointInfo) -> str:
    return f"{end.node_namespace.rstrip('/')}/{end.node_name}"


def _ends(ends: list[TopicEndpointInfo], others: list[TopicEndpointInfo]) -> tuple[GraphEndpoint, ...]:
    fits = ((end, any(_fit(end, other) for other in others)) for end in ends)
    return one_each(GraphEndpoint(_node(end), end.topic_type, connected) for end, connected in fits)


def _fit(first: TopicEndpointInfo, second: TopicEndpointInfo) -> bool:
    if first.topic_type != second.topic_type:
        return False
    publisher, subscription = (first, second) if first.endpoint_type.name == "PUBLISHER" else (second, first)
    compatibility, _ = qos_check_compatible(publisher.qos_profile, subscription.qos_profile)
    return bool(compatibility != QoSCompatibility.ERROR)


def graph_now(seconds: float) -> NodeGraph:
    """Return the graph, with the rates that could be measured within `seconds`."""
    with GraphWatcher() as watcher:
        watcher.wait_until_idle()
        deadline = time.monotonic() + seconds
        while time.monotonic() < deadline and watcher.count(without_subscribers=True):
            pass
        watcher.stop_counting()
        return watcher.graph()


def _listen(commands: queue.SimpleQueue[str]) -> None:
    for line in sys.stdin:
        commands.put(line.strip())
    commands.put("end")


def observe() -> None:
    """Follow the commands on standard input, until it ends."""
    commands: queue.SimpleQueue[str] = queue.SimpleQueue()
    threading.Thread(target=_listen, args=(commands,), daemon=True).start()
    command = commands.get()
    while command != "end":
        os.environ["ROS_DOMAIN_ID"] = command.removeprefix("domain ")
        with GraphWatcher() as watcher:
            command = _watch_domain(watcher, commands)


def _watch_domain(watcher: GraphWatcher, commands: queue.SimpleQueue[str]) -> str:
    """Follow the commands for one domain; return the first one that is not for it."""
    while (command := commands.get()) != "end" and not command.startswith("domain "):
        while command == "count" and commands.empty():
            watcher.count()
        watcher.stop_counting()
        if command == "look":
            watcher.wait_until_idle()
            print(json.dumps(json.loads(watcher.graph().to_json())), flush=True)
    return command


def main(how: str = "", seconds: str = "0") -> None:
    """Print the graph once, or follow the commands on standard input."""
    try:
        if how == "now":
            print(graph_now(float(seconds)).to_json())
        else:
            observe()
    except CommandError as error:
        sys.exit(error.format_message())


if __name__ == "__main__":
    main(*sys.argv[1:])
