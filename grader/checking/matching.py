"""Compares what a node answered with what the solution answered, and says what differs."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

from grader.checking.lateness import how_late
from grader.checking.pattern import pattern

if TYPE_CHECKING:
    from grader.checking.run import Exchange, Message, Run


def must_match(run: Run, field: str, per: str, tolerance: float, missing_ok: bool) -> None:
    """See `Run.must_match`."""
    unit = next((topic.units[field] for topic in run.exercise.outputs if field in topic.units), "")
    for exchange in run.exchanges:
        if exchange.expected and (exchange.answers or not missing_ok):
            got = _answer(run, exchange)
            if per:
                _compare_each(run, exchange, got, field, per, unit, tolerance)
            elif not close(got.value(field), exchange.expected[0].value(field), tolerance):
                _differs(run, exchange, field, exchange.expected[0].value(field), got.value(field), unit)


def must_answer(run: Run) -> None:
    """See `Run.must_answer`."""
    for exchange in run.exchanges:
        if exchange.expected:
            _answer(run, exchange)
            if len(exchange.answers) > 1:
                count = len(exchange.answers)
                run.wrong(exchange, f"one answer was expected, {count} came.", expected="1", got=str(count))


def must_be_silent(exchanges: list[Exchange], run: Run) -> None:
    """See `Run.must_be_silent`."""
    for exchange in exchanges:
        if exchange.answers and not exchange.expected:
            answer = exchange.answers[0]
            shown = ", ".join(f"{name} {value:g}" for name, value in list(_numbers(answer).items())[:3])
            shown = f" ({shown} …)" if shown else ""
            run.wrong(exchange, f"nothing was to be published, but a message came{shown}.", "", "nothing", "a message")


def close(got: Any, expected: Any, tolerance: float) -> bool:
    """Whether two values are the same; numbers, and numbers in lists, within `tolerance`."""
    if isinstance(expected, list):
        return (
            isinstance(got, list)
            and len(got) == len(expected)
            and all(close(g, e, tolerance) for g, e in zip(got, expected, strict=True))
        )
    if isinstance(expected, (int, float)) and isinstance(got, (int, float)):
        if math.isnan(expected) or math.isnan(got):
            return math.isnan(expected) and math.isnan(got)
        return math.isclose(got, expected, rel_tol=tolerance, abs_tol=tolerance)
    return bool(got == expected)


def _answer(run: Run, exchange: Exchange) -> Message:
    if not exchange.answers:
        late = how_late(run, exchange)
        told = f"an answer was expected at once; it came {late}." if late else "an answer was expected, none came."
        if not exchange.sent.heard and run.subscriptions(exchange.sent.topic):
            told += f" Your node did not subscribe to {exchange.sent.topic} yet: create the subscription in __init__."
        run.wrong(exchange, told, "", "a message", late or "nothing")
    return exchange.answers[0]


def _compare_each(
    run: Run, exchange: Exchange, answer: Message, field: str, per: str, unit: str, tolerance: float
) -> None:
    names, values = answer.value(per), answer.value(field)
    if len(names) != len(values):
        told = f"{per} and {field} were expected to have one length; {len(names)} and {len(values)} came."
        run.wrong(exchange, told, "", f"{len(names)}", f"{len(values)}")
    expected, got = exchange.expected[0].by(per, field), answer.by(per, field)
    for name, value in expected.items():
        if name not in got:
            run.wrong(exchange, f"a {field} was expected, but the message does not name it.", name, _shown(value), "")
        if not close(got[name], value, tolerance):
            told = f"expected {field} {_shown(value, unit)}, got {_shown(got[name], unit)}."
            run.wrong(exchange, told + pattern(run, field, per), name, _shown(value, unit), _shown(got[name], unit))
    for name, value in got.items():
        if name not in expected:
            told = f"no {field} was expected, got {_shown(value, unit)}."
            run.wrong(exchange, told, str(name), "nothing", _shown(value, unit))


def _differs(run: Run, exchange: Exchange, field: str, expected: Any, got: Any, unit: str) -> None:
    wanted, came = _shown(expected, unit), _shown(got, unit)
    run.wrong(exchange, f"expected {field} {wanted}, got {came}.{pattern(run, field)}", "", wanted, came)


def _shown(value: Any, unit: str = "") -> str:
    if isinstance(value, float):
        return f"{value:.6g}{f' {unit}' if unit else ''}"
    if isinstance(value, dict) and set(value) == {"sec", "nanosec"}:
        return f"{value['sec']}.{value['nanosec']:09d}"
    if isinstance(value, list):
        text = ", ".join(_shown(item) for item in value[:8]) + (" …" if len(value) > 8 else "")
        return f"[{text}]"
    text = repr(value) if isinstance(value, str) else str(value)
    return text if len(text) < 200 else f"{text[:200]}…"


def _numbers(message: Message) -> dict[str, float]:
    try:
        values = message.by("name", "velocity")
    except KeyError:
        return {}
    return {str(name): value for name, value in values.items() if isinstance(value, float)}
