"""What a whole run shows of the cause of a failure, whichever check notices the failure."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from itertools import pairwise
from typing import Any

from grader.checking.cause import UNKNOWN, Cause
from grader.checking.hint_texts import hints, hints_of_ending
from grader.exercise.exercise import Exercise, Topic
from grader.recording.arrays import LongArray
from grader.recording.recording import EndPointKind, Recording
from grader.recording.types import CHANGE_STATE
from ros_in_python.field_path import NoSuchField, field_of

#: A float with this many units in its last place, at most, is what C finds if it takes a small Python int for a float:
#: the int's size and sign (`lv_tag`, or `ob_size` before 3.12, in CPython's longintrepr.h).
_TINY = 64 * 5e-324


def observed(exercise: Exercise, recording: Recording, reference: Recording) -> Cause:
    """Return the first cause that the run shows, in this order: an exception, messages that are never sent because a
    lifecycle node is not active, a parameter that is missing or that nobody serves, messages that the node sends to
    itself, ints in float fields, values without names, lists that pile up, only zeros, only false.
    """
    seers: tuple[Callable[[Exercise, Recording, Recording], Cause], ...] = (
        _exception,
        _lifecycle,
        _no_parameter,
        _hears_itself,
        _int_as_float,
        _letters,
        _without_names,
        _never_filled,
        _piles_up,
        _only_zeros,
        _only_false,
    )
    return next((cause for seer in seers if (cause := seer(exercise, recording, reference))), UNKNOWN)


def _exception(exercise: Exercise, recording: Recording, reference: Recording) -> Cause:
    ending = recording.ending
    if ending.survived or ending.line:
        return Cause(ending.survived, *hints_of_ending(ending.outcome, ending.message or ending.survived, ending.line))
    return UNKNOWN if ending.outcome == "completed" else Cause("", *hints_of_ending(ending.outcome))


def _lifecycle(exercise: Exercise, recording: Recording, reference: Recording) -> Cause:
    ends = {end.topic for end in recording.end_points if end.kind == "publisher"}
    node = next((node for node in recording.nodes if f"{node}/transition_event" in ends), "")
    is_asked = any(call.service == f"{node}/{CHANGE_STATE}" for call in recording.calls)
    if not node or recording.received or is_asked:
        return UNKNOWN
    return Cause(
        f"{node} is a lifecycle node, and it was never configured and activated: until then, its publishers send "
        "nothing.",
        *hints("lifecycle"),
    )


def _no_parameter(exercise: Exercise, recording: Recording, reference: Recording) -> Cause:
    changes = recording.parameters
    unknown = next((change.name for change in changes if "undeclared" in change.reason), "")
    if unknown:
        return Cause(f"Your node has no parameter {unknown}.", *hints("undeclared", parameter=unknown))
    silent = changes and not any(change.taken is not None for change in changes)
    seen = "Your node does not answer when somebody sets a parameter."
    return Cause(seen, *hints("does_not_spin")) if silent else UNKNOWN


def otherwise(exercise: Exercise, recording: Recording, reference: Recording) -> Cause:
    """Return what the whole run shows that may be the cause of a failure, if nothing else is known of it: several
    publishers on a topic, or a number that is always 0 next to one that is not.
    """
    return _several_publishers(exercise, recording) or _some_zeros(exercise, recording, reference)


def _several_publishers(exercise: Exercise, recording: Recording) -> Cause:
    for topic in exercise.outputs:
        nodes = [end.node for end in recording.end_points if (end.kind, end.topic) == ("publisher", topic.name)]
        if len(nodes) > 1:
            seen = f"Your program has {len(nodes)} publishers on {topic.name}, in {', '.join(sorted(set(nodes)))}."
            return Cause(seen, *hints("several_publishers", topic=topic.name))
    return UNKNOWN


def _hears_itself(exercise: Exercise, recording: Recording, reference: Recording) -> Cause:
    ends = {(end.kind, end.topic) for end in recording.end_points}
    own = (topic.name for topic in exercise.inputs if {(kind, topic.name) for kind in _BOTH} <= ends)
    name = next(own, "")
    seen = f"Your program also has a publisher on {name}: it hears its own messages."
    return Cause(seen, *hints("hears_itself", topic=name)) if name else UNKNOWN


_BOTH: tuple[EndPointKind, ...] = ("publisher", "subscription")


def _int_as_float(exercise: Exercise, recording: Recording, reference: Recording) -> Cause:
    for name, path, value in _numbers(recording):
        if 0 < abs(value) <= _TINY:
            field = path or "a field"
            seen = f"{field} on {name} is {value:.3g}, next to nothing: your node put an int into a float field."
            return Cause(seen, *hints("int_as_float", field=field))
    return UNKNOWN


def _numbers(recording: Recording) -> Iterator[tuple[str, str, float]]:
    """Yield the topic, service or action, the field's path and the value of each float that the program sent."""
    for message in recording.received:
        yield from ((message.topic, *item) for item in _floats(message.fields))
    for call in recording.calls:
        fields = call.request if call.by == "node" else call.response
        yield from ((call.service, *item) for item in _floats(fields))
    for goal in recording.goals:
        sent = [goal.goal] if goal.by == "node" else [goal.result, *(feedback.fields for feedback in goal.feedback)]
        yield from ((goal.action, *item) for fields in sent for item in _floats(fields))


def _floats(value: Any, path: str = "") -> Iterator[tuple[str, float]]:
    if isinstance(value, float):
        yield path, value
    elif isinstance(value, Mapping):
        for name, part in value.items():
            yield from _floats(part, f"{path}.{name}" if path else str(name))
    elif isinstance(value, (list, tuple)) and value and isinstance(value[0], Mapping):  # lists of numbers are converted
        for part in value:
            yield from _floats(part, path)


