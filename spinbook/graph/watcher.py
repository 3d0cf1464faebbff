"""Watches the node graph of a ROS domain, and counts messages to know the rates.

`python -m spinbook.graph.watcher now [SECONDS]` prints the graph of ROS_DOMAIN_ID as it is now, as JSON. For so many
seconds it listens to every topic that is published, to know the rates.

`python -m spinbook.graph.watcher` watches on behalf of another process. It reads words from standard input, a line
each, and ends with it:

    domain N    look at this ROS domain from now on
    count       listen to topics that have a listener anyway, to know their rates, until the next word
    look        stop that, wait until the graph is known, and print it as one line of JSON
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
from spinbook.graph.model import GraphEndpoint, GraphNode, GraphTopic, NodeGraph

#: A rate is measured over at least this long (s).
ENOUGH_S = 0.8
_NS = 1e9
#: First digits that rates of timers have. A rate within 4 % of one is that one: a measured 9.94 Hz is a 10 Hz timer.
_USUAL = (1.0, 1.25, 1.5, 2.0, 2.5, 3.0, 3.3, 4.0, 5.0, 6.0, 6.25, 7.0, 7.5, 8.0, 9.0, 10.0)
_NEAR = 0.04


@dataclass
class _Stream:
    """One publisher's messages: the sequence number and source time stamp (ns) of the first and the last."""

    first: tuple[int, int]
    last: tuple[int, int]


@dataclass
class MessageCounter:
    """The messages received on a topic with this many publishers, kept apart by publisher.

    Each publisher numbers its messages, so that what was missed in between is counted too (RTPS 2.5, 8.3.5.4), and
    stamps them when it sends them, so that the time that they took to come does not matter.
    """

    publishers: int = 1
    _streams: list[_Stream] = field(default_factory=list)

    def heard(self, number: int, sent_ns: int) -> None:
        """Take in a message by its sequence number and source time stamp."""
        following = [stream for stream in self._streams if stream.last[0] < number and stream.last[1] <= sent_ns]
        # The next number goes on with a stream. A gap is another publisher while some have not been heard, then loss,
        # in the stream out of which it leaves the fewest.
        nearest = max(following, key=lambda stream: stream.last[0], default=None)
        unheard = len(self._streams) < self.publishers
        if nearest is None or (unheard and number - nearest.last[0] > 1):
            self._streams.append(_Stream((number, sent_ns), (number, sent_ns)))
        else:
            nearest.last = (number, sent_ns)

    def rate_hz(self) -> float | None:
        """Messages per second of all publishers together; None until enough has been received from each."""
        rates = []
        for stream in self._streams:
            seconds = (stream.last[1] - stream.first[1]) / _NS
            if seconds < ENOUGH_S:
                return None
            rates.append((stream.last[0] - stream.first[0]) / seconds)
        return sum(rates) if rates else None


def rounded(rate_hz: float) -> float:
    """A rate as it is shown: two digits, or that of a usual timer if it is close to one (9.99 and 10.01 are 10)."""
    if not rate_hz > 0 or not math.isfinite(rate_hz):
        return 0.0
    scale = 10.0 ** math.floor(math.log10(rate_hz))
    digits = rate_hz / scale
    usual = min(_USUAL, key=lambda each: abs(digits / each - 1))
    shown = usual if abs(digits / usual - 1) <= _NEAR else round(digits, 1)
    return float(f"{shown * scale:.6g}")


#: Every node has these, and they tell nothing of what it is for.
INTERNAL = ("/rosout", "/parameter_events")
#: Seconds without a change after which the graph is taken for known, and after which it is so in any case.
_QUIET_S, _DEADLINE_S = 0.15, 8.0
#: A topic is counted for so long at a time (s).
_COUNTING_S = 2.5
#: Hears publishers of every reliability and durability, and asks nothing of them.
_HEARS_ALL = QoSProfile(depth=50, reliability=ReliabilityPolicy.BEST_EFFORT, durability=DurabilityPolicy.VOLATILE)


