"""Helpers for nodes that answer messages: which messages they answer, when, and with which values."""

from __future__ import annotations

import math
from functools import lru_cache
from itertools import pairwise
from typing import Any

from grader.checking.cause import UNKNOWN, Cause
from grader.checking.comparator import TOLERANCE, difference, equal, shown, shown_apart
from grader.checking.doubts import note
from grader.checking.hint_texts import hints
from grader.checking.late_answers import AT_ONCE, delay, how_late, in_general, is_late, is_one_late
from grader.checking.message import Exchange, Message
from grader.checking.partial import each
from grader.checking.patterns import FEWEST, ORDER, common, fixed_step
from grader.checking.recorded_run import RecordedRun
from grader.checking.unanswered import why_unanswered
from grader.recording.arrays import LongArray
from groundwork.words import counted

_COPIED = hints("copied")

#: Of a value with more characters than this, only the first difference is shown.
LONGEST = 80


def must_match(
    run: RecordedRun, field: str, per: str = "", tolerance: float = TOLERANCE, missing_ok: bool = False
) -> None:
    """Check that the node answers each message that the solution answers, with the same `field`.

    `per` names the list of names that `field` goes with, so that the order does not count: `must_match("velocity",
    per="name")`. Numbers may differ by `tolerance`, or by one part in a million if that is more. With `missing_ok`,
    missing answers are ignored, because another check judges them.

    Example: `run.must_match("data", tolerance=0.01)`
    """
    unit = _unit(run, field)

    def compare(exchange: Exchange) -> None:
        got = _answer(run, exchange)
        if per:
            _compare_each(run, exchange, got, field, per, unit, tolerance)
        else:
            _compare(run, exchange, got, field, unit, tolerance)

    if field.startswith("header"):
        _note_stamps(_expected(run))
    each((exchange for exchange in _expected(run) if exchange.answers or not missing_ok), compare)


def _note_stamps(exchanges: list[Exchange]) -> None:
    """Note whether a copied stamp can be told from the time at which the message arrived."""
    stamped = [exchange for exchange in exchanges if "header" in exchange.sent._fields]
    if stamped:
        text = "the stamp is also the time at which the message arrives, so a stamp from now() passes, too."
        note(text, tested=any(exchange.sent.stamp_ns != exchange.sent.at_ns for exchange in stamped))


def _expected(run: RecordedRun) -> list[Exchange]:
    """Return the messages that the solution answers. Raises ValueError if there are none."""
    if not any(exchange.expected for exchange in _exchanges(run)):
        raise ValueError(f"the solution answers no message in the scenario {run.scenario}. Use must_be_silent there.")
    return [exchange for exchange in run.exchanges if exchange.expected]


def _exchanges(run: RecordedRun, fewest: int = 1) -> list[Exchange]:
    """Return each message sent. Raises ValueError if the scenario sends fewer than this."""
    if len(run.reference.sent) < fewest:
        sends = f"the scenario {run.scenario} sends {counted(len(run.reference.sent), 'message')} to the node"
        fix = "Send more, or use must_match_series, which is for nodes that publish on their own."
        raise ValueError(f"{sends}, so no answer can be judged. {fix}")
    return run.exchanges


def _unit(run: RecordedRun, field: str) -> str:
    return next((topic.units[field] for topic in run.exercise.outputs if field in topic.units), "")


def must_answer(run: RecordedRun) -> None:
    """Check that the node answers every message that the solution answers, once.

    Example: `run.must_answer()`
    """

    def answered_once(exchange: Exchange) -> None:
        _answer(run, exchange)
        if len(exchange.answers) > 1:
            count = len(exchange.answers)
            run.wrong(exchange, f"one answer was expected, got {count}.", expected="1", got=str(count))

    each(_expected(run), answered_once)


def must_answer_at_once(run: RecordedRun, within: float = AT_ONCE) -> None:
    """Check that each answer comes before the next message, and within this many seconds of simulated time.

    Missing answers are ignored, because another check judges them.

    Example: `run.must_answer_at_once(within=0.02)`
    """

    def in_time(exchange: Exchange) -> None:
        for answer in exchange.answers:
            if is_late(exchange, answer, within):
                late = delay(run, exchange, answer)
                text = f"an answer was expected at once; it arrived {late}."
                run.wrong(exchange, text, "", "an answer at once", late, in_general(run))

    each(_expected(run), in_time)


