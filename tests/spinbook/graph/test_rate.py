"""The rate of a topic from some of its messages, by their numbers and time stamps."""

from __future__ import annotations

import random

import pytest

from spinbook.graph.watcher import MessageCounter, rounded

_MS = 1_000_000


def counted(*streams: tuple[int, float, int], lost: float = 0.0, jitter_ms: float = 0.0) -> float | None:
    """Return the rate of streams (first number, period in ms, how many), as received, some of them lost."""
    chance = random.Random(1)
    sent = [
        (int((n * period + chance.uniform(0, jitter_ms)) * _MS) + 17, first + n)
        for first, period, count in streams
        for n in range(count)
    ]
    rate = MessageCounter(len(streams))
    for when, number in sorted(sent):
        if chance.random() >= lost:
            rate.count(number, when)
    return rate.rate_hz()


def test_one_publisher_is_counted_by_its_time_stamps() -> None:
    assert counted((1, 100, 20)) == pytest.approx(10)


def test_lost_messages_are_counted_too() -> None:
    assert counted((40, 10, 200), lost=0.5) == pytest.approx(100, rel=0.02)


def test_two_publishers_are_told_apart_and_added() -> None:
    assert counted((1, 100, 20), (300, 50, 40)) == pytest.approx(30)


def test_two_publishers_that_number_alike_are_told_apart() -> None:
    assert counted((5, 200, 10), (7, 200, 10), jitter_ms=2) == pytest.approx(10, rel=0.02)


@pytest.mark.parametrize("streams", [[], [(1, 100, 1)], [(1, 100, 5)]])
def test_too_few_messages_tell_no_rate(streams: list[tuple[int, float, int]]) -> None:
    assert counted(*streams) is None


@pytest.mark.parametrize(
    ("measured", "shown"),
    [
        (9.99, 10), (10.01, 10), (9.94, 10), (10.3, 10), (62.4, 62.5), (62.9, 62.5), (0.499, 0.5), (30.4, 30),
        (99.1, 100), (14.9, 15), (1003.2, 1000), (17.3, 17), (0, 0), (33.33, 33), (4.9, 5),
    ],
)  # fmt: skip
def test_rates_of_the_same_timer_are_reported_alike(measured: float, shown: float) -> None:
    assert rounded(measured) == shown
