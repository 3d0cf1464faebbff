"""Keeps what the student's program publishes, and turns it into the recording's messages when the run is over."""

from __future__ import annotations

import contextlib
from bisect import bisect_right
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

from grader.recording.recording import ReceivedMessage
from grader.runner.cdr import fields_of
from grader.runner.grader_side import ACCEPT_ANY, Clocks
from grader.runner.message import message_class
from grader.runner.message_order import in_canonical_order, place_of, unordered_sources, without_order
from grader.runner.program import CannotContinue, Task
from grader.scenario.command_line import starts
from rmw_lockstep.hub import DeliveredMessage, HubNode, HubSubscription, QosPolicies

#: No exercise needs more than this from a node in one scenario.
MOST_MESSAGES = 5_000


def recorded_topics(task: Task) -> tuple[tuple[str, str], ...]:
    """Return names and types of the topics to record, with those that a remapping or a namespace adds."""
    found = {topic.name: topic.type for topic in task.exercise.outputs}
    for start in starts(task.exercise, task.scenario):
        for topic in task.exercise.outputs:
            for name in (topic.name, f"{start.namespace}{topic.name}"):
                found[name] = found[start.resolved(name)] = topic.type
    return tuple(found.items())


@dataclass(frozen=True)
class RecordedTopic:
    """The messages of one of the grader's subscriptions; `subscriber` is its name if it belongs to the scenario."""

    topic: str
    type: str
    subscriber: str = ""


class Recorder:
    """Subscribes to the topics that the exercise's program is to publish, and to those that a scenario adds."""

    def __init__(
        self,
        node: HubNode,
        topics: Sequence[tuple[str, str]],
        earliest: int = 0,
        ours: Callable[[int], bool] = lambda process: False,
    ) -> None:
        """`topics` are names and types. What arrives before `earliest` (ns) is recorded as if it had arrived then.

        Messages from a process that is `ours` are not recorded.
        """
        self._node, self._earliest, self._ours = node, earliest, ours
        self._listening: list[RecordedTopic] = []
        self._heard: list[tuple[int, DeliveredMessage]] = []
        self._own: dict[str, HubSubscription] = {}
        self._paused = False
        for name, type_name in topics:
            self._subscribe(RecordedTopic(name, type_name), ACCEPT_ANY)

    def join(self, name: str, topic: str, type_name: str, qos: QosPolicies) -> None:
        """Add a subscriber of the scenario's own."""
        self.leave(name)
        self._own[name] = self._subscribe(RecordedTopic(topic, type_name, name), qos)

    def leave(self, name: str) -> None:
        """Remove a subscriber of the scenario's own."""
        if name in self._own:
            self._own.pop(name).close()

    def _subscribe(self, listening: RecordedTopic, qos: QosPolicies) -> HubSubscription:
        number = len(self._listening)
        self._listening.append(listening)

        def keep(heard: DeliveredMessage) -> None:
            if self._paused or self._ours(heard.publisher.process):
                return
            self._heard.append((number, heard))
            if len(self._heard) > MOST_MESSAGES:
                self._heard.pop()
                raise CannotContinue("over-limit", f"Your node published more than {MOST_MESSAGES:,} messages.")

        return self._node.subscription(listening.topic, listening.type, qos, keep)

    @contextlib.contextmanager
    def paused(self) -> Iterator[None]:
        """Record nothing inside the `with` block."""
        self._paused = True
        try:
            yield
        finally:
            self._paused = False

    def has_received_since(self, stage: int) -> bool:
        """Return whether anything has arrived since number `stage` of what the hub has published."""
        return any(heard.stage >= stage for _, heard in self._heard)

    def received(self, clocks: Clocks, stages: Sequence[int]) -> tuple[ReceivedMessage, ...]:
        """Return what has arrived, in order. Raises `CannotContinue` for bytes that are not a message.

        `stages` has the number of each message sent, among everything the hub has published: `DeliveredMessage.stage`.
        """
        found = []
        sources = unordered_sources(self._heard)
        unordered = without_order(self._heard, sources)
        for number, heard in in_canonical_order(self._heard, sources):
            to = self._listening[number]
            at = max(self._earliest, clocks.simulated(heard.now, heard.stage))
            after = bisect_right(stages, heard.stage)
            fields = fields_of(heard.cdr, message_class(to.type))
            any_order = place_of(number, heard) in unordered
            found.append(ReceivedMessage(at, after, to.topic, to.type, fields, to.subscriber, heard.node, any_order))
        return tuple(found)
