"""What the helpers for publishers say: rate, gaps, stamps, series, late subscribers."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import pytest
from made_up import EMPTY, ENDS, STAMPED, finding, ns, published, run, says

from grader.checking.patterns import always, common
from grader.recording import ReceivedMessage, Recording
from grader.scenario.scenario import SECOND

TIMES = [i / 10 for i in range(1, 51)]
VALUES = [float(i * i) for i in range(1, 51)]
RIGHT = published(TIMES, VALUES)
TIMES_OF_4_HZ = [i / 4 for i in range(21)]
SILENT = published([], [])


def stamped(*stamps: float) -> Recording:
    """Return a recording with one message every 0.1 s, with these stamps (s of simulated time)."""
    fields = [{"header": {"stamp": {"sec": int(s), "nanosec": round(s % 1 * SECOND)}}} for s in stamps]
    return replace(
        EMPTY, received=tuple(ReceivedMessage(ns(i / 10), 0, "/out", STAMPED, f) for i, f in enumerate(fields))
    )


def test_a_right_publisher_passes_everything() -> None:
    mine = run(RIGHT)
    mine.must_publish()
    mine.must_publish(count=50)
    mine.must_keep_rate(10.0)
    mine.must_have_no_gap(0.1, end=5.0)
    mine.must_match_series("data", time=0.0)
    mine.must_match_series()
    run(stamped(100.0, 100.1, 100.2)).must_stamp()


def test_a_node_that_never_publishes() -> None:
    message = "In “as usual”: your node has a publisher on /out, but never published anything."
    for check in (
        lambda: run(SILENT, RIGHT).must_publish(),
        lambda: run(SILENT, RIGHT).must_match_series("data"),
        lambda: run(SILENT, RIGHT).must_keep_rate(10.0),
    ):
        assert says(check) == message
    other = replace(SILENT, end_points=(replace(ENDS[1], topic="/outt"),))
    assert says(lambda: run(other, RIGHT).must_publish()).endswith(
        "your node does not publish on /out. It publishes on: /outt."
    )


@pytest.mark.parametrize(
    ("period", "message"),
    [
        (0.2, "expected 10 messages per second on /out, got 5."),
        (0.08, "got 12.5. Either its period is wrong, or your node waits by the computer's clock (time.sleep"),
        (10.0, "got 0.1. It publishes every 10 s: a timer takes the period in seconds, not the rate."),
    ],
)
def test_another_rate(period: float, message: str) -> None:
    times = [period * i for i in range(20)]
    assert message in says(lambda: run(published(times, times), RIGHT).must_keep_rate(10.0))


def test_the_first_gap_of_a_timer_that_was_created_before_the_clock_started_does_not_count() -> None:
    """A timer of 0.252 s fires when the clock starts at 100 s, and then at the multiples of its period."""
    period = 0.252
    times = [0.0, *(period * i - 100 for i in range(397, 420))]
    message = says(lambda: run(published(times, times), RIGHT).must_keep_rate(10.0))
    assert "expected 10 messages per second on /out, got 3.968." in message
    run(published(times, times)).must_keep_rate(1 / period, tolerance=0.001)


def test_a_message_too_many_at_the_start_counts() -> None:
    assert "got 4.2." in says(lambda: run(published([0.0, *TIMES_OF_4_HZ], [0.0] * 22), RIGHT).must_keep_rate(4.0))


def test_the_rate_of_two_messages_is_reported_by_the_gap_between_them() -> None:
    assert "got 2." in says(lambda: run(published([0.1, 0.6], [1.0, 2.0]), RIGHT).must_keep_rate(10.0))


def test_a_publisher_that_stops() -> None:
    mine = run(published(TIMES[:20], VALUES[:20]), RIGHT)
    assert says(lambda: mine.must_keep_rate(10.0)) == (
        "At 2.00 s (as usual): your node published nothing on /out after that, but must continue."
    )


def test_a_gap_is_reported_with_its_beginning() -> None:
    mine = run(published([*TIMES[:10], *TIMES[14:]], [*VALUES[:10], *VALUES[14:]]), RIGHT)
    assert says(lambda: mine.must_have_no_gap(0.15)) == (
        "At 1.00 s (as usual): nothing was published on /out for 0.50 s, from 1.00 s on. "
        "Does a callback wait or sleep meanwhile?"
    )
    mine.must_have_no_gap(0.15, start=1.5, end=5.0)
    assert "for 0.60 s" in says(lambda: mine.must_have_no_gap(0.15, start=4.5, end=5.6))


@pytest.mark.parametrize(
    ("stamps", "message"),
    [
        ((100.0, 100.1, 100.15), "message 3 on /out: expected header.stamp 100.200000000, the time when it was publ"),
        (
            (0.0, 0.0, 0.0),
            "got 0.000000000. Every stamp is 0: your node does not fill it in, or it takes",
        ),
        ((0.0, 100.1, 100.2), "Only the first stamp is 0"),
        ((1.7e9, 1.7e9 + 1, 1.7e9 + 2), "Every stamp is the computer's time. Take the time from the node's clock"),
        ((99.0, 99.0, 99.0), "Every stamp is the same."),
        ((99.75, 99.85, 99.95), "Every stamp is 0.25 s too early."),
        ((0.0, 0.1, 0.2), "sec is 0 in every stamp."),
        ((100.0, 100.0001, 100.0002), "Every nanosec is in microseconds."),
    ],
)
def test_stamps(stamps: tuple[float, ...], message: str) -> None:
    assert message in says(lambda: run(stamped(*stamps)).must_stamp())


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda v: v + (5.0 if v == 9.0 else 0.0), "message 3 on /out: expected data 9 m, got 14 m."),
        (lambda v: v + (4.4e-6 if v == 4.0 else 0.0), "expected data 4 m, got 4.0000044 m."),
        (lambda v: -v, "expected data 1 m, got -1 m. Every value has the wrong sign."),
        (lambda v: 1000 * v, "Every data is in millimetres."),
        (lambda v: 3 * v, "Every data is 3 times what it should be."),
        (lambda v: v + 7, "Every data is 7 too large."),
        (lambda v: 4.0, "Every data is 4."),
    ],
)
def test_a_series_with_other_values(change: Callable[[float], float], message: str) -> None:
    mine = published(TIMES, [change(value) for value in VALUES])
    assert message in says(lambda: run(mine, RIGHT).must_match_series("data"))


def test_a_sign_that_is_lost_is_named() -> None:
    right, wrong = ([(-1.0, 1.0), (2.0, 2.0), (-3.0, last)] for last in (3.0, -3.0))
    assert common(right, "speed").seen == "No speed is negative: the sign is lost."
    assert not common(wrong, "speed")


def test_values_that_are_rounded_are_named() -> None:
    exact = (0.1267, -1.7849, 2.5011)
    for rounded, what in ((lambda v: round(v, 2), "rounded to 2 decimals"), (int, "a whole number"), (abs, "")):
        cause = common([(value, float(rounded(value))) for value in exact], "speed")
        assert cause.seen == (f"Every speed is {what}." if what else "No speed is negative: the sign is lost.")


def test_a_text_that_never_changes_is_named() -> None:
    assert always([("on", "off"), ("off", "off"), ("on", "off")], "message").seen == "message is 'off' every time."
    for right in (
        [("off", "off")] * 3,
        [("on", "on"), ("off", "off"), ("on", "off")],
        [("on", ""), ("off", ""), ("", "")],
    ):
        assert not always(right, "message")


def test_a_value_at_its_limit_is_not_said_to_be_constant() -> None:
    assert not common([(1.0, 1.0), (0.9, 1.0), (1.0, 1.0)], "speed")
    assert common([(1.0, 1.0), (0.9, 1.0), (0.8, 1.0)], "speed").seen == "Every speed is 1."


def test_one_value_in_degrees_is_named_and_one_factor_of_another_kind_is_not() -> None:
    assert common([(-0.0314, -1.79909)], "offset", "rad").seen == "Every offset is in degrees."
    assert not common([(0.5, 1.0)], "offset", "rad")


def test_a_series_that_is_one_message_late_or_early() -> None:
    late, early = published(TIMES, [0.0, *VALUES[:-1]]), published(TIMES, [*VALUES[1:], 0.0])
    assert says(lambda: run(late, RIGHT).must_match_series("data")).endswith("Every message is one message late.")
    assert says(lambda: run(early, RIGHT).must_match_series("data")).endswith("Every message is one message early.")


def test_a_series_that_comes_too_late_or_ends_too_early() -> None:
    late = published([at + 0.45 for at in TIMES], VALUES)
    run(late, RIGHT).must_match_series("data")
    found = finding(lambda: run(late, RIGHT).must_match_series("data", time=0.05))
    assert found.text == (
        "At 0.55 s (as usual), message 1 on /out: it was expected at 0.10 s, but happened at 0.55 s. "
        "Every message comes 0.45 s too late."
    )
    assert (found.at, found.expected, found.got) == (0.55, "0.10 s", "0.55 s")
    short = published(TIMES[:40], VALUES[:40])
    assert "expected 50 messages on /out, got 40." in says(lambda: run(short, RIGHT).must_match_series("data"))
    stopped = published(TIMES[:30], VALUES[:30])
    message = says(lambda: run(stopped, RIGHT).must_match_series("data"))
    assert message.endswith(f"expected 50 messages on /out, got 30. The last one came at {TIMES[29]:.2f} s.")


def test_what_several_threads_publish_at_one_moment_may_come_in_any_order() -> None:
    right = published([1.0, 2.0, 2.0, 2.0, 3.0], [1.0, 2.0, 3.0, 4.0, 5.0])
    swapped = published([1.0, 2.0, 2.0, 2.0, 3.0], [1.0, 4.0, 2.0, 3.0, 5.0])
    threads = replace(swapped, received=tuple(replace(one, unordered=True) for one in swapped.received))
    run(threads, right).must_match_series("data", time=0.0)
    run(right, threads).must_match_series("data", time=0.0)
    assert "message 2 on /out: expected data 2 m, got 4 m." in says(
        lambda: run(swapped, right).must_match_series("data")
    )
    later = replace(threads, received=(*threads.received[:4], replace(threads.received[4], fields={"data": 2.0})))
    assert "message 5 on /out: expected data 5 m, got 2 m." in says(lambda: run(later, right).must_match_series("data"))


def test_a_message_as_soon_as_the_clock_begins_is_explained() -> None:
    right, at_once = published([1.2, 1.7], [1.0, 2.0]), published([0.0, 1.2], [7.0, 1.0])
    assert says(lambda: run(at_once, right).must_match_series("data")).endswith(
        "What is published at 0.00 s comes from the constructor, or from a timer that was created there: such a timer "
        "fires as soon as simulated time begins, whatever its period."
    )
    other = published([1.2, 1.7], [7.0, 1.0])
    assert "0.00 s" not in says(lambda: run(other, right).must_match_series("data"))


def test_a_late_subscriber_of_a_volatile_publisher_gets_nothing() -> None:
    wanted = replace(RIGHT, received=(*RIGHT.received, *published([2.0], [1.0], subscriber="late").received))
    run(wanted).must_match_series("data", subscriber="late")
    assert "the subscriber “late” got nothing on /out. Your publisher is volatile" in says(
        lambda: run(RIGHT, wanted).must_match_series("data", subscriber="late")
    )


def test_an_author_who_names_a_field_that_is_not_there_is_told_which_there_are() -> None:
    with pytest.raises(LookupError, match=r"there is no field `date`\. The fields are: data"):
        run(RIGHT).must_match_series("date")