def _letters(exercise: Exercise, recording: Recording, reference: Recording) -> Cause:
    for topic in exercise.outputs:
        field = topic.elements.named_by if topic.elements else ""
        mine, its = ({len(str(name)) for name in _values(run, topic, field)} for run in (recording, reference))
        if field and mine == {1} != its:
            seen = (
                f"Each element of {field} on {topic.name} is one letter: a text stands where a list of texts belongs."
            )
            return Cause(seen, *hints("letters", field=field))
    return UNKNOWN


def _without_names(exercise: Exercise, recording: Recording, reference: Recording) -> Cause:
    for topic in exercise.outputs:
        elements = topic.elements
        if elements is None:
            continue
        for field in topic.units:
            mine, its = (_lengths(run, topic, elements.named_by, field) for run in (recording, reference))
            unnamed = any(values for _, values in mine) and not any(names for names, _ in mine)
            if unnamed and any(names for names, _ in its):
                return Cause(
                    f"{elements.named_by} is empty in every message on {topic.name}: nobody can know which "
                    f"{elements.called} each {field} belongs to.",
                    *hints("without_names", names=elements.named_by, field=field, element=elements.called),
                )
    return UNKNOWN


def _never_filled(exercise: Exercise, recording: Recording, reference: Recording) -> Cause:
    for topic in exercise.outputs:
        for field in topic.units:
            mine, its = (_lengths(run, topic, field) for run in (recording, reference))
            if mine and not any(length for (length,) in mine) and any(length for (length,) in its):
                seen = f"{field} is empty in every message on {topic.name}."
                return Cause(seen, *hints("never_filled", field=field))
    return UNKNOWN


def _piles_up(exercise: Exercise, recording: Recording, reference: Recording) -> Cause:
    for topic in exercise.outputs:
        for field in topic.units:
            mine, its = ([length for (length,) in _lengths(run, topic, field)] for run in (recording, reference))
            grows = len(mine) > 3 and all(before < after for before, after in pairwise(mine))
            if grows and its and mine[-1] > 2 * max(its):
                seen = (
                    f"{field} on {topic.name} gets longer with each message: {mine[0]}, {mine[1]}, {mine[2]} elements."
                )
                return Cause(seen, *hints("piles_up"))
    return UNKNOWN


def _lengths(recording: Recording, topic: Topic, *fields: str) -> list[tuple[int, ...]]:
    messages = [message.fields for message in recording.received if message.topic == topic.name]
    try:
        return [tuple(len(field_of(message, field)) for field in fields) for message in messages]
    except (NoSuchField, TypeError):
        return []


def _only_zeros(exercise: Exercise, recording: Recording, reference: Recording) -> Cause:
    for topic, zeros in _zeros(exercise, recording, reference):
        if not any(value for name, _, value in _numbers(recording) if name == topic.name):
            seen = f"{zeros[0]} is 0 in all {_count(recording, topic)} messages on {topic.name}."
            return Cause(seen, *hints("only_zeros", field=zeros[0]))
    return UNKNOWN


def _some_zeros(exercise: Exercise, recording: Recording, reference: Recording) -> Cause:
    for topic, zeros in _zeros(exercise, recording, reference):
        other = next((path for name, path, value in _numbers(recording) if name == topic.name and value), "")
        if other:
            which = f"{' and '.join(zeros)} {'are' if len(zeros) > 1 else 'is'} 0"
            seen = f"{which} in all {_count(recording, topic)} messages on {topic.name}, and {other} is not."
            return Cause(seen, *hints("some_zeros", field=zeros[0], other=other))
    return UNKNOWN


def _zeros(exercise: Exercise, recording: Recording, reference: Recording) -> Iterator[tuple[Topic, list[str]]]:
    """Yield each topic with those of its fields that are always 0, but not in the solution's messages."""
    for topic in exercise.outputs:
        fields = {field: [_values(run, topic, field) for run in (recording, reference)] for field in topic.units}
        zeros = [field for field, (mine, its) in fields.items() if len(mine) > 1 and not any(mine) and any(its)]
        if zeros:
            yield topic, zeros


def _count(recording: Recording, topic: Topic) -> int:
    return sum(message.topic == topic.name for message in recording.received)


def _values(recording: Recording, topic: Topic, field: str) -> list[float]:
    values: list[float] = []
    for message in recording.received:
        if message.topic == topic.name:
            try:
                value = field_of(message.fields, field)
            except NoSuchField:
                return []
            values += value if isinstance(value, (list, LongArray)) else [value]
    return values


def _only_false(exercise: Exercise, recording: Recording, reference: Recording) -> Cause:
    mine, its = _bools(recording), _bools(reference)
    for (name, field), values in its.items():
        got = mine.get((name, field), [])
        if any(values) and len(got) > 1 and not any(got):
            return Cause(f"{field} on {name} is false in all {len(got)} messages.", *hints("only_false", field=field))
    return UNKNOWN


def _bools(recording: Recording) -> dict[tuple[str, str], list[bool]]:
    """Return the bools that the program published and answered, by topic or service and field."""
    sent = [(message.topic, message.fields) for message in recording.received]
    sent += [(call.service, call.response or {}) for call in recording.calls if call.by == "grader"]
    found: dict[tuple[str, str], list[bool]] = {}
    for name, fields in sent:
        for field, value in fields.items():
            if isinstance(value, bool):
                found.setdefault((name, field), []).append(value)
    return found
