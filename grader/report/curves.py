"""What a plot of a grade shows: the field about which a check says something, and a curve for each element of it."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from grader.checking.comparator import equal
from grader.checking.message import Exchange, Message
from grader.checking.run import Run
from grader.checking.verdict import Finding
from grader.exercise.exercise import Exercise, Topic
from grader.recording.recording import Recording

if TYPE_CHECKING:
    from grader.grading.grade import Grade

#: (seconds after the scenario's start, value)
Point = tuple[float, float]

#: The highest value that is drawn, and the largest number of curves.
HIGHEST, MOST = 1e9, 24

#: An answer comes within this time (s).
AT_ONCE = 0.1


@dataclass(frozen=True)
class Quantity:
    """The field that is drawn. `element` is the word for one value; the list `named_by` contains the names of all.

    `topic` is the node's. `state` is the topic on which a world publishes it instead, if the node moves it.
    """

    field: str
    unit: str
    element: str
    named_by: str
    topic: str
    state: str = ""


@dataclass(frozen=True)
class Curve:
    """One element. Values that are not finite are left out of `expected` and `got`, but count as wrong.

    `first_wrong` is the first point that differs from the solution, at the node's value. If the node has no value
    there, or none that can be drawn, it is at the solution's.
    """

    element: str
    expected: tuple[Point, ...]
    got: tuple[Point, ...]
    first_wrong: Point | None


def drawn_quantity(exercise: Exercise, grade: Grade, scenario: str) -> Quantity | None:
    """Return the first field that exercise.toml gives a unit for, and that the node publishes; without units, the first
    number that changes. Topics that the first finding names come first; without topics, it is an action's feedback. If
    none of these changes, it is the first number that changes on a topic to which the node subscribes.

    In a closed loop, it is the first that the node moves: each node may do that with values of its own.
    """
    for topic in exercise.inputs if scenario in grade.recordings else ():
        mine, its = (
            [message.fields for message in runs[scenario].sent if message.topic == topic.name]
            for runs in (grade.recordings, grade.references)
        )
        if mine != its:
            for field, unit in topic.units.items():
                return Quantity(field, unit, "value", "name", "", topic.name)
    text = next((finding.text for finding in findings(grade, scenario)), "")
    runs = [of[scenario] for of in (grade.references, grade.recordings) if scenario in of]
    named = [topic for topic in exercise.outputs if topic.name in text]
    served = [
        Quantity(field, unit, "goal", "", end.name)
        for end in exercise.of_role("action")
        for field, unit in end.units.items()
    ]
    published = itertools.chain(_published(named, runs), _published(exercise.outputs, runs))
    return next(itertools.chain(published, served, _sent(exercise, runs)), None)


def _published(topics: Sequence[Topic], runs: Sequence[Recording]) -> Iterator[Quantity]:
    """Yield the fields of these topics with a unit, and then the numbers that change."""
    for topic in topics:
        for field, unit in topic.units.items():
            called, named_by = (topic.elements.called, topic.elements.named_by) if topic.elements else ("value", "name")
            yield Quantity(field, unit, called, named_by, topic.name)
    for topic in topics:
        for field in _changing([m.fields for run in runs for m in run.received if m.topic == topic.name]):
            yield Quantity(field, "", "value", "name", topic.name)


def _sent(exercise: Exercise, runs: Sequence[Recording]) -> Iterator[Quantity]:
    for topic in exercise.inputs:
        for field in _changing([m.fields for run in runs for m in run.sent if m.topic == topic.name]):
            yield Quantity(field, topic.units.get(field, ""), "value", "name", "", topic.name)


def _changing(messages: Sequence[Mapping[str, Any]]) -> list[str]:
    """Return the numbers that are not the same in all messages, by their full names."""
    values = [dict(_numbers(fields)) for fields in messages]
    return [field for field in values[0] if len({v.get(field) for v in values}) > 1] if values else []


def _numbers(fields: Mapping[str, Any], before: str = "") -> Iterator[tuple[str, float]]:
    """Yield each field that is a number, by its full name. A header's stamp only says when."""
    for name, value in fields.items():
        if isinstance(value, (int, float)) and not isinstance(value, bool):
            yield f"{before}{name}", value
        elif isinstance(value, Mapping) and name not in ("header", "stamp"):
            yield from _numbers(value, f"{before}{name}.")


