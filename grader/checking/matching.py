"""Compares a node's answers with the solution's, and recognises systematic errors: a factor, a sign, a delay."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from grader.checking.comparator import difference, equal, shown
from grader.scenario.times import SECOND

if TYPE_CHECKING:
    from grader.checking.run import Exchange, Message, Run
    from grader.recording.recording import Received


#: Fields that say when a message was sent, and nothing about its content.
_STAMPS = ("header", "stamp")

#: This many answers must have something in common before a finding says something about all of them.


#: An answer within this time (s) counts as immediate: an asyncio loop may look for messages every millisecond.
AT_ONCE = 0.01

_NEXT_MESSAGE = " Your node answers each message only when the next one arrives: every answer is one message late."
_TIMER = (
    " Your node answers only after the clock has moved on, as a timer does. Publish in the callback that gets the "
    "message."
)


def how_late(run: Run, exchange: Exchange) -> str:
    """When the answer that was expected to this exchange's message came, such as "0.45 s later"; empty if it did not.

    An answer counts as this one if it says the same, and if it is not the right answer to the message it came after.
    """
    wanted = exchange.expected[0]._fields
    for received in run.recording.received:
        if received.after > exchange.number and same(received.fields, wanted) and not _is_in_time(run, received):
            return _delay(run, exchange, received.at, received.after)
    return ""


def is_late(exchange: Exchange, answer: Message, within: float) -> bool:
    """Whether an answer came after the next message, or more than `within` s after its own."""
    return answer.after > exchange.number or answer.at - exchange.sent.at > within + 1e-9


def delay(run: Run, exchange: Exchange, answer: Message) -> str:
    """How late an answer is, such as "one message late" or "0.45 s later"."""
    return _delay(run, exchange, answer.at_ns, answer.after)


def in_general(run: Run) -> str:
    """What all late answers have in common, as sentences that begin with a space; empty if nothing."""
    pairs = [(exchange, answer) for exchange in run.exchanges for answer in exchange.answers if exchange.expected]
    late = [(exchange, answer) for exchange, answer in pairs if is_late(exchange, answer, AT_ONCE)]
    if len(late) < FEWEST or len(late) < len(pairs):
        return ""
    if all(answer.after == exchange.number + 1 and _with_next(run, exchange, answer) for exchange, answer in late):
        return _NEXT_MESSAGE
    if all(answer.after == exchange.number and _with_next(run, exchange, answer) for exchange, answer in late[:-1]):
        return _TIMER
    seconds = [answer.at - exchange.sent.at for exchange, answer in late]
    if max(seconds) - min(seconds) <= 0.02 * max(seconds):
        return f" Every answer comes {_shown(max(seconds))} after its message."
    return (
        f" Your node's answers come {_shown(min(seconds))} to {_shown(max(seconds))} after their messages, as from a "
        "timer, or from a thread that polls."
    )


def _with_next(run: Run, exchange: Exchange, answer: Message) -> bool:
    """Whether an answer came at the simulated time of the next message."""
    sent = run.recording.sent
    return exchange.number < len(sent) and answer.at_ns == sent[exchange.number].at


def same(got: Any, expected: Any) -> bool:
    """Whether two messages say the same, or two parts of them; stamps do not count."""
    return equal(_timeless(got), _timeless(expected))


def _timeless(value: Any) -> Any:
    if isinstance(value, dict):
        return {name: _timeless(part) for name, part in value.items() if name not in _STAMPS}
    return [_timeless(part) for part in value] if isinstance(value, list) else value


def _is_in_time(run: Run, received: Received) -> bool:
    """Whether a message is the right answer to the message that it came after."""
    expected = run.exchanges[received.after - 1].expected
    return bool(expected) and same(received.fields, expected[0]._fields)


def _delay(run: Run, exchange: Exchange, at: int, after: int) -> str:
    late = after - exchange.number
    if late and at == run.recording.sent[after - 1].at:
        return "one message late" if late == 1 else f"{late} messages late"
    return f"{_shown((at - run.recording.sent[exchange.number - 1].at) / SECOND)} later"


def _shown(seconds: float) -> str:
    return f"{seconds:.2f} s" if seconds >= 0.01 else f"{seconds * 1000:.1f} ms"


def is_one_late(run: Run) -> bool:
    """Whether every answer is the right one to the message before."""
    pairs = [
        (before.expected[0]._fields, exchange.expected[0]._fields, exchange.answers[0]._fields)
        for before, exchange in zip(run.exchanges, run.exchanges[1:], strict=False)
        if before.expected and exchange.expected and exchange.answers
    ]
    telling = [(former, got) for former, expected, got in pairs if not same(former, expected)]
    return len(telling) >= FEWEST and all(same(got, former) for former, got in telling)


#: What a speed is multiplied with when its time is measured with the computer's clock: see `grader.runner.ends`.
COMPUTER_CLOCK = 0.8

#: A value this close to 0 says nothing about a ratio.
SMALLEST = 1e-3

#: This many values must have something in common before a finding says something about all of them.
FEWEST = 3

#: Units that are often confused: the expected unit, the unit that was sent, and the factor between them.
UNITS = (
    ("rad", "degrees", 180 / math.pi),
    ("deg", "radians", math.pi / 180),
    ("m", "millimetres", 1e3),
    ("m", "centimetres", 1e2),
    ("m", "kilometres", 1e-3),
    ("s", "milliseconds", 1e3),
    ("s", "microseconds", 1e6),
    ("s", "nanoseconds", 1e9),
)


def pattern(run: Run, field: str, per: str = "", unit: str = "") -> str:
    """A sentence about what all values of `field` have in common, beginning with a space; empty if nothing.

    `per` names the list of names that `field` goes with; without it, `field` is one number.
    """
    if is_one_late(run):
        return " Every answer is one message late: it is the right answer to the message before."
    if copied := _copied(run, field, per):
        return f" Every {field} is the {copied} of the message that arrived, unchanged."
    pairs: list[tuple[float, float]] = []
    elapsed: list[float] = []
    for before, exchange in zip([None, *run.exchanges], run.exchanges, strict=False):
        if exchange.expected and exchange.answers:
            expected, got = _values(exchange.expected[0], field, per), _values(exchange.answers[0], field, per)
            pairs += [(expected[name], got[name]) for name in expected if name in got]
            elapsed += [_elapsed(before, exchange) for name in expected if name in got]
    if text := _fixed_step(pairs, elapsed, field, unit):
        return text
    return common(pairs, field, unit, clock=run.recording.synchronization == "lockstep")


def _elapsed(before: Exchange | None, exchange: Exchange) -> float:
    """Seconds between the stamps of two messages; of messages without a stamp, between their arrivals."""
    if before is None:
        return 0.0
    if "header" in exchange.sent._fields:
        return exchange.sent.stamp - before.sent.stamp
    return exchange.sent.at - before.sent.at


def _fixed_step(pairs: list[tuple[float, float]], elapsed: list[float], field: str, unit: str) -> str:
    """Whether every rate was computed with one time step, whatever time had gone by."""
    if not unit.endswith("/s"):
        return ""
    steps = [
        dt * expected / got
        for (expected, got), dt in zip(pairs, elapsed, strict=True)
        if dt > 0 and abs(expected) > SMALLEST and math.isfinite(expected) and math.isfinite(got) and got
    ]
    if len(steps) < FEWEST or not all(math.isclose(step, steps[0], rel_tol=1e-3) for step in steps) or steps[0] <= 0:
        return ""
    if math.isclose(steps[0], 1.0, rel_tol=1e-3):
        return f" Every {field} is the change between two messages, not divided by the time between them."
    if max(elapsed) - min(elapsed) < 1e-3:
        return ""  # any factor looks like another time step
    return f" Every {field} would be right if {steps[0]:.4g} s had passed between the two messages."


def common(pairs: Sequence[tuple[float, float]], field: str, unit: str = "", clock: bool = False) -> str:
    """What all pairs of an expected value and a value that was got have in common, as `pattern` says it.

    `unit` is the unit that is asked for. With `clock`, a factor of 0.8 or 1.25 is attributed to the computer's clock.
    """
    telling = [(e, g) for e, g in pairs if abs(e) > SMALLEST and math.isfinite(e) and math.isfinite(g)]
    if len(telling) < FEWEST:
        return ""
    if len({got for _, got in telling}) == 1:
        return f" Every {field} is {telling[0][1]:.6g}."
    ratio = telling[0][1] / telling[0][0]
    if all(math.isclose(g, ratio * e, rel_tol=1e-3, abs_tol=1e-9) for e, g in telling):
        return _ratio(ratio, field, unit, clock)
    offset = telling[0][1] - telling[0][0]
    if all(math.isclose(g - e, offset, rel_tol=1e-3, abs_tol=1e-9) for e, g in telling):
        return f" Every {field} is {abs(offset):.4g} too {'large' if offset > 0 else 'small'}."
    return ""


def _ratio(ratio: float, field: str, unit: str, clock: bool) -> str:
    if math.isclose(ratio, 1, rel_tol=1e-3):
        return ""
    if math.isclose(ratio, -1, rel_tol=1e-3):
        return " Every value has the wrong sign."
    for asked, given, factor in UNITS:
        if math.isclose(ratio, factor, rel_tol=1e-3) and (unit.split("/")[0] == asked or (not unit and asked == "rad")):
            return f" Every {field} is in {given}."
    text = f" Every {field} is {ratio:.4g} times what it should be"
    if clock and any(math.isclose(ratio, factor, rel_tol=1e-3) for factor in (COMPUTER_CLOCK, 1 / COMPUTER_CLOCK)):
        return f"{text}: your node measures time with the computer's clock, which runs at another speed here."
    return f"{text}."


def _copied(run: Run, field: str, per: str) -> str:
    """The field of the messages that arrived which every answer repeats; empty if none."""
    answered = [exchange for exchange in run.exchanges if exchange.expected and exchange.answers]
    fields = answered[0].sent._fields if answered else {}
    return next((name for name in fields if name != per and _is_copied(answered, field, per, name)), "")


def _is_copied(answered: list[Exchange], field: str, per: str, name: str) -> bool:
    pairs = []
    for exchange in answered:
        if per and per not in exchange.sent._fields:
            return False
        sent, got = _values(exchange.sent, name, per), _values(exchange.answers[0], field, per)
        pairs += [(sent[key], got[key]) for key in got if key in sent]
    several = len({got for _, got in pairs}) > 1
    return several and all(math.isclose(a, b, rel_tol=1e-9, abs_tol=1e-12) for a, b in pairs)


def _values(message: Message, field: str, per: str) -> dict[str, float]:
    """The numbers in a field, by name."""
    value = message.value(field)
    if isinstance(value, list):
        names = message.value(per) if per else [str(i) for i in range(len(value))]
        values = dict(zip(names, value, strict=False))
    else:
        values = {"": value}
    return {name: one for name, one in values.items() if isinstance(one, (int, float))}


#: A value that takes more characters than this is not shown as a whole, but only where it differs.
LONGEST = 80


def must_match(run: Run, field: str, per: str, tolerance: float, missing_ok: bool) -> None:
    """See `Run.must_match`."""
    unit = _unit(run, field)
    for exchange in run.exchanges:
        if exchange.expected and (exchange.answers or not missing_ok):
            got = _answer(run, exchange)
            if per:
                _compare_each(run, exchange, got, field, per, unit, tolerance)
            else:
                _compare(run, exchange, got, field, unit, tolerance)


def _unit(run: Run, field: str) -> str:
    return next((topic.units[field] for topic in run.exercise.outputs if field in topic.units), "")


def must_answer(run: Run) -> None:
    """See `Run.must_answer`."""
    for exchange in run.exchanges:
        if exchange.expected:
            _answer(run, exchange)
            if len(exchange.answers) > 1:
                count = len(exchange.answers)
                run.wrong(exchange, f"one answer was expected, got {count}.", expected="1", got=str(count))


def must_answer_at_once(run: Run, within: float) -> None:
    """See `Run.must_answer_at_once`."""
    for exchange in run.exchanges:
        for answer in exchange.answers if exchange.expected else ():
            if is_late(exchange, answer, within):
                late = delay(run, exchange, answer)
                text = f"an answer was expected at once; it arrived {late}.{in_general(run)}"
                run.wrong(exchange, text, "", "an answer at once", late)


def must_vary(run: Run, field: str, per: str) -> None:
    """See `Run.must_vary`."""
    expected, got = _series(run, field, per, reference=True), _series(run, field, per, reference=False)
    varying = {name: values for name, values in expected.items() if len(set(values)) > 1}
    if not varying:
        return
    given = [value for values in got.values() for value in values]
    if not given:
        run.wrong(run.exchanges[-1], f"no {field} was published at all.", "", f"a {field} that changes", "none")
    if any(len(set(values)) > 1 for values in got.values()):
        return
    alike = len(set(given)) == 1
    constant, name = (
        shown(given[0], _unit(run, field)),
        next((name for name in got if name in varying and not alike), ""),
    )
    text = f"every {field} is {constant}" if alike else f"{field} is {constant} in every message"
    expected_, got_ = f"a {field} that changes", f"{constant} throughout"
    run.wrong(run.exchanges[-1], f"{text}, whatever was sent.", name, expected_, got_)


def _series(run: Run, field: str, per: str, reference: bool) -> dict[str, list[Any]]:
    """Every value of `field`, by name, in the order of the messages."""
    found: dict[str, list[Any]] = {}
    for exchange in run.exchanges:
        for message in exchange.expected if reference else exchange.answers:
            values = message.by(per, field) if per else {"": message.value(field)}
            for name, value in values.items():
                found.setdefault(str(name), []).append(value)
    return found


def must_be_silent(exchanges: list[Exchange], run: Run) -> None:
    """See `Run.must_be_silent`."""
    for exchange in exchanges:
        if exchange.answers and not exchange.expected:
            run.wrong(
                exchange, "no answer was expected, but your node published a message.", "", "nothing", "a message"
            )


def _answer(run: Run, exchange: Exchange) -> Message:
    if not exchange.answers:
        late, general = how_late(run, exchange), in_general(run)
        text = f"an answer was expected at once; it arrived {late}." if late else "an answer was expected, got none."
        text += general or _never(run)
        if not exchange.sent.heard and run.subscriptions(exchange.sent.topic):
            text += _unmatched(run, exchange.sent.topic) or (
                f" Your node did not subscribe to {exchange.sent.topic} yet: create the subscription in __init__."
            )
        run.wrong(exchange, text, "", "a message", late or "nothing")
    return exchange.answers[0]


def _unmatched(run: Run, topic: str) -> str:
    """Say so if no message arrived because a subscription asks for more than the topic's publisher offers."""
    declared = next((one for one in run.exercise.inputs if one.name == topic), None)
    if declared is None or any(sent.heard for sent in run.sent if sent.topic == topic):
        return ""
    for end in run.subscriptions(topic):
        for more, name in (("transient_local", "durability"), ("reliable", "reliability")):
            asked, offered = getattr(end, name), getattr(declared, name)
            if asked == more != offered:
                text = f" Your subscription on {topic} is {asked}, but the publisher is {offered}"
                return f"{text}: the two do not match, and no message arrives."
    return ""


