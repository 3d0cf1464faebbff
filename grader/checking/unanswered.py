"""Why a message was not answered, as far as all the messages of the run show it."""

from __future__ import annotations

from grader.checking.cause import UNKNOWN, Cause
from grader.checking.hint_texts import hints
from grader.checking.message import Exchange
from grader.checking.patterns import FEWEST
from grader.checking.recorded_run import RecordedRun
from grader.recording.recording import Endpoint

_CONDITION = hints("condition")


def why_unanswered(run: RecordedRun, exchange: Exchange) -> Cause:
    """Return why the node did not answer this exchange's message."""
    return _not_connected(run, exchange) or _only_some(run) or _never(run)


def _not_connected(run: RecordedRun, exchange: Exchange) -> Cause:
    topic = exchange.sent.topic
    if exchange.sent.heard or not _subscriptions(run, topic):
        return UNKNOWN
    return _unmatched(run, topic) or Cause(
        f"Your node did not subscribe to {topic} yet: create the subscription in __init__."
    )


def _subscriptions(run: RecordedRun, topic: str) -> list[Endpoint]:
    return [end for end in run.recording.end_points if end.kind == "subscription" and end.topic == topic]


def _unmatched(run: RecordedRun, topic: str) -> Cause:
    """Explain that no message arrived because a subscription asks for more than the topic's publisher offers."""
    declared = next((declared for declared in run.exercise.inputs if declared.name == topic), None)
    if declared is None or any(sent.heard for sent in run.sent if sent.topic == topic):
        return UNKNOWN
    for end in _subscriptions(run, topic):
        for more, name in (("transient_local", "durability"), ("reliable", "reliability")):
            asked, offered = getattr(end, name), getattr(declared, name)
            if asked == more != offered:
                text = f"Your subscription on {topic} is {asked}, but the publisher is {offered}"
                return Cause(f"{text}: the two do not match, and no message arrives.")
    return UNKNOWN


def _only_some(run: RecordedRun) -> Cause:
    expected = [exchange for exchange in run.exchanges if exchange.expected]
    answered = [exchange for exchange in expected if exchange.answers]
    if not answered or len(expected) < FEWEST:
        return UNKNOWN
    text = f"Your node answers {len(answered)} of {len(expected)} messages"
    for answers, which in ((True, "those"), (False, "all but those")):
        if _only_when_seconds_change(run, answers):
            seen = f"{text}: {which} whose stamp has another sec than the message before."
            return Cause(seen, *hints("stamp_fields"))
    return Cause(f"{text}.", *_CONDITION)


def _only_when_seconds_change(run: RecordedRun, answers: bool) -> bool:
    """Return whether the messages with (or without) `answers` are those in whose stamp the seconds are new."""
    pairs = [
        (before.sent, exchange)
        for before, exchange in zip(run.exchanges, run.exchanges[1:], strict=False)
        if exchange.expected and "header" in exchange.sent._fields
    ]
    answered = [bool(exchange.answers) is answers for _, exchange in pairs]
    changed = [before.header.stamp.sec != exchange.sent.header.stamp.sec for before, exchange in pairs]
    return any(answered) and not all(answered) and answered == changed


def _never(run: RecordedRun) -> Cause:
    if any(exchange.answers for exchange in run.exchanges) or len(run.sent) == 1:
        return UNKNOWN
    return Cause("Your node never answers in this scenario.", *_CONDITION)