def must_vary(run: RecordedRun, field: str, per: str = "") -> None:
    """Check that the node's `field` changes from message to message if the solution's does.

    A node that publishes zeros or a constant fails; one with wrong values does not. `per` is as in `must_match`.

    Example: `run.must_vary("data")`
    """
    _exchanges(run)
    expected, got = _series(run, field, per, reference=True), _series(run, field, per, reference=False)
    varying = {name: values for name, values in expected.items() if len(set(values)) > 1}
    if not varying:
        return
    published = [value for values in got.values() for value in values]
    if not published:
        answered = any(exchange.answers for exchange in run.exchanges)
        text = f"no {field} was published {f'with a {per}' if per and answered else 'at all'}."
        run.wrong(run.exchanges[-1], text, "", f"a {field} that changes", "none")
    if any(len(set(values)) > 1 for values in got.values()):
        return
    alike = len(set(published)) == 1
    constant, name = (
        shown(published[0], _unit(run, field)),
        next((name for name in got if name in varying and not alike), ""),
    )
    text = f"every {field} is {constant}" if alike else f"{field} is {constant} in every message"
    expected_, got_ = f"a {field} that changes", f"{constant} throughout"
    run.wrong(run.exchanges[-1], f"{text}, whatever was sent.", name, expected_, got_)


def _series(run: RecordedRun, field: str, per: str, reference: bool) -> dict[str, list[Any]]:
    """Return every value of `field`, by name, in the order of the messages."""
    series: dict[str, list[Any]] = {}
    for exchange in run.exchanges:
        for message in exchange.expected if reference else exchange.answers:
            values = message.by(per, field) if per else {"": message.value(field)}
            for name, value in values.items():
                series.setdefault(str(name), []).append(value)
    return series


def must_be_silent(run: RecordedRun) -> None:
    """Check that the node does not answer messages that the solution does not answer. The first message does not
    count.

    Example: `run.must_be_silent()`
    """
    _must_be_silent(run, _exchanges(run, fewest=2)[1:])


def must_be_silent_at_first(run: RecordedRun) -> None:
    """Check that the node does not answer the very first message, if the solution does not.

    Example: `run.must_be_silent_at_first()`
    """
    _must_be_silent(run, _exchanges(run)[:1])


def _must_be_silent(run: RecordedRun, exchanges: list[Exchange]) -> None:
    text = "no answer was expected, but your node published a message."
    for exchange in exchanges:
        if exchange.answers and not exchange.expected:
            run.wrong(exchange, text, "", "nothing", "a message")


def _answer(run: RecordedRun, exchange: Exchange) -> Message:
    if not exchange.answers:
        late = how_late(run, exchange)
        text = f"an answer was expected at once; it arrived {late}." if late else "an answer was expected, got none."
        run.wrong(exchange, text, "", "a message", late or "nothing", in_general(run) or why_unanswered(run, exchange))
    return exchange.answers[0]


def _compare(run: RecordedRun, exchange: Exchange, answer: Message, field: str, unit: str, tolerance: float) -> None:
    got, expected = answer.value(field), exchange.expected[0].value(field)
    differing = difference(got, expected, tolerance)
    if not differing:
        return
    place = field
    if differing.path and (isinstance(expected, LongArray) or len(shown(expected)) > LONGEST):
        place += differing.path if differing.path.startswith("[") else f".{differing.path}"
        got, expected = differing.got, differing.expected
    expected_text, got_text = shown_apart(expected, got, unit)
    text = f"expected {place} {expected_text}, got {got_text}."
    run.wrong(exchange, text, "", expected_text, got_text, pattern(run, field, unit=unit))


def _compare_each(
    run: RecordedRun, exchange: Exchange, answer: Message, field: str, per: str, unit: str, tolerance: float
) -> None:
    names, values = answer.value(per), answer.value(field)
    if len(names) != len(values):
        text = (
            f"{per} and {field} must have the same length; {per} has {len(names)} elements, {field} has {len(values)}."
        )
        run.wrong(exchange, text, "", f"{len(names)}", f"{len(values)}")
    expected, got = exchange.expected[0].by(per, field), answer.by(per, field)
    for name, value in expected.items():
        if name not in got:
            run.wrong(exchange, f"a {field} was expected, but your message does not name it.", name, shown(value), "")
        if not equal(got[name], value, tolerance):
            expected_text, got_text = shown_apart(value, got[name], unit)
            text = f"expected {field} {expected_text}, got {got_text}."
            cause = pattern(run, field, per, unit)
            run.wrong(exchange, text, name, expected_text, got_text, cause)
    for name, value in got.items():
        if name not in expected:
            text = f"no {field} was expected, got {shown(value, unit)}."
            run.wrong(exchange, text, str(name), "nothing", shown(value, unit))