def _never(run: Run) -> str:
    answered = sum(bool(exchange.answers) for exchange in run.exchanges)
    return "" if answered or len(run.sent) == 1 else " Your node never answers in this scenario."


def _compare(run: Run, exchange: Exchange, answer: Message, field: str, unit: str, tolerance: float) -> None:
    got, expected = answer.value(field), exchange.expected[0].value(field)
    found = difference(got, expected, tolerance)
    if not found:
        return
    place = field
    if found.path and len(shown(expected)) > LONGEST:
        place += found.path if found.path.startswith("[") else f".{found.path}"
        got, expected = found.got, found.expected
    wanted, came = shown(expected, unit), shown(got, unit)
    text = f"expected {place} {wanted}, got {came}.{pattern(run, field, unit=unit)}"
    run.wrong(exchange, text, "", wanted, came)


def _compare_each(
    run: Run, exchange: Exchange, answer: Message, field: str, per: str, unit: str, tolerance: float
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
            text = f"expected {field} {shown(value, unit)}, got {shown(got[name], unit)}."
            run.wrong(exchange, text + pattern(run, field, per, unit), name, shown(value, unit), shown(got[name], unit))
    for name, value in got.items():
        if name not in expected:
            text = f"no {field} was expected, got {shown(value, unit)}."
            run.wrong(exchange, text, str(name), "nothing", shown(value, unit))
