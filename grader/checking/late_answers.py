"""Late answers: how late each one is, and what all of them have in common."""

from __future__ import annotations

from functools import lru_cache
from typing import Any

from grader.checking.cause import UNKNOWN, Cause
from grader.checking.comparator import equal
from grader.checking.hint_texts import hints
from grader.checking.message import Exchange, Message
from grader.checking.patterns import FEWEST, ORDER
from grader.checking.recorded_run import RecordedRun
from grader.recording.recording import ReceivedMessage
from grader.scenario.times import SECOND

#: Fields that say when a message was sent, and nothing about its content.
_STAMPS = ("header", "stamp")

#: An answer within this time (s) counts as immediate: an asyncio loop may poll for messages every millisecond.
AT_ONCE = 0.01

_IN_CALLBACK = hints("in_callback")
_NEXT_MESSAGE = Cause(
    "Your node answers each message only when the next one arrives: every answer is one message late.", *ORDER
)
_TIMER = Cause(
    "Your node answers only after the clock has moved on, as a timer does. Publish in the callback that gets the "
    "message.",
    *_IN_CALLBACK,
)


def how_late(run: RecordedRun, exchange: Exchange) -> str:
    """Return when the expected answer to this exchange's message came, such as "0.45 s later"; empty if it never came.

    An answer counts as this one if it has the same content, and if it is not the right answer to the message before it.
    """
    expected = exchange.expected[0]._fields
    for received in run.recording.received:
        if received.after > exchange.number and same(received.fields, expected) and not _is_in_time(run, received):
            return _delay(run, exchange, received.at_ns, received.after)
    return ""


def is_late(exchange: Exchange, answer: Message, within: float) -> bool:
    """Return whether an answer came after the next message, or more than `within` s after its own."""
    return answer.after > exchange.number or answer.at - exchange.sent.at > within + 1e-9


def delay(run: RecordedRun, exchange: Exchange, answer: Message) -> str:
    """Return how late an answer is, such as "one message late" or "0.45 s later"."""
    return _delay(run, exchange, answer.at_ns, answer.after)


@lru_cache(maxsize=8)  # every late answer needs it
def in_general(run: RecordedRun) -> Cause:
    """Return what all late answers have in common."""
    pairs = [(exchange, answer) for exchange in run.exchanges for answer in exchange.answers if exchange.expected]
    late = [(exchange, answer) for exchange, answer in pairs if is_late(exchange, answer, AT_ONCE)]
    if len(late) < FEWEST or len(late) < len(pairs):
        return UNKNOWN
    if all(answer.after == exchange.number + 1 and _with_next(run, exchange, answer) for exchange, answer in late):
        return _NEXT_MESSAGE
    if all(answer.after == exchange.number and _with_next(run, exchange, answer) for exchange, answer in late[:-1]):
        return _TIMER
    seconds = [answer.at - exchange.sent.at for exchange, answer in late]
    if max(seconds) - min(seconds) <= 0.02 * max(seconds):
        return Cause(f"Every answer comes {_shown(max(seconds))} after its message.", *_IN_CALLBACK)
    text = f"Your node's answers come {_shown(min(seconds))} to {_shown(max(seconds))} after their messages, as from a "
    return Cause(f"{text}timer, a thread that polls, or a callback that sleeps.", *_IN_CALLBACK)


def _with_next(run: RecordedRun, exchange: Exchange, answer: Message) -> bool:
    """Return whether an answer came at the simulated time of the next message."""
    sent = run.recording.sent
    return exchange.number < len(sent) and answer.at_ns == sent[exchange.number].at_ns


def same(got: Any, expected: Any) -> bool:
    """Return whether two messages, or two parts of messages, have the same content; stamps do not count."""
    return equal(_timeless(got), _timeless(expected))


def _timeless(value: Any) -> Any:
    if isinstance(value, dict):
        return {name: _timeless(part) for name, part in value.items() if name not in _STAMPS}
    return [_timeless(part) for part in value] if isinstance(value, list) else value


def _is_in_time(run: RecordedRun, received: ReceivedMessage) -> bool:
    """Return whether a message is the right answer to the message before it."""
    expected = run.exchanges[received.after - 1].expected
    return bool(expected) and same(received.fields, expected[0]._fields)


def _delay(run: RecordedRun, exchange: Exchange, at: int, after: int) -> str:
    late = after - exchange.number
    if late and at == run.recording.sent[after - 1].at_ns:
        return "one message late" if late == 1 else f"{late} messages late"
    return f"{_shown((at - run.recording.sent[exchange.number - 1].at_ns) / SECOND)} later"


def _shown(seconds: float) -> str:
    return f"{seconds:.2f} s" if seconds >= 0.01 else f"{seconds * 1000:.1f} ms"


def is_one_late(run: RecordedRun) -> bool:
    """Return whether every answer is the right one to the previous message."""
    pairs = [
        (before.expected[0]._fields, exchange.expected[0]._fields, exchange.answers[0]._fields)
        for before, exchange in zip(run.exchanges, run.exchanges[1:], strict=False)
        if before.expected and exchange.expected and exchange.answers
    ]
    telling = [(former, got) for former, expected, got in pairs if not same(former, expected)]
    return len(telling) >= FEWEST and all(same(got, former) for former, got in telling)
