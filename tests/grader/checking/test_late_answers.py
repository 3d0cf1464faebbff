"""A late answer is reported as late, and one measured with the wrong clock as that: with made-up recordings."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from statistics import mean

import pytest

from grader.checking.run import Run
from grader.checking.verdict import Wrong
from grader.exercise import Exercise
from grader.exercise.exercise import Durability, Topic
from grader.recording import Ending, Endpoint, ReceivedMessage, Recording, SentMessage
from grader.scenario.scenario import SECOND, START

FLOAT = "std_msgs/msg/Float64"
EXERCISE = Exercise(
    "doubler", Path(), "", 10.0, "doubler.py", "Doubler", "doubler", "",
    (Topic("/in", FLOAT, "subscribe"), Topic("/out", FLOAT, "publish", units={"data": "m"})), None,
)  # fmt: skip
COUNT = 8


def recording(*received: ReceivedMessage) -> Recording:
    """Return a recording of messages 0.1 s apart, and their answers."""
    sent = tuple(SentMessage(START + i * SECOND // 10, "/in", FLOAT, {"data": float(i)}) for i in range(COUNT))
    return Recording("plain", sent, received, ("/doubler",), (), True, Ending("completed"))


def answer(number: int, value: float, later: float = 0.0) -> ReceivedMessage:
    """Return an answer to message `number`, counted from 1, that arrives `later` (s)."""
    at = START + (number - 1) * SECOND // 10 + round(later * SECOND)
    after = min(COUNT, 1 + (at - START) * 10 // SECOND)
    return ReceivedMessage(at, after, "/out", FLOAT, {"data": value})


def right(number: int) -> float:
    return float(number * number)


REFERENCE = recording(*(answer(n, right(n)) for n in range(1, COUNT + 1)))


def message(received: list[ReceivedMessage], check: Callable[[Run], None]) -> str:
    """Return what a check says about this."""
    with pytest.raises(Wrong) as caught:
        check(Run(EXERCISE, recording(*received), REFERENCE))
    return caught.value.finding.text


def matches(run: Run) -> None:
    run.must_match("data")


@pytest.mark.parametrize("check", [Run.must_answer, matches])
def test_an_answer_that_comes_later_is_reported_with_its_delay(check: Callable[[Run], None]) -> None:
    received = [answer(n, right(n), later=0.45) for n in range(1, 5)]
    assert "an answer was expected at once; it arrived 0.45 s later." in message(received, check)


def test_an_answer_that_comes_with_the_next_message_is_reported_as_one_message_late() -> None:
    received = [answer(n, right(n), later=0.1) for n in range(1, COUNT)]
    assert "Message 1 of 8" in message(received, Run.must_answer)
    assert "it arrived one message late." in message(received, Run.must_answer)


def test_where_each_answer_is_the_one_to_the_message_before_that_is_reported() -> None:
    received = [answer(1, 0.0), *(answer(n, right(n - 1)) for n in range(2, COUNT + 1))]
    assert "expected data 1 m, got 0 m. Every answer is one message late" in message(received, matches)


def test_an_answer_that_is_right_for_its_own_message_is_no_late_answer() -> None:
    same = recording(*(answer(n, 1.0) for n in range(1, COUNT + 1)))
    lacking = recording(*(answer(n, 1.0) for n in range(1, COUNT + 1) if n != 3))
    with pytest.raises(Wrong) as caught:
        Run(EXERCISE, lacking, same).must_answer()
    assert "Message 3 of 8" in caught.value.finding.text
    assert "got none" in caught.value.finding.text


@pytest.mark.parametrize("factor", [0.8, 1.25])
def test_a_measurement_by_the_computers_clock_is_reported_by_its_factor(factor: float) -> None:
    received = [answer(n, factor * right(n)) for n in range(1, COUNT + 1)]
    assert f"Every data is {factor:g} times what it should be: your node measures time with the computer's clock" in (
        message(received, matches)
    )


def test_another_factor_is_no_sign_of_a_clock() -> None:
    received = [answer(n, 3 * right(n)) for n in range(1, COUNT + 1)]
    assert message(received, matches).endswith("Every data is 3 times what it should be.")


@pytest.mark.parametrize(
    ("durability", "message"),
    [
        (
            "transient_local",
            "Your subscription on /in is transient_local, but the publisher is volatile: the two do not",
        ),
        ("volatile", "Your node did not subscribe to /in yet: create the subscription in __init__."),
    ],
)
def test_no_answer_at_all_is_explained_by_the_subscription(durability: Durability, message: str) -> None:
    silent = recording()
    end = Endpoint("/doubler", "subscription", "/in", FLOAT, "reliable", durability)
    unheard = replace(silent, sent=tuple(replace(one, heard=False) for one in silent.sent), end_points=(end,))
    with pytest.raises(Wrong) as caught:
        Run(EXERCISE, unheard, REFERENCE).must_match("data")
    assert message in caught.value.finding.text


@pytest.mark.parametrize(
    ("answered", "which"),
    [
        ((3, 6), "2 of 8 messages: those whose stamp has another sec than the message before."),
        ((1, 2, 4, 5, 7, 8), "6 of 8 messages: all but those whose stamp has another sec than the message before."),
        ((1, 2, 3, 4), "4 of 8 messages."),
    ],
)
def test_messages_that_lack_an_answer_are_told_by_the_seconds_of_their_stamps(
    answered: tuple[int, ...], which: str
) -> None:
    def stamped(run: Recording) -> Recording:
        stamps = [{"sec": (number + 1) // 3, "nanosec": 0} for number in range(COUNT)]
        sent = zip(run.sent, stamps, strict=True)
        return replace(run, sent=tuple(replace(one, fields={"header": {"stamp": stamp}}) for one, stamp in sent))

    mine = stamped(recording(*(answer(number, right(number)) for number in answered)))
    with pytest.raises(Wrong) as caught:
        Run(EXERCISE, mine, stamped(REFERENCE)).must_answer()
    assert caught.value.finding.cause == f"Your node answers {which}"


def test_a_rate_since_the_first_message_is_named() -> None:
    rates = replace(EXERCISE, topics=(EXERCISE.topics[0], replace(EXERCISE.topics[1], units={"data": "m/s"})))
    means = [mean(right(number) for number in range(2, last + 1)) for last in range(2, COUNT + 1)]
    mine = recording(answer(1, right(1)), *(answer(number, value) for number, value in enumerate(means, start=2)))
    with pytest.raises(Wrong) as caught:
        Run(rates, mine, REFERENCE).must_match("data")
    assert caught.value.finding.cause == "Every data is the change since the first message, and not since the last."