class GraphWatcher(GraphView):
    """Sees nodes, topics and ends. Its name begins with an underscore, as ros2's own nodes' do, so it is not listed.

    It subscribes only while `count` is called again and again, and only to what is not yet counted.
    """

    def __init__(self) -> None:
        prepare()
        super().__init__(node_name=f"_spinbook_graph_{os.getpid()}", spin_time=None, use_sim_time=False)
        self._known: tuple[Any, ...] = ()
        self._silent = 0
        self._counting: dict[str, tuple[Subscription, MessageCounter, float]] = {}
        #: Topic -> how many publishers it had when it was counted, and its rate.
        self._rates: dict[str, tuple[int, float]] = {}

    def __enter__(self) -> GraphWatcher:
        return self

    def wait_until_idle(self) -> None:
        """Return when the participants are those of this host and nothing changes; at once if nothing has."""
        deadline = time.monotonic() + _DEADLINE_S
        seen, changed = self._look(), time.monotonic()
        while not (seen == self._known or time.monotonic() - changed >= _QUIET_S) or not self._complete():
            if time.monotonic() >= deadline:
                break
            time.sleep(LOOK)
            look = self._look()
            if look != seen:
                seen, changed = look, time.monotonic()
        self._known, self._silent = seen, self._gone()

    def _complete(self) -> bool:
        # What leaves says so, which may arrive late; what was killed does not, and is waited for only once.
        return super()._complete() and self._gone() <= self._silent

    def _gone(self) -> int:
        """How many participants have been heard of that are not on this host any more."""
        here = None if hears_other_hosts() else participants(domain_id())
        return 0 if here is None else max(0, len(self._heard()) - here)

    def _look(self) -> tuple[Any, ...]:
        # A node that has started and has not been heard of yet is a change as well.
        return (*super()._look(), participants(domain_id()))

    def graph(self) -> NodeGraph:
        """What is there now, with the rates that have been counted so far."""
        nodes = {node.full_name for node in self.nodes() if not node.hidden}
        topics = (self._topic(name.name) for name in self.topics() if _is_shown(name.name))
        shown = sorted(topic for topic in topics if topic.publishers or topic.subscriptions)
        return NodeGraph(tuple(GraphNode(name) for name in sorted(nodes)), tuple(shown))

    def _topic(self, name: str) -> GraphTopic:
        publishers, subscriptions = (_shown(ends) for ends in (self.publishers(name), self.subscriptions(name)))
        _, rate = self._rates.get(name, (0, None))
        return GraphTopic(name, _ends(publishers, subscriptions), _ends(subscriptions, publishers), rate)

    # Counting

    def count(self, unheard: bool = False) -> bool:
        """Listen a moment to the topics whose rate is not known, those to which nobody listens only if `unheard`.

        To be called again and again, and `stop_counting` at the end. While it counts, a publisher sees one
        subscription more. False when there is nothing left to count.
        """
        self.spin_once()
        for name, (_, counted, until) in list(self._counting.items()):
            if time.monotonic() > until:
                self._conclude(name, counted)
        for topic in self.topics():
            if _is_shown(topic.name) and topic.name not in self._counting:
                self._begin(topic.name, unheard)
        return bool(self._counting)

    def _begin(self, name: str, unheard: bool) -> None:
        publishers = _shown(self.publishers(name))
        heard = unheard or _shown(self.subscriptions(name))
        if not publishers or not heard or self._rates.get(name, (0, 0))[0] >= len(publishers):
            return
        counted = MessageCounter(len(publishers))
        try:
            kind = message_class(publishers[0].topic_type)
        except CommandError:
            return  # a type that is not installed here
        subscription = self.node.create_subscription(kind, name, _callback(counted), _HEARS_ALL, raw=True)
        self._counting[name] = (subscription, counted, time.monotonic() + _COUNTING_S)

    def _conclude(self, name: str, counted: MessageCounter) -> None:
        subscription, *_ = self._counting.pop(name)
        self.node.destroy_subscription(subscription)
        rate = counted.rate_hz()
        if rate:
            self._rates[name] = (len(_shown(self.publishers(name))), rounded(rate))

    def stop_counting(self) -> None:
        """Listen to nothing any more; what was heard for long enough counts."""
        for name, (_, counted, _) in list(self._counting.items()):
            self._conclude(name, counted)


