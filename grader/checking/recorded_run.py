"""One scenario as it was recorded, with the student's node and with the solution, and how a check reports what is
wrong."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, NoReturn

from grader.checking.cause import UNKNOWN, Cause, as_cause
from grader.checking.comparator import difference, shown, shown_apart
from grader.checking.existing_names import names_of, not_existing
from grader.checking.hint_texts import hints
from grader.checking.message import Exchange, Message, WorldState, exchanges
from grader.checking.observed import observed, otherwise
from grader.checking.patterns import COMPUTER_CLOCK, always, common, other_text
from grader.checking.verdict import Finding, Wrong, with_values
from grader.exercise.exercise import Exercise, Role, ServiceOrAction, Topic
from grader.recording.recording import Ending, ReceivedMessage, Recording, SentMessage
from ros_in_python.field_path import NoSuchField, field_of, steps_of

_WAITS = (
    "Your node sent {request} to {name} at {at:.2f} s, and did nothing from then on. Does a callback wait, with "
    "call(), get_result(), await, spin_until_future_complete() or time.sleep()? No other callback runs meanwhile, not "
    "even the one that takes the answer. Don't wait: give the future a callback with add_done_callback()."
)

#: A node counts as stuck if it does nothing for this long (s) after its last request while the solution does something.
_STUCK = 0.2

_SLEEPS = Cause(
    "Does your node wait by the computer's clock, such as with time.sleep? It goes at another speed here.",
    *hints("sleeps"),
)


@dataclass(frozen=True, eq=False)
class RecordedRun:
    """One scenario: the student's recording and the solution's. `title` describes the scenario to students.

    `seed` is the one that `scenarios(seed)` got.
    """

    exercise: Exercise
    recording: Recording
    reference: Recording
    title: str = ""
    seed: int = 1

    @property
    def scenario(self) -> str:
        """Return the scenario's name.

        Example: `run.scenario`
        """
        return self.recording.scenario

    @property
    def nodes(self) -> tuple[str, ...]:
        """Return the full names of the student's nodes.

        Example: `run.nodes`
        """
        return self.recording.nodes

    @property
    def ending(self) -> Ending:
        """Return how the run ended.

        Example: `run.ending.traceback`
        """
        return self.recording.ending

    @cached_property
    def sent(self) -> list[Message]:
        """Return every message sent to the node.

        Example: `run.sent[0].data`
        """
        return [Message(sent) for sent in self.recording.sent]

    @cached_property
    def received(self) -> list[Message]:
        """Return every message that the node published on the exercise's topics.

        Example: `run.received[-1].at`
        """
        return [Message(received) for received in self.recording.received if not received.subscriber]

    @cached_property
    def truth(self) -> list[WorldState]:
        """Return what the world's truth() returned after each step, with the student's node in the loop.

        Example: `run.truth[-1].level`
        """
        return [WorldState(truth) for truth in self.recording.truth]

    @cached_property
    def exchanges(self) -> list[Exchange]:
        """Return each message sent, with the node's answers and the solution's.

        Example: `run.exchanges[0].answers[0].data`
        """
        return exchanges(self.recording, self.reference)

    @cached_property
    def observed(self) -> Cause:
        """Return what the whole run shows of the cause of any failure in it, such as an exception."""
        return observed(self.exercise, self.recording, self.reference)

    def wrong(
        self,
        exchange: Exchange,
        text: str,
        part: str = "",
        expected: object = "",
        got: object = "",
        cause: str | Cause = UNKNOWN,
    ) -> NoReturn:
        """End the check: `text` says what is wrong with the answers to this exchange's message.

        `part` is the wrong part of the message, such as the joint. Reports show `expected` and `got` separately; those
        that are no texts, such as numbers, are also added to the text. `cause` is what is probably behind it; what the
        whole run shows has priority. A text is a sentence that the student reads after `text`, and the check's own
        hints stay; a `Cause` has hints of its own. All failures with the same cause are shown as one mistake.

        Example: `run.wrong(run.exchanges[0], "the sign is wrong.", expected=1, got=-1)`
        """
        where = f"Message {exchange.number} of {len(self.sent)} ({exchange.sent.at:.2f} s after the start"
        where += f"; {self.title})" if self.title else ")"
        place = f"{where}{f', {part}' if part else ''}"
        finding = _finding(place, text, part, expected, got)
        self._end(replace(finding, scenario=self.scenario, message=exchange.number, at=exchange.sent.at), cause)

    def wrong_at(
        self,
        at: float | None,
        text: str,
        part: str = "",
        expected: object = "",
        got: object = "",
        cause: str | Cause = UNKNOWN,
    ) -> NoReturn:
        """End the check: `text` says what is wrong at `at` (s after the start), or in the whole scenario.

        `part` is what is wrong, such as a service or a goal. `expected`, `got` and `cause` are as in `wrong`.

        Example: `run.wrong_at(run.received[0].at, "the valve is open.", "/out")`
        """
        where = "" if at is None else "Before the start" if at < 0 else f"At {at:.2f} s"
        if self.title:
            where += f" ({self.title})" if where else f"In “{self.title}”"
        finding = _finding(", ".join(filter(None, (where, part))), text, part, expected, got)
        self._end(replace(finding, scenario=self.scenario, at=at), cause)

    def _end(self, finding: Finding, cause: str | Cause) -> NoReturn:
        known = self.observed or as_cause(cause) or otherwise(self.exercise, self.recording, self.reference)
        text = f"{finding.text} {known.seen}".strip()
        same = known.seen or (known.where if self.recording.ending.line else "")
        raise Wrong(replace(finding, text=text, cause=same, where=known.where, todo=known.todo))

    def compare_at(
        self,
        at: float | None,
        part: str,
        field: str,
        got: dict[str, Any],
        expected: dict[str, Any],
        tolerance: float,
        name: str,
        pairs: Iterable[tuple[dict[str, Any], dict[str, Any]]],
        otherwise: str | Cause = UNKNOWN,
    ) -> None:
        """End the check unless `field` (or, if it is empty, every field) is the same in both messages.

        `name` is the topic, service or action. `pairs` are all (expected, got) messages of this kind; the finding says
        what they have in common. If that is nothing, it ends with `otherwise`.

        Example: `run.compare_at(None, "call 1", "sum", {"sum": 3}, {"sum": 3}, 0.0, "/add", [])`
        """
        differing = difference(field_of(got, field), field_of(expected, field), tolerance, field)
        if not differing:
            return
        unit = self.unit_of(str(next(iter(steps_of(differing.path)), "")), name)
        expected_text, got_text = shown_apart(differing.expected, differing.got, unit)
        numbers = [(_number(e, differing.path), _number(g, differing.path)) for e, g in pairs]
        known = [(e, g) for e, g in numbers if e is not None and g is not None]
        general = (
            common(known, differing.path, unit)
            or other_text(differing.got, differing.expected, self.exercise.task)
            or always([(_text(e, differing.path), _text(g, differing.path)) for e, g in pairs], differing.path)
        )
        self.wrong_at(
            at,
            f"expected {differing.path} {expected_text}, got {got_text}.",
            part,
            expected_text,
            got_text,
            general or otherwise,
        )

    def time_at(self, at: float, expected: float, part: str, time: float | None, since: float = 0.0) -> None:
        """End the check if something happened more than `time` s before or after it was expected.

        `at` and `expected` are in seconds after the start; `since` is when the node began to wait for it.

        Example: `run.time_at(run.received[0].at, 0.0, "/out", time=0.1)`
        """
        if time is not None and abs(at - expected) > time + 1e-9:
            expected_text, got_text = f"{expected:.2f} s", f"{at:.2f} s"
            by_computer = expected > since and math.isclose(
                (at - since) / (expected - since), COMPUTER_CLOCK, rel_tol=0.03
            )
            text = f"it was expected at {expected_text}, but happened at {got_text}."
            self.wrong_at(at, text, part, expected_text, got_text, _SLEEPS if by_computer else UNKNOWN)

    def waits(self) -> Cause:
        """Return whether the node sent a request or a goal and then did nothing."""
        asked = max(_requests(self.recording), default=None)
        if asked is None:
            return UNKNOWN
        last = max([asked[0], *(message.at for message in self.recording.received)])
        later = [message.at for message in self.reference.received] + [at for at, _, _ in _requests(self.reference)]
        if last > asked[0] or max(later, default=0) - last < _STUCK:
            return UNKNOWN
        at, name, request = asked
        return Cause(_WAITS.format(request=request, name=name, at=at), *hints("do_not_wait"))

    def unit_of(self, field: str, name: str = "") -> str:
        """Return the unit of a field in exercise.toml: of the topic, service or action `name`, or of any.

        A topic in a namespace has the units of the declared one.

        Example: `run.unit_of("data", "/out")`
        """
        declared: list[Topic | ServiceOrAction] = [
            *self.exercise.outputs,
            *self.exercise.endpoints,
            *self.exercise.inputs,
        ]
        return next((d.units[field] for d in declared if (not name or name.endswith(d.name)) and field in d.units), "")

    def messages_on(
        self, topic: str = "", reference: bool = False, subscriber: str = ""
    ) -> tuple[ReceivedMessage | SentMessage, ...]:
        """Return the messages on `topic`, by default those on the only output, with fields by name: `message.data`.

        They are the student's, or with `reference` those of the run with the solution. On a topic that only the grader
        or the world publishes, they are what these published. With `subscriber`, they are what that subscriber of the
        scenario got. Each has what a `Message` has.

        Example: `[message.data for message in run.messages_on("/out")]`
        """
        name = topic or self.output.name
        published = self.published_on(name, reference, subscriber)
        if published or subscriber or any(m.topic == name for m in self.reference.received):
            return published
        recording = self.reference if reference else self.recording
        return tuple(message for message in recording.sent if message.topic == name)

    def published_on(
        self, topic: str = "", reference: bool = False, subscriber: str = ""
    ) -> tuple[ReceivedMessage, ...]:
        """Return only what the student's node, or the solution, published on `topic`: see `messages_on`."""
        recording = self.reference if reference else self.recording
        name = self.existing("topic", topic or self.output.name)
        return tuple(m for m in recording.received if m.topic == name and m.subscriber == subscriber)

    @property
    def output(self) -> Topic:
        """Return the only topic that the exercise's node publishes. Raises ValueError if there are several."""
        if len(self.exercise.outputs) != 1:
            names = ", ".join(topic.name for topic in self.exercise.outputs) or "none"
            raise ValueError(f"name the topic: the topics that exercise.toml has under [[publish]] are: {names}.")
        return self.exercise.outputs[0]

    def existing(self, word: str, name: str) -> str:
        """Return the `name` of a topic, service or action. Raises ValueError if neither the exercise nor the run with
        the solution has it.
        """
        if problem := not_existing(name, word, self._names, self.scenario):
            raise ValueError(problem)
        return name

    @cached_property
    def _names(self) -> frozenset[str]:
        return names_of(self.exercise, self.reference)

    def only(self, role: Role) -> str:
        """Return the only service or action of a kind. Raises ValueError if there are several."""
        names = [endpoint.name for endpoint in self.exercise.of_role(role)]
        if len(names) != 1:
            raise ValueError(f"name the {role}: exercise.toml has {', '.join(names) or 'none'} under [[{role}]].")
        return names[0]


