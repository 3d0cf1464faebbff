"""An answer that is missing often came after all, only later. Says when."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

from grader.scenario.scenario import SECOND

if TYPE_CHECKING:
    from grader.checking.run import Exchange, Run
    from grader.recording import Received

#: How near two numbers have to be to count as one, absolute or relative.
TOLERANCE = 1e-6

#: Which fields say when a message was sent, and nothing of what it says.
_STAMPS = ("header", "stamp")


def how_late(run: Run, exchange: Exchange) -> str:
    """When the answer that was expected to this exchange's message came, such as "0.45 s later"; empty if it did not.

    An answer counts as this one if it says the same, and if it is not the right answer to the message it came after.
    """
    wanted = exchange.expected[0]._fields
    for received in run.recording.received:
        if received.after > exchange.number and same(received.fields, wanted) and not _is_in_time(run, received):
            return _told(run, exchange, received)
    return ""


def same(got: Any, expected: Any) -> bool:
    """Whether two messages say the same, or two parts of them; stamps do not count."""
    if isinstance(expected, dict):
        return isinstance(got, dict) and all(
            same(got.get(name), value) for name, value in expected.items() if name not in _STAMPS
        )
    if isinstance(expected, list):
        return (
            isinstance(got, list)
            and len(got) == len(expected)
            and all(same(one, other) for one, other in zip(got, expected, strict=True))
        )
    if isinstance(expected, float) and isinstance(got, float):
        return math.isclose(got, expected, rel_tol=TOLERANCE, abs_tol=TOLERANCE) or (
            got != got and expected != expected
        )
    return bool(got == expected)


def _is_in_time(run: Run, received: Received) -> bool:
    """Whether a message is the right answer to the message that it came after."""
    expected = run.exchanges[received.after - 1].expected
    return bool(expected) and same(received.fields, expected[0]._fields)


def _told(run: Run, exchange: Exchange, received: Received) -> str:
    late = received.after - exchange.number
    if received.at == run.recording.sent[received.after - 1].at:
        return "one message late" if late == 1 else f"{late} messages late"
    seconds = (received.at - run.recording.sent[exchange.number - 1].at) / SECOND
    return f"{seconds:.2f} s later" if seconds >= 0.01 else f"{seconds * 1000:.1f} ms later"


def is_one_late(run: Run) -> bool:
    """Whether every answer is the right one to the message before."""
    pairs = [
        (before.expected[0]._fields, exchange.expected[0]._fields, exchange.answers[0]._fields)
        for before, exchange in zip(run.exchanges, run.exchanges[1:], strict=False)
        if before.expected and exchange.expected and exchange.answers
    ]
    telling = [(former, got) for former, expected, got in pairs if not same(former, expected)]
    return len(telling) >= 3 and all(same(got, former) for former, got in telling)