def _callback(counted: MessageCounter) -> Any:
    """A callback of the form to which rclpy passes the message's information, too: rclpy looks at the parameters."""

    def callback(data: bytes, information: dict[str, int]) -> None:
        counted.heard(information["publication_sequence_number"], information["source_timestamp"])

    return callback


def _is_shown(topic: str) -> bool:
    return topic not in INTERNAL and not topic_or_service_is_hidden(topic)


def _shown(ends: Iterable[TopicEndpointInfo]) -> list[TopicEndpointInfo]:
    """Those of nodes that are not hidden."""
    return [end for end in ends if not topic_or_service_is_hidden(_node(end))]


def _node(end: TopicEndpointInfo) -> str:
    return f"{end.node_namespace.rstrip('/')}/{end.node_name}"


def _ends(ends: list[TopicEndpointInfo], others: list[TopicEndpointInfo]) -> tuple[GraphEndpoint, ...]:
    """One end a node and type, by node; it is connected if any of its ends is to any of the others'."""
    connected: dict[tuple[str, str], bool] = {}
    for end in ends:
        key = (_node(end), end.topic_type)
        connected[key] = connected.get(key, False) or any(_fit(end, other) for other in others)
    return tuple(sorted(GraphEndpoint(node, kind, fits) for (node, kind), fits in connected.items()))


def _fit(one: TopicEndpointInfo, other: TopicEndpointInfo) -> bool:
    if one.topic_type != other.topic_type:
        return False
    publisher, subscription = (one, other) if one.endpoint_type.name == "PUBLISHER" else (other, one)
    compatibility, _ = qos_check_compatible(publisher.qos_profile, subscription.qos_profile)
    return bool(compatibility != QoSCompatibility.ERROR)


def graph_now(seconds: float) -> NodeGraph:
    """The graph, with the rates of what could be counted within `seconds`."""
    with GraphWatcher() as watcher:
        watcher.wait_until_idle()
        deadline = time.monotonic() + seconds
        while time.monotonic() < deadline and watcher.count(unheard=True):
            pass
        watcher.stop_counting()
        return watcher.graph()


def _listen(words: queue.SimpleQueue[str]) -> None:
    for line in sys.stdin:
        words.put(line.strip())
    words.put("end")


def observe(words: queue.SimpleQueue[str]) -> None:
    """Do what the words say, until "end"."""
    word = words.get()
    while word != "end":
        os.environ["ROS_DOMAIN_ID"] = word.removeprefix("domain ")
        with GraphWatcher() as watcher:
            word = _look_at(watcher, words)


def _look_at(watcher: GraphWatcher, words: queue.SimpleQueue[str]) -> str:
    """Do what is asked of one domain; the word that ends it."""
    while (word := words.get()) != "end" and not word.startswith("domain "):
        while word == "count" and words.empty():
            watcher.count()
        watcher.stop_counting()
        if word == "look":
            watcher.wait_until_idle()
            print(json.dumps(json.loads(watcher.graph().to_json())), flush=True)
    return word


def observe_standard_input() -> None:
    """Observe until standard input ends."""
    words: queue.SimpleQueue[str] = queue.SimpleQueue()
    threading.Thread(target=_listen, args=(words,), daemon=True).start()
    observe(words)


def main(how: str = "", seconds: str = "0") -> None:
    """Look once, or as often as standard input asks."""
    try:
        if how == "now":
            print(graph_now(float(seconds)).to_json())
        else:
            observe_standard_input()
    except CommandError as error:
        sys.exit(error.format_message())


if __name__ == "__main__":
    main(*sys.argv[1:])