def _finding(place: str, text: str, part: str, expected: object, got: object) -> Finding:
    """Return what is wrong, with the values of `expected` and `got` that are no texts and that `text` does not have."""
    values = [value if isinstance(value, str) else shown(value) for value in (expected, got)]
    absent = ["" if isinstance(v, str) or s in text else s for v, s in zip((expected, got), values, strict=True)]
    message = with_values(text, zip(("expected", "got"), absent, strict=True))
    return Finding(f"{place}: {message}" if place else message, part=part, expected=values[0], got=values[1])


def _requests(recording: Recording) -> list[tuple[float, str, str]]:
    """Return when the node sent a request or a goal, to which service or action, and which of the two.

    A goal that was rejected is over.
    """
    calls = [(call.at, call.service, "a request") for call in recording.calls if call.by == "node"]
    goals = [goal for goal in recording.goals if goal.by == "node" and goal.accepted is not False]
    return calls + [(goal.at, goal.action, "a goal") for goal in goals]


def _value(fields: dict[str, Any], path: str) -> Any:
    """Return the value at a path; None if the message has no such field or element."""
    try:
        return field_of(fields, path)
    except (NoSuchField, IndexError):
        return None


def _text(fields: dict[str, Any], path: str) -> str:
    value = _value(fields, path)
    return value if isinstance(value, str) else ""


def _number(fields: dict[str, Any], path: str) -> float | None:
    value = _value(fields, path)
    return value if isinstance(value, (int, float)) and not isinstance(value, bool) else None
