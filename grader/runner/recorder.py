"""Keeps what the student's program publishes, and makes the recording's messages of it when the run is over."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Sequence
from typing import Any

from rclpy.serialization import deserialize_message

from grader.exercise.interface import Topic
from grader.recording import Received
from grader.runner.clocks import Clocks
from grader.runner.message import message_class, to_fields
from grader.runner.stopped import Stopped
from rmw_lockstep.hub import Heard, HubNode, Qos, Subscription
from rmw_lockstep.hub.qos import BEST_EFFORT

#: No exercise needs more than this from a node in one scenario.
MOST_MESSAGES = 5_000

#: Compatible with whatever a student's publisher offers.
ACCEPT_ANY = Qos(depth=10_000, reliability=BEST_EFFORT)


class Recorder:
    """Subscribes to the topics that the exercise's node is to publish."""

    def __init__(self, node: HubNode, topics: Sequence[Topic]) -> None:
        self._topics = tuple(topics)
        self._heard: list[tuple[int, Heard]] = []
        for number, topic in enumerate(self._topics):
            self._subscribe(node, number, topic)

    def _subscribe(self, node: HubNode, number: int, topic: Topic) -> Subscription:
        def keep(heard: Heard) -> None:
            self._heard.append((number, heard))
            if len(self._heard) > MOST_MESSAGES:
                self._heard.pop()
                raise Stopped("over-limit", f"Your node published more than {MOST_MESSAGES:,} messages.")

        return node.subscription(topic.name, topic.type, ACCEPT_ANY, keep)

    def received(self, clocks: Clocks, stages: Sequence[int]) -> tuple[Received, ...]:
        """What has come, in order. Raises `Stopped` for bytes that are no message.

        `stages` has the number of each message sent, among all that the hub has published; see `Heard.stage`.
        """
        found = []
        for number, heard in in_canonical_order(self._heard):
            topic = self._topics[number]
            at = clocks.simulated(heard.now, heard.stage)
            after = bisect_right(stages, heard.stage)
            found.append(Received(at, after, topic.name, topic.type, _fields(heard.cdr, message_class(topic.type))))
        return tuple(found)


def in_canonical_order(heard: Sequence[tuple[int, Heard]]) -> list[tuple[int, Heard]]:
    """Messages by their moment; at one moment by topic and node, and within these as they were sent.

    What several threads publish on one topic at one moment has no order, so it is put in the order of its bytes.
    """
    threads: dict[tuple[int, str], set[tuple[int, int]]] = {}
    for number, one in heard:
        threads.setdefault((number, one.node), set()).add((one.publisher.process, one.thread))
    several = {key for key, found in threads.items() if len(found) > 1}
    alone = len({one.publisher.process for _, one in heard}) <= 1

    def key(entry: tuple[int, Heard]) -> tuple[Any, ...]:
        number, one = entry
        own = one.handled if alone else 0  # the frames of two processes cannot be compared
        return one.stage, one.now, own, number, one.node, one.cdr if (number, one.node) in several else b""

    return sorted(heard, key=key)


def _fields(cdr: bytes, kind: Any) -> dict[str, Any]:
    try:
        return to_fields(deserialize_message(cdr, kind))
    except Exception as error:  # whatever made-up bytes lead to
        raise Stopped("over-limit", f"Your node published bytes that are no message: {error}") from None
