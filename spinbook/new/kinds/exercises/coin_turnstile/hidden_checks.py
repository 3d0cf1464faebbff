"""Checks that students may not read: the rest of `coin_turnstile`. Every rule that they rely on is in task.md."""

from __future__ import annotations

from grader.checking import Run, check

SUCCESS = ["test_a_visitor_with_enough_gets_through"]
MESSAGE = ["test_a_visitor_with_less_is_told_what_is_missing"]


@check(
    points=2,
    hint="Take the price from the credit, and leave the rest.",
    depends=SUCCESS,
    misconception="keeps the change",
    rule="The visitor pays 100 cents; the rest of the credit stays for the next visitor.",
)
def test_change_stays_for_the_next_visitor(change: Run) -> None:
    """A visitor pays 100 cents, and the rest stays for the next visitor."""
    change.must_match_responses("success")


@check(
    points=1,
    hint="There are five coins, from 10 to 200 cents.",
    depends=MESSAGE,
    rule="A coin of 10, 20, 50, 100 or 200 cents adds its value to the credit.",
)
def test_every_coin_counts(all_coins: Run) -> None:
    """Each of the five coins adds its value to the credit."""
    all_coins.must_match_responses()


@check(
    points=3,
    hint="Compare the value with the coins that exist.",
    depends=MESSAGE,
    misconception="counts every value as a coin",
    rule="It falls through: the credit stays as it is.",
)
def test_what_is_no_coin_falls_through(not_coins: Run) -> None:
    """A value that is not a coin leaves the credit as it is."""
    not_coins.must_match_responses()


@check(
    points=1,
    hint="Each request is one visitor, however many come at one moment.",
    depends=SUCCESS,
    rule="Every push gets one response, at once, however many come and however quickly.",
)
def test_five_pushes_at_one_moment(crowd: Run) -> None:
    """Five pushes at the same moment get five responses, one after another."""
    crowd.must_match_responses("success")


@check(
    points=1,
    hint="Never sleep in a callback: nothing else runs meanwhile.",
    depends=["test_serves_push"],
    misconception="sleeps in a callback",
    rule="A response that arrives within 0.1 s arrives at once.",
)
def test_answers_at_once(visitors: Run) -> None:
    """Each response arrives at once."""
    visitors.must_respond(within=0.1)


@check(
    points=1,
    hint="Compare the names and the queue depths in __init__ with the task.",
    depends=["test_serves_push"],
    rule="Its node is called coin_turnstile.",
)
def test_node_is_as_described(visitors: Run) -> None:
    """The node has the name and the quality of service of the task."""
    visitors.must_be_as_declared()
