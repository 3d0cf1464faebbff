"""What `%timeline` draws: events on services, actions and topics, as lanes along a time axis."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from itertools import pairwise
from typing import Literal

from spinbook.kernel.recorder_lines import read_lines

#: The states of a goal in which nothing more happens to it.
ENDS = ("SUCCEEDED", "CANCELED", "ABORTED")
#: The states in which a goal's action runs.
RUNS = ("EXECUTING", "CANCELING")


@dataclass(frozen=True)
class TimelineEvent:
    """A message that was sent at a time (s): its topic, service or action, its kind, its goal, and a summary.

    `what` is "message" (topic), "request", "response" (service), "goal", "accepted", "rejected", "feedback", "cancel",
    "cancel answered", or the new state of a goal.
    """

    at: float
    name: str
    what: str
    goal: str = ""
    text: str = ""


@dataclass
class RecordedEvents:
    """What the recorder has reported so far."""

    events: list[TimelineEvent] = field(default_factory=list)
    kinds: dict[str, str] = field(default_factory=dict)
    error: str | None = None

    def take(self, lines: Iterable[str]) -> None:
        """Add lines that the recorder printed."""
        for kind, rest in read_lines(lines):
            if kind == "event":
                self.events.append(TimelineEvent(*rest))
            elif kind == "found":
                self.kinds[rest[0]] = rest[1]
            elif kind == "error":
                self.error = rest[0]


@dataclass(frozen=True)
class Span:
    """A bar from one time to another (s). `look` says what is happening; `open` that it has not ended."""

    start: float
    end: float
    look: Literal["waits", "runs", "cancels"]
    open: bool = False


_MarkLook = Literal["tick", "asked", "answered", "cancel", "good", "bad"]


@dataclass(frozen=True)
class Mark:
    """A point in time (s) on a lane. `text` is written next to it, if there is any."""

    at: float
    look: _MarkLook
    text: str = ""


@dataclass(frozen=True)
class Lane:
    """One line of the picture. `name` is that of its topic, service or action; `label` is shown next to it."""

    name: str
    label: str
    spans: tuple[Span, ...]
    marks: tuple[Mark, ...]


def lanes(recording: RecordedEvents) -> tuple[Lane, ...]:
    """Return the lanes in the order of the names: one for each topic and service, one for each goal of an action."""
    events = sorted(recording.events, key=lambda event: event.at)
    end = max((event.at for event in events), default=0.0)
    drawn: list[Lane] = []
    for name, kind in recording.kinds.items():
        own = [event for event in events if event.name == name]
        if kind == "action":
            drawn += _goals(name, own, end)
        elif own:
            ticks = Lane(name, name, (), tuple(Mark(event.at, "tick") for event in own))
            drawn.append(_calls(name, own, end) if kind == "service" else ticks)
    return tuple(drawn)


def _calls(name: str, events: list[TimelineEvent], end: float) -> Lane:
    """Return the lane of a service. Responses are matched to requests in their order.

    A response before the first request belongs to a request from before the recording.
    """
    answers = [event.at for event in events if event.what == "response"]
    asked = [event.at for event in events if event.what == "request"]
    marks = [*(Mark(at, "asked", "request") for at in asked), *(Mark(at, "answered", "response") for at in answers)]
    spans = []
    for at in asked:
        after = [answer for answer in answers if answer >= at]
        spans.append(Span(at, after[0] if after else end, "waits", not after))
        answers = after[1:]
    return Lane(name, name, tuple(spans), tuple(sorted(marks, key=lambda mark: mark.at)))


def _goals(name: str, events: list[TimelineEvent], end: float) -> Iterator[Lane]:
    """Yield a lane for each goal, in the order in which they were sent."""
    numbers = dict.fromkeys(event.goal for event in events if event.goal)
    answers = _answers(events)
    for count, number in enumerate(numbers, start=1):
        own = [event for event in events if event.goal == number]
        asked = next((event.text for event in own if event.what == "goal"), "")
        label = f"{name} goal {count}" + (f": {asked}" if asked else "")
        yield _goal(name, label, [*own, *answers.get(number, [])], end)


def _answers(events: list[TimelineEvent]) -> dict[str, list[TimelineEvent]]:
    """Map each goal to its answers. Answers do not name their goal; they arrive in the order of the requests.

    A goal with any state was not rejected.
    """
    accepted = {event.goal for event in events if event.what in (*RUNS, *ENDS, "ACCEPTED")}
    answers: dict[str, list[TimelineEvent]] = {}
    for question, answer in (("goal", "rejected"), ("cancel", "cancel answered")):
        waiting = [
            each for each in events if each.what == question and (answer != "rejected" or each.goal not in accepted)
        ]
        for event in events:
            if event.what == answer and waiting and waiting[0].at <= event.at:
                answers.setdefault(waiting.pop(0).goal, []).append(event)
    return answers


def _goal(name: str, label: str, events: list[TimelineEvent], end: float) -> Lane:
    events = sorted(events, key=lambda event: event.at)
    marks = tuple(Mark(event.at, *_MARKS[event.what]) for event in events if event.what in _MARKS)
    return Lane(name, label, tuple(_bars(events, end)), marks)


def _bars(events: list[TimelineEvent], end: float) -> Iterator[Span]:
    """Yield the phases of a goal: waiting for an answer, running, being canceled."""
    looks: dict[str, Literal["waits", "runs", "cancels"]] = {
        "goal": "waits",
        "ACCEPTED": "waits",
        "EXECUTING": "runs",
        "CANCELING": "cancels",
    }
    steps = [event for event in events if event.what in looks or event.what in (*ENDS, "rejected")]
    for index, step in enumerate(steps):
        if step.what in looks:
            after = steps[index + 1].at if index + 1 < len(steps) else end
            yield Span(step.at, after, looks[step.what], index + 1 == len(steps))


#: What happens to a goal -> the look and the text of its mark.
_MARKS: Mapping[str, tuple[_MarkLook, str]] = {
    "goal": ("asked", "goal"),
    "feedback": ("tick", ""),
    "cancel": ("cancel", "cancel"),
    "cancel answered": ("answered", "answer to cancel"),
    "SUCCEEDED": ("good", "SUCCEEDED"),
    "CANCELED": ("bad", "CANCELED"),
    "ABORTED": ("bad", "ABORTED"),
    "rejected": ("bad", "rejected"),
}


def in_words(drawn: Iterable[Lane], start: float) -> str:
    """Describe the picture, in one line per lane; times are in s from `start`."""
    lines = []
    for lane in drawn:
        message = [f"{mark.text} at {mark.at - start:.2f} s" for mark in lane.marks if mark.text]
        ticks = [mark.at for mark in lane.marks if mark.look == "tick"]
        if ticks:
            message.insert(0, _ticks_in_words(ticks, start, "feedback" if lane.spans else "messages"))
        lines.append(f"{lane.label}: {', '.join(message)}")
    return "\n".join(lines)


def _ticks_in_words(ticks: list[float], start: float, what: str) -> str:
    gaps = [after - before for before, after in pairwise(ticks)]
    longest = f", longest gap {max(gaps):.2f} s" if gaps else ""
    return f"{len(ticks)} {what} from {ticks[0] - start:.2f} to {ticks[-1] - start:.2f} s{longest}"
