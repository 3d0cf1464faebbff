"""Helpers for nodes that publish on their own: how often, when, with which stamps, and to whom."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from typing import Any

from grader.checking.cause import UNKNOWN, Cause
from grader.checking.comparator import TOLERANCE, equal, shown
from grader.checking.graph import lacking, publishers, shown_names
from grader.checking.hint_texts import hints
from grader.checking.partial import each
from grader.checking.patterns import COMPUTER_CLOCK, shift
from grader.checking.recorded_run import RecordedRun
from grader.recording.recording import ReceivedMessage
from grader.scenario.scenario import RATE
from grader.scenario.times import SECOND, START
from ros_in_python.field_path import field_of

#: A larger stamp (s) can't be simulated time, which begins at 100 s.
COMPUTER_STAMP = 1_000_000


def must_publish(run: RecordedRun, topic: str = "", count: int | None = None) -> None:
    """Check that the node publishes on `topic`: `count` messages, or at least one.

    Example: `run.must_publish("/out", count=10)`
    """
    name = topic or run.output.name
    got = len(run.published_on(name))
    expected = f"{count} messages" if count is not None else "at least one message"
    if not got and count != 0:
        _never(run, name, expected)
    if count is not None and got != count:
        run.wrong_at(None, f"expected {expected} on {name}, got {got}.", "", expected, got)


def must_match_series(
    run: RecordedRun,
    field: str = "",
    topic: str = "",
    tolerance: float = TOLERANCE,
    time: float | None = None,
    subscriber: str = "",
) -> None:
    """Check that the node's first message has the same `field` as the solution's first, and so on to the last.

    Without a `field`, whole messages are compared. With `time`, each must come within that many seconds of the
    solution's. With `subscriber`, only what that subscriber of the scenario got is compared. What several threads
    published at one moment has no order, so any order is right.

    Example: `run.must_match_series("data", "/out", time=0.02)`
    """
    name = topic or run.output.name
    expected = run.published_on(name, reference=True, subscriber=subscriber)
    got = _in_the_order_of(expected, run.published_on(name, subscriber=subscriber), field, tolerance)
    if expected and not got:
        _never(run, name, f"{len(expected)} messages", subscriber)
    pairs = list(zip(expected, got, strict=False))
    too_early = _at_the_start(expected, got)
    shifted = shift(_values(expected, field), _values(got, field), tolerance)
    messages = [(e.fields, g.fields) for e, g in pairs]

    def judge(numbered: tuple[int, tuple[ReceivedMessage | None, ReceivedMessage | None]]) -> None:
        number, (reference, message) = numbered
        part = f"message {number} on {name}"
        if reference is None or message is None:
            text = f"expected {len(expected)} messages on {name}, got {len(got)}."
            in_all = shifted or too_early or run.waits() or _stops(expected, got)
            run.wrong_at(None, text, "", f"{len(expected)} messages", len(got), in_all)
        if not shifted:
            run.compare_at(
                message.at, part, field, message.fields, reference.fields, tolerance, name, messages, too_early
            )
        if time is not None and abs(message.at_ns - reference.at_ns) > time * SECOND + 1:
            _wrong_time(run, part, reference, message, pairs)

    each(enumerate(itertools.zip_longest(expected, got), start=1), judge)
    if shifted:
        run.wrong_at(got[0].at, "the messages are shifted.", name, "each at its place", "shifted by one", shifted)


def must_keep_rate(run: RecordedRun, hz: float, topic: str = "", tolerance: float = 0.02) -> None:
    """Check that the node publishes `hz` times per second of simulated time on average, within `tolerance` (0.02: 2 %).

    It must continue for as long as the solution does. A short gap before the second message does not count: a timer
    that is created before the clock starts fires as soon as it does, and then at multiples of its period since 0
    (rcl_timer_call in rcl's timer.c), as with any robot's or simulator's clock.

    Example: `run.must_keep_rate(10.0, "/out")`
    """
    name = topic or run.output.name
    got, expected = run.published_on(name), run.published_on(name, reference=True)
    if len(got) < 2:
        _never(run, name, f"{hz:g} messages per second") if not got else None
        text = f"only one message was published on {name}."
        run.wrong_at(got[0].at, text, "", f"{hz:g} Hz", "one message", run.waits() or _ONLY_ONE)
    if got[0].at_ns == got[-1].at_ns:
        at_once = f"all {len(got)} messages on {name} were published at one moment, {hz:g} per second were expected."
        run.wrong_at(got[0].at, at_once, "", f"{hz:g} Hz", f"{len(got)} at once", _at_one_moment(got[0].at_ns))
    regular = got[1:] if _begins_with_the_clock(got) else got
    rate = (len(regular) - 1) * SECOND / max(regular[-1].at_ns - regular[0].at_ns, 1)
    if abs(rate / hz - 1) > tolerance:
        text = f"expected {hz:g} messages per second on {name}, got {rate:.4g}."
        run.wrong_at(None, text, "", f"{hz:g} Hz", f"{rate:.4g} Hz", _of_rate(rate / hz, hz, rate))
    if expected and expected[-1].at_ns - got[-1].at_ns > 2 * SECOND / hz:
        last = got[-1].at
        text = f"your node published nothing on {name} after that, but must continue."
        end = f"the last message at {last:.2f} s"
        run.wrong_at(got[-1].at, text, "", f"{hz:g} Hz to the end", end, run.waits())


def must_have_no_gap(
    run: RecordedRun, longest: float, topic: str = "", start: float = 0.0, end: float | None = None
) -> None:
    """Check that no two messages are more than `longest` s of simulated time apart, between `start` and `end` (s).

    The time from `start` to the first message counts too, and the time from the last one to `end`. Without an `end`,
    the messages must continue for as long as the solution's.

    Example: `run.must_have_no_gap(0.15, "/out")`
    """
    name = topic or run.output.name
    times = [message.at for message in run.published_on(name)]
    if end is None:
        end = max((message.at for message in run.published_on(name, reference=True)), default=None)
    if end is not None and end < start:
        text = f"from {start:g} s on there is nothing to look at on {name}: it ends at {end:g} s"
        raise ValueError(f"{text} in the scenario {run.scenario}. Give a smaller start.")
    inside = [at for at in times if at >= start and (end is None or at <= end)]
    moments = [start, *inside, *([end] if end is not None else [])]
    for before, after in itertools.pairwise(moments):
        if after - before > longest + 1e-9:
            text = f"nothing was published on {name} for {after - before:.2f} s, from {before:.2f} s on."
            run.wrong_at(before, text, "", f"a gap of at most {longest:g} s", f"{after - before:.2f} s", _GAP)
    if not times:
        _never(run, name, f"a message every {longest:g} s")
    if not inside:
        text = f"expected messages on {name}, got none from {start:g} s on."
        run.wrong_at(times[-1], text, "", f"a message every {longest:g} s", "none", run.waits())


def must_stamp(run: RecordedRun, topic: str = "", field: str = "header.stamp", within: float = 0.001) -> None:
    """Check that each message's stamp is the node's time when it is published, within this many seconds.

    Example: `run.must_stamp("/point")`
    """
    name = topic or run.output.name
    messages = run.published_on(name)
    if not run.published_on(name, reference=True):
        raise ValueError(f"the solution publishes nothing on {name} in the scenario {run.scenario}.")
    stamps = [_nanoseconds(field_of(message.fields, field)) for message in messages]

    def judge(numbered: tuple[int, tuple[ReceivedMessage, int]]) -> None:
        number, (message, stamp) = numbered
        if abs(stamp - message.at_ns) > within * SECOND:
            expected, got = shown(_stamp(message.at_ns)), shown(_stamp(stamp))
            text = f"expected {field} {expected}, the time when it was published, got {got}."
            run.wrong_at(message.at, text, f"message {number} on {name}", expected, got, _of_stamps(stamps, messages))

    each(enumerate(zip(messages, stamps, strict=True), start=1), judge)


def _values(messages: Sequence[ReceivedMessage], field: str) -> list[Any]:
    return [field_of(message.fields, field) for message in messages]


def _never(run: RecordedRun, topic: str, expected: str, subscriber: str = "") -> None:
    mine = publishers(run, topic)
    if not mine:
        names = shown_names(run, "publisher")
        text = f"your node does not publish on {topic}. It publishes on: {names}."
        run.wrong_at(None, text, "", expected, "none", _IN_INIT if names == "none" else lacking("publisher"))
    if subscriber and run.published_on(topic):
        text = f"the subscriber “{subscriber}” got nothing on {topic}."
        cause = _VOLATILE if any(end.durability == "volatile" for end in mine) else UNKNOWN
        run.wrong_at(None, text, "", expected, "none", cause)
    text = f"your node has a publisher on {topic}, but never published anything."
    run.wrong_at(None, text, "", expected, "none", run.waits() or _NOT_CALLED)


_IN_INIT = Cause("Does __init__ come to its end?", *hints("in_init"))

_NOT_CALLED = Cause("", *hints("not_published"))

_VOLATILE = Cause(
    "Your publisher is volatile: a late subscriber gets nothing that was published before.", *hints("volatile")
)

_ONLY_ONE = Cause("The period of a timer is in seconds.", *hints("only_one"))
_GAP = Cause("Does a callback wait or sleep meanwhile?", *hints("gap"))


def _wrong_time(
    run: RecordedRun,
    part: str,
    reference: ReceivedMessage,
    message: ReceivedMessage,
    pairs: Sequence[tuple[ReceivedMessage, ReceivedMessage]],
) -> None:
    late = [got.at - expected.at for expected, got in pairs]
    at, general = reference.at, ""
    if len(late) >= 3 and max(late) - min(late) < 0.02 * abs(late[0]):
        general = f"Every message comes {abs(late[0]):.2f} s too {'late' if late[0] > 0 else 'early'}."
    general = general or _at_the_start([reference], [message])
    text = f"it was expected at {at:.2f} s, but happened at {message.at:.2f} s."
    run.wrong_at(message.at, text, part, f"{at:.2f} s", f"{message.at:.2f} s", general)


#: The clock of a new node is 0, and jumps to the simulated time with the first message on /clock.
_WITH_THE_CLOCK = (
    "What is published at 0.00 s comes from the constructor, or from a timer that was created there: such a timer "
    "fires as soon as simulated time begins, whatever its period."
)


def _at_the_start(expected: Sequence[ReceivedMessage], got: Sequence[ReceivedMessage]) -> str:
    """Explain why there are more messages at the start than expected; empty if there are not."""
    mine, its = (sum(message.at_ns <= START for message in series) for series in (got, expected))
    return _WITH_THE_CLOCK if mine > its else ""


def _in_the_order_of(
    expected: Sequence[ReceivedMessage], got: Sequence[ReceivedMessage], field: str, tolerance: float
) -> list[ReceivedMessage]:
    """Return `got`, with simultaneous messages from several threads reordered to match `expected`."""
    left, ordered = list(got), []
    for reference in expected[: len(got)]:
        unordered, value = left[0].unordered or reference.unordered, field_of(reference.fields, field)
        at_once = [i for i, message in enumerate(left) if message.at_ns == left[0].at_ns] if unordered else [0]
        same = (i for i in at_once if equal(field_of(left[i].fields, field), value, tolerance))
        ordered.append(left.pop(next(same, 0)))
    return ordered + left


def _begins_with_the_clock(series: Sequence[ReceivedMessage]) -> bool:
    """Return whether the second message comes sooner than the third.

    That is how a timer begins. Two messages at once do not come from one timer.
    """
    return len(series) > 2 and 0 < series[1].at_ns - series[0].at_ns < series[2].at_ns - series[1].at_ns


#: A wrong rate alone does not show which of the two is the cause.
_PERIOD_OR_CLOCK = Cause(
    "Either its period is wrong, or your node waits by the computer's clock (time.sleep or a wall timer), which runs "
    "at another speed here.",
    *hints("period_or_clock"),
)


def _of_rate(ratio: float, hz: float, rate: float) -> Cause:
    if abs(ratio * COMPUTER_CLOCK - 1) < 0.02:
        return _PERIOD_OR_CLOCK
    if abs(rate * hz - 1) < 0.02 * hz * rate and hz != 1:
        text = f"It publishes every {hz:g} s: a timer takes the period in seconds, not the rate."
        return Cause(text, *hints("rate_as_period"))
    if abs(rate / RATE - 1) < 0.02:
        return Cause("", *hints("each_tick"))
    return UNKNOWN


def _at_one_moment(at: int) -> Cause:
    seen = _WITH_THE_CLOCK if at <= START else "No time passed between them."
    return Cause(seen, *hints("at_one_moment"))


def _of_stamps(stamps: Sequence[int], messages: Sequence[ReceivedMessage]) -> Cause:
    if not any(stamps):
        if all(message.at_ns <= START for message in messages):
            return Cause("The node's clock had not started when it published them.", *_STAMP)
        return Cause(
            "Every stamp is 0: your node does not fill it in, or it takes the time before its clock runs, in __init__ "
            "or before rclpy.spin(node).",
            *_STAMP,
        )
    if all(stamp > COMPUTER_STAMP * SECOND for stamp in stamps):
        text = "Every stamp is the computer's time. Take the time from the node's clock: self.get_clock().now()."
        return Cause(text, *_STAMP)
    if len(stamps) > 2 and len(set(stamps)) == 1:
        return Cause("Every stamp is the same.", *_STAMP)
    text = _common_to_stamps([divmod(stamp, SECOND) for stamp in stamps], [divmod(m.at_ns, SECOND) for m in messages])
    if text and len(stamps) > 2:
        return Cause(text, *_STAMP)
    text = "Only the first stamp is 0: the node's clock had not started when it was published."
    return Cause(text, *hints("before_the_clock")) if not stamps[0] and all(stamps[1:]) else UNKNOWN


def _common_to_stamps(stamps: list[tuple[int, int]], times: list[tuple[int, int]]) -> str:
    """Say what is wrong with the same part of each stamp (s, ns); empty if nothing is."""
    pairs = list(zip(stamps, times, strict=True))
    for part, number in (("sec", 0), ("nanosec", 1)):
        if not any(stamp[number] for stamp in stamps):
            return f"{part} is 0 in every stamp."
    for factor, unit in ((1_000, "microseconds"), (1_000_000, "milliseconds")):
        if all(s[0] == t[0] and abs(factor * s[1] - t[1]) <= factor for s, t in pairs):
            return f"Every nanosec is in {unit}."
    early = {SECOND * (time[0] - stamp[0]) + time[1] - stamp[1] for stamp, time in pairs}
    words = [f"{abs(by) / SECOND:.4g} s too {'early' if by > 0 else 'late'}" for by in early]
    return f"Every stamp is {words[0]}." if len(words) == 1 else ""


_STAMP = hints("stamp")


def _nanoseconds(stamp: dict[str, int]) -> int:
    return int(stamp["sec"]) * SECOND + int(stamp["nanosec"])


def _stamp(nanoseconds: int) -> dict[str, int]:
    return dict(zip(("sec", "nanosec"), divmod(nanoseconds, SECOND), strict=True))


def _stops(expected: Sequence[ReceivedMessage], got: Sequence[ReceivedMessage]) -> str:
    """Return when the last message came, if more were expected long after it."""
    if not 0 < len(got) < len(expected) or expected[-1].at_ns - got[-1].at_ns <= SECOND:
        return ""
    return f"The last one came at {got[-1].at:.2f} s."