def curves(grade: Grade, exercise: Exercise, scenario: str, quantity: Quantity) -> tuple[Curve, ...]:
    """Return the curves of one scenario that is in the grade's recordings, one for each name.

    A field that is a single number gives one curve, named as the field. Messages without such a field or without names
    give none.
    """
    if quantity.state:
        return (_state_curve(grade, scenario, quantity),)
    if quantity.topic in [end.name for end in exercise.endpoints]:
        return _feedback_curves(grade, scenario, quantity)
    run = Run(exercise, grade.recordings[scenario], grade.references[scenario])
    expected: dict[str, list[Point]] = {}
    got: dict[str, list[Point]] = {}
    moments = [(one.sent.at, one.expected, one.answers) for one in run.exchanges]
    if not _answers(run.exchanges, quantity.topic):
        # It publishes on its own, or later.
        its, mine = (run.published_on(quantity.topic, reference) for reference in (True, False))
        moments = [(Message(m).at, (Message(m),), ()) for m in its] + [(Message(m).at, (), (Message(m),)) for m in mine]
    try:
        for at, right, answers in moments:
            for lines, messages in ((expected, right), (got, answers)):
                for message in [one for one in messages if one.topic == quantity.topic]:
                    for element, value in _values(message, quantity).items():
                        lines.setdefault(str(element), []).append((at, _number(value)))
    except (LookupError, TypeError):
        return ()
    elements = [*expected, *(element for element in got if element not in expected)][:MOST]
    since = _first_finding(grade, scenario, [at for at, _, _ in moments])
    return tuple(_curve(element, expected.get(element, []), got.get(element, []), since) for element in elements)


def _state_curve(grade: Grade, scenario: str, quantity: Quantity) -> Curve:
    """Return what a world published of its state. The cross is at the first finding that has a time."""
    expected, got = (
        [
            (message.at, _number(Message(message).value(quantity.field)))
            for message in runs[scenario].sent
            if message.topic == quantity.state
        ]
        for runs in (grade.references, grade.recordings)
    )
    at = _times_of_findings(grade, scenario)
    before = [point for point in _drawable(got) if at and point[0] <= at[0] + 1e-6]
    return Curve(quantity.field, _drawable(expected), _drawable(got), before[-1] if before else None)


def _answers(exchanges: Sequence[Exchange], topic: str) -> bool:
    """Return whether every message that the solution publishes on `topic` answers one that arrives, at once."""
    published = [[message.at - one.sent.at for message in one.expected if message.topic == topic] for one in exchanges]
    return any(published) and all(len(late) <= 1 and max(late, default=0.0) < AT_ONCE for late in published)


def _feedback_curves(grade: Grade, scenario: str, quantity: Quantity) -> tuple[Curve, ...]:
    """Return the feedback of each goal that the student's node served."""
    its, mine = (
        {
            f"goal {goal.number}": [(one.at, _number(one.fields.get(quantity.field))) for one in goal.feedback]
            for goal in runs[scenario].goals
            if goal.action == quantity.topic
        }
        for runs in (grade.references, grade.recordings)
    )
    drawn = []
    for name in list(its)[:MOST]:
        expected, got = its[name], mine.get(name, [])
        since = _first_finding(grade, scenario, [at for at, _ in expected])
        pairs = itertools.zip_longest(expected, got)
        wrong = (g or e for e, g in pairs if not (e and g and equal(g[1], e[1], 1e-6)) and (g or e)[0] >= since)
        if expected or got:
            drawn.append(Curve(name, _drawable(expected), _drawable(got), next(wrong, None)))
    return tuple(drawn)


def findings(grade: Grade, scenario: str) -> list[Finding]:
    """Return what the public checks that failed say about a scenario."""
    failed = [verdict.finding for verdict in grade.verdicts if verdict.status == "failed" and not verdict.hidden]
    return [finding for finding in failed if finding and finding.scenario == scenario]


def _times_of_findings(grade: Grade, scenario: str) -> list[float]:
    return sorted(finding.at for finding in findings(grade, scenario) if finding.at is not None)


def _first_finding(grade: Grade, scenario: str, times: list[float]) -> float:
    """Return the time of the last message before the first finding: an earlier difference is allowed.

    Where nothing was found, every difference is.
    """
    failed = [verdict.finding for verdict in grade.verdicts if verdict.status == "failed"]
    if not any(finding and finding.scenario == scenario for finding in failed):
        return math.inf
    at = next(iter(_times_of_findings(grade, scenario)), 0.0)
    return max((time for time in times if time <= at + 1e-9), default=at)


def _values(message: Message, quantity: Quantity) -> dict[str, object]:
    value = message.value(quantity.field)
    if isinstance(value, (int, float)):
        return {quantity.field: value}
    return message.by(quantity.named_by, quantity.field)


def _number(value: object) -> float:
    return float(value) if isinstance(value, (int, float)) else math.nan


def _curve(element: str, expected: list[Point], got: list[Point], since: float) -> Curve:
    return Curve(element, _drawable(expected), _drawable(got), _first_difference(dict(expected), dict(got), since))


def _drawable(points: list[Point]) -> tuple[Point, ...]:
    return tuple(point for point in points if abs(point[1]) < HIGHEST)


def _first_difference(expected: dict[float, float], got: dict[float, float], since: float) -> Point | None:
    for at in sorted(at for at in {*expected, *got} if at >= since):
        if at not in expected or at not in got or not equal(got[at], expected[at], 1e-6):
            shown = (value for value in (got.get(at), expected.get(at)) if value is not None and abs(value) < HIGHEST)
            return at, next(shown, 0.0)
    return None
