"""A recording as lines of text: what happened, in order of time."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import Any

from grader.recording.events import SECOND, Call, Cancel, Event, Feedback, Fields, Goal, GoalState, ProgramExit, Truth
from grader.recording.events import ParameterChange as Change
from grader.recording.events import ParameterReading as Reading
from grader.recording.recording import ReceivedMessage, Recording, SentMessage
from grader.report.printable import printable
from grader.scenario.scenario import ComeBack, Leave, StartProgram, Step, Subscribe, ToWorld

#: At most this many messages of a topic are shown, spread over the scenario, unless `--all` asks for all.
MOST_OF_A_TOPIC = 12

_OF_HEADERS = ("stamp", "header.frame_id")

#: In characters: the fields of one message.
_LONGEST = 100


def lines_of(
    recording: Recording, only: tuple[str, ...] = (), everything: bool = False, steps: Iterable[Step] = ()
) -> Iterator[str]:
    """Yield a line for each event. `only` are parts of names of topics, services, actions and parameters.

    Messages sent to the program have the sign →, what it published ←. Without `everything`, of a topic with many
    messages only some are shown, and the last line says how many are not. Of a message's fields, those that change
    come first. `steps` are the scenario's: what a recording does not have of them, such as a push, is shown, too.
    """
    truth = [Event(one.at_ns, "truth", one) for one in recording.truth]
    every = sorted([*recording.timeline, *truth, *_of_steps(steps)], key=lambda event: event.at_ns)
    events = [event for event in every if not only or any(part in event.what for part in only)]
    constant = _constants(filter(_is_message, events))
    left_out: dict[str, int] = {}
    shown = {id(event.item) for event in events if not _is_message(event)} if not everything else None
    if shown is not None:
        shown |= {id(event.item) for event in _some(events, left_out)}
    for event in events:
        if shown is None or id(event.item) in shown:
            yield f"{event.at:9.3f} s  {printable(_words(event, constant.get(event.what, frozenset())))}"
    for name, count in left_out.items():
        yield f"{count} more messages of {name.partition(' ')[2] or name} are not shown: --all shows them."


def _of_steps(steps: Iterable[Step]) -> Iterator[Event]:
    for step in steps:
        if isinstance(step, ToWorld):
            yield Event(step.at, f"world {step.method}", step)
        elif isinstance(step, Subscribe):
            yield Event(step.at, f"subscriber {step.name} on {step.topic}", step)
        elif isinstance(step, (Leave, ComeBack)):
            yield Event(step.at, f"{'leave' if isinstance(step, Leave) else 'come_back'} {step.name}", step)
        elif isinstance(step, StartProgram):
            yield Event(step.at, f"start {step.program}", step)


def _constants(events: Iterable[Event]) -> dict[str, frozenset[str]]:
    """Return the fields of each topic that have one value in all of several messages, unless all its fields do."""
    first: dict[str, dict[str, Any]] = {}
    changing: dict[str, set[str]] = {}
    for event in events:
        leaves = dict(_leaves(_content(event.item)))
        others = changing.setdefault(event.what, set())
        of_first = first.setdefault(event.what, leaves)
        others |= {
            path for path in of_first.keys() | leaves if path not in others and of_first.get(path) != leaves.get(path)
        }
    return {topic: frozenset(of.keys() - changing[topic]) for topic, of in first.items() if changing[topic] - {"stamp"}}


def _content(item: Any) -> Fields:
    fields: Fields = item.values if isinstance(item, Truth) else item.fields
    return fields


def _is_message(event: Event) -> bool:
    return event.what == "truth" or isinstance(event.item, (SentMessage, ReceivedMessage))


def _some(events: Iterable[Event], left_out: dict[str, int]) -> Iterator[Event]:
    """Yield some messages of each topic: the first and the last, and others at equal distances."""
    topics: dict[str, list[Event]] = {}
    for event in filter(_is_message, events):
        topics.setdefault(event.what, []).append(event)
    for name, messages in topics.items():
        count = len(messages)
        few = min(count, MOST_OF_A_TOPIC)
        chosen = {round(place * (count - 1) / max(few - 1, 1)) for place in range(few)}
        yield from (messages[place] for place in sorted(chosen))
        if count > len(chosen):
            left_out[name] = count - len(chosen)


def _words(event: Event, constant: frozenset[str]) -> str:
    item = event.item
    if isinstance(item, SentMessage):
        return f"→ {item.topic}  {_fields(item.fields, constant)}{'' if item.heard else '  (nobody subscribes)'}"
    if isinstance(item, ReceivedMessage):
        to = f"  (to the subscriber {item.subscriber})" if item.subscriber else ""
        return f"← {item.topic}  {_fields(item.fields, constant)}{to}"
    if event.what == "truth":
        return f"= truth  {_fields(item.values, constant)}"
    return f"• {event.what}  {_detail(event.what, item)}".rstrip()


def _detail(what: str, item: Any) -> str:
    if isinstance(item, Call):
        return _fields(item.request if what.startswith("request") else item.response or {})
    if isinstance(item, Goal):
        return f"{item.status} {_fields(item.result or {})}" if what.startswith("result") else _fields(item.goal)
    if isinstance(item, Feedback):
        return _fields(item.fields)
    if isinstance(item, GoalState):
        return item.state
    if isinstance(item, Cancel):
        return "accepted" if item.accepted else "not accepted"
    if isinstance(item, Change):
        return f"{item.value!r}: {'accepted' if item.taken else f'refused {item.reason}'.rstrip()}"
    if isinstance(item, Reading):
        return repr(item.value)
    if isinstance(item, ToWorld):
        return _fields(item.arguments)
    return f"by {item.by}" if isinstance(item, ProgramExit) else ""


def _fields(fields: Fields, constant: frozenset[str] = frozenset()) -> str:
    """Return the fields as a text: first those that change, then the stamp, then those that are always the same."""
    leaves = sorted(_leaves(fields), key=lambda leaf: 2 if leaf[0] in constant else leaf[0] in _OF_HEADERS)
    text = ", ".join(f"{path} = {value if path == 'stamp' else _number(value)}" for path, value in leaves)
    return text if len(text) <= _LONGEST else f"{text[:_LONGEST]}…"


def _leaves(fields: Fields, before: str = "") -> Iterator[tuple[str, Any]]:
    """Yield each field with its full name, without empty ones and what is 0 in a header, whose stamp is in seconds."""
    for name, value in fields.items():
        if f"{before}{name}" == "header.stamp" and isinstance(value, dict):
            if seconds := value.get("sec", 0) + value.get("nanosec", 0) / SECOND:
                yield "stamp", f"{seconds:.3f}"
        elif isinstance(value, dict):
            yield from _leaves(value, f"{before}{name}.")
        elif value not in ("", [], ()) and (value or not before.startswith("header.")):
            yield f"{before}{name}", value


def _number(value: Any) -> str:
    if isinstance(value, float):
        return f"{value:.4g}"
    if isinstance(value, (list, tuple)):
        return f"[{', '.join(_number(one) for one in value[:8])}{', …' if len(value) > 8 else ''}]"
    return repr(value)
