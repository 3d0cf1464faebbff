"""A world in a run: it receives the student's commands, and is stepped in simulated time."""

from __future__ import annotations

import json
from collections.abc import Callable
from functools import partial
from typing import Any

from grader.exercise.computing_limit import computing_limit
from grader.recording.events import Truth
from grader.runner.cdr import deserialized
from grader.runner.grader_side import ACCEPT_ANY, GraderSide, Schedule, nanoseconds
from grader.runner.message import message_class
from grader.runner.message_order import in_canonical_order, unordered_sources
from grader.runner.program import AuthorFault
from grader.runner.publishers import ReferencePublishers
from grader.scenario.scenario import START, Message, ToWorld
from grader.scenario.values import InvalidValue, checked_fields
from grader.scenario.world import World
from rmw_lockstep.hub import DeliveredMessage


class RunningWorld:
    """One world. `publish` publishes a message of the grader's."""

    def __init__(
        self, ends: GraderSide, schedule: Schedule, world: World, publishers: ReferencePublishers,
        publish: Callable[[Message], None],
    ) -> None:  # fmt: skip
        self._model, self._world = world.begin(), world
        self._schedule, self._publish = schedule, publish
        self._period = nanoseconds(world.period)
        self._topics = tuple(self._model.reads.items())
        self._heard: list[tuple[int, DeliveredMessage]] = []
        self.truth: list[Truth] = []
        for number, (topic, type_name) in enumerate(self._topics):
            ends.node.subscription(topic, type_name, ACCEPT_ANY, partial(self._keep, number))
        for topic, type_name in self._model.publishes.items():
            publishers.announce(topic, type_name)
        schedule.plan(START + self._period, self._step)

    def _keep(self, number: int, heard: DeliveredMessage) -> None:
        self._heard.append((number, heard))

    def _step(self, now: int) -> None:
        """Handle what arrived since the last step, step the world, and publish its state."""
        heard, self._heard = in_canonical_order(self._heard, unordered_sources(self._heard)), []
        arrived = [(*self._topics[number], one.cdr) for number, one in heard]
        messages = [(topic, deserialized(cdr, message_class(type_name))) for topic, type_name, cdr in arrived]

        def advance() -> dict[str, dict[str, object]]:
            for topic, message in messages:
                self._model.hear(topic, message)
            self._model.step(self._world.period)
            if truth := getattr(self._model, "truth", None):
                self.truth.append(Truth(now, json.loads(json.dumps(truth()))))
            return dict(self._model.state())

        for topic, fields in self._checked(self._ask(advance)).items():
            self._publish(Message(now, topic, self._model.publishes[topic], fields, line=0))
        self._schedule.plan(now + self._period, self._step)

    def do(self, step: ToWorld) -> None:
        """Call the method that a step names."""
        self._ask(lambda: getattr(self._model, step.method)(**step.arguments))

    def _checked(self, state: dict[str, dict[str, object]]) -> dict[str, dict[str, object]]:
        for topic, fields in state.items():
            type_name = self._model.publishes.get(topic, "")
            if not type_name:
                raise AuthorFault(f"the world {self._world.code.name} does not list {topic} in its publishes")
            try:
                state[topic] = checked_fields(message_class(type_name), fields, type_name)
            except InvalidValue as error:
                raise AuthorFault(f"{self._world.code.name}.state(), {topic}: {error.problem}. {error.fix}") from None
        return state

    def _ask(self, act: Callable[[], Any]) -> Any:
        try:
            with computing_limit():
                return act()
        except Exception as error:
            raise AuthorFault(f"the world {self._world.code.name}: {type(error).__name__}: {error}") from error