@lru_cache(maxsize=8)  # every wrong answer needs it
def pattern(run: RecordedRun, field: str, per: str = "", unit: str = "") -> Cause:
    """Return what all values of `field` have in common.

    `per` names the list of names that `field` goes with; without it, `field` is one number.
    """
    if is_one_late(run):
        return Cause("Every answer is one message late: it is the right answer to the message before.", *ORDER)
    if copied := _copied(run, field, per):
        return Cause(f"Every {field} is the {copied} of the message that arrived, unchanged.", *_COPIED)
    pairs: list[tuple[float, float]] = []
    elapsed: list[float] = []
    for before, exchange in zip([None, *run.exchanges], run.exchanges, strict=False):
        if exchange.expected and exchange.answers:
            expected, got = _values(exchange.expected[0], field, per), _values(exchange.answers[0], field, per)
            pairs += [(expected[name], got[name]) for name in expected if name in got]
            elapsed += [_elapsed(before, exchange) for name in expected if name in got]
    return (
        fixed_step(pairs, elapsed, field, unit) or _since_the_first(run, field, per, unit) or common(pairs, field, unit)
    )


def _since_the_first(run: RecordedRun, field: str, per: str, unit: str) -> Cause:
    """Explain that every rate is the mean since the first message."""
    if not unit.endswith("/s"):
        return UNKNOWN
    ways: dict[str, list[tuple[float, float]]] = {}
    telling: list[tuple[float, float]] = []
    for before, exchange in pairwise(run.exchanges):
        if exchange.expected and exchange.answers:
            expected, got = _values(exchange.expected[0], field, per), _values(exchange.answers[0], field, per)
            dt = _elapsed(before, exchange)
            for name, rate in expected.items():
                way = ways.setdefault(name, [])
                way.append((rate * dt, dt))
                if name in got and len(way) > 1 and sum(time for _, time in way) > 0:
                    telling.append((sum(part for part, _ in way) / sum(time for _, time in way), got[name]))
    if len(telling) < FEWEST or not all(math.isclose(*pair, rel_tol=1e-3, abs_tol=1e-6) for pair in telling):
        return UNKNOWN
    return Cause(f"Every {field} is the change since the first message, and not since the last.", *hints("since_first"))


def _elapsed(before: Exchange | None, exchange: Exchange) -> float:
    """Return the seconds between the stamps of two messages; without stamps, between their arrivals."""
    if before is None:
        return 0.0
    if "header" in exchange.sent._fields:
        return exchange.sent.stamp - before.sent.stamp
    return exchange.sent.at - before.sent.at


def _copied(run: RecordedRun, field: str, per: str) -> str:
    """Return the field of the incoming messages that every answer repeats; empty if none."""
    answered = [exchange for exchange in run.exchanges if exchange.expected and exchange.answers]
    fields = answered[0].sent._fields if answered else {}
    return next((name for name in fields if name != per and _is_copied(answered, field, per, name)), "")


def _is_copied(answered: list[Exchange], field: str, per: str, name: str) -> bool:
    arrays = [exchange.answers[0].value(field) for exchange in answered]
    if all(isinstance(got, LongArray) for got in arrays):
        return all(exchange.sent.value(name) == got for exchange, got in zip(answered, arrays, strict=True))
    pairs = []
    for exchange in answered:
        if per and per not in exchange.sent._fields:
            return False
        sent, got = _values(exchange.sent, name, per), _values(exchange.answers[0], field, per)
        pairs += [(sent[key], got[key]) for key in got if key in sent]
    several = len({got for _, got in pairs}) > 1
    return several and all(math.isclose(a, b, rel_tol=1e-9, abs_tol=1e-12) for a, b in pairs)


def _values(message: Message, field: str, per: str) -> dict[str, float]:
    """Return the numbers in a field, by name."""
    value = message.value(field)
    if isinstance(value, list):  # no pattern is looked for in an image
        names = message.value(per) if per else [str(i) for i in range(len(value))]
        values = dict(zip(names, value, strict=False))
    else:
        values = {"": value}
    return {name: value for name, value in values.items() if isinstance(value, (int, float))}
