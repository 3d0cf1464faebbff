"""Compares what a node answered with what the solution answered, and says what differs."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from grader.checking.comparator import difference, equal
from grader.checking.lateness import delay, how_late, in_general, is_late
from grader.checking.pattern import pattern
from grader.checking.shown import shown

if TYPE_CHECKING:
    from grader.checking.run import Exchange, Message, Run

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
                told = f"an answer was expected at once; it came {late}.{in_general(run)}"
                run.wrong(exchange, told, "", "an answer at once", late)


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
    told = f"every {field} is {constant}" if alike else f"{field} is {constant} in every message"
    expected_, got_ = f"a {field} that changes", f"{constant} throughout"
    run.wrong(run.exchanges[-1], f"{told}, whatever was sent.", name, expected_, got_)


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
        told = f"an answer was expected at once; it came {late}." if late else "an answer was expected, got none."
        told += general or _never(run)
        if not exchange.sent.heard and run.subscriptions(exchange.sent.topic):
            told += f" Your node did not subscribe to {exchange.sent.topic} yet: create the subscription in __init__."
        run.wrong(exchange, told, "", "a message", late or "nothing")
    return exchange.answers[0]


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
    told = f"expected {place} {wanted}, got {came}.{pattern(run, field, unit=unit)}"
    run.wrong(exchange, told, "", wanted, came)


def _compare_each(
    run: Run, exchange: Exchange, answer: Message, field: str, per: str, unit: str, tolerance: float
) -> None:
    names, values = answer.value(per), answer.value(field)
    if len(names) != len(values):
        told = (
            f"{per} and {field} must have the same length; {per} has {len(names)} elements, {field} has {len(values)}."
        )
        run.wrong(exchange, told, "", f"{len(names)}", f"{len(values)}")
    expected, got = exchange.expected[0].by(per, field), answer.by(per, field)
    for name, value in expected.items():
        if name not in got:
            run.wrong(exchange, f"a {field} was expected, but your message does not name it.", name, shown(value), "")
        if not equal(got[name], value, tolerance):
            told = f"expected {field} {shown(value, unit)}, got {shown(got[name], unit)}."
            run.wrong(exchange, told + pattern(run, field, per, unit), name, shown(value, unit), shown(got[name], unit))
    for name, value in got.items():
        if name not in expected:
            told = f"no {field} was expected, got {shown(value, unit)}."
            run.wrong(exchange, told, str(name), "nothing", shown(value, unit))
