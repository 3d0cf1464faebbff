"""Checks that students may not read: the rest of `fire_watch`. Every rule that they rely on is in task.md."""

from __future__ import annotations

from grader.checking import Run, check

CALLS = ["test_one_call_for_each_change", "test_siren_goes_on"]
REPORTS = [*CALLS, "test_reports_the_answer"]


@check(
    points=1,
    hint="More than 0.3 is a fire.",
    depends=CALLS,
    rule="Smoke of 0.3 or less is none, and at the start there is none.",
)
def test_smoke_at_the_edge(edges: Run) -> None:
    """Smoke of 0.3 is not a fire, and a little more is one."""
    edges.must_match_requests("data")
    edges.must_match_series("data", topic="/siren")


@check(
    points=2,
    hint="The response has success and message.",
    depends=REPORTS,
    misconception="ignores success",
    rule="If it is false: failed:, a space and the response's message.",
)
def test_reports_a_refusal(refused: Run) -> None:
    """It reports that the sprinkler failed, and why."""
    refused.must_match_series("data", topic="/report", time=0.1)


@check(
    points=2,
    hint="Handle an answer in the done-callback.",
    depends=REPORTS,
    rule="A sprinkler that answers late or never does not hold anything up",
)
def test_a_sprinkler_that_is_slow(slow: Run) -> None:
    """While the sprinkler is slow, the siren continues, and the report is published when the answer arrives."""
    slow.must_match_series("data", topic="/siren", time=0.05)
    slow.must_match_series("data", topic="/report", time=0.1)


@check(
    points=1,
    hint="Pass what you asked for to the done-callback.",
    depends=REPORTS,
    rule="a new change is asked for at once, even if the response to the last one is still missing.",
)
def test_a_change_before_the_answer(overtaken: Run) -> None:
    """A change before the answer is asked for at once, and each answer is reported correctly."""
    overtaken.must_match_requests("data")
    overtaken.must_match_series("data", topic="/report", time=0.1)


@check(
    points=1,
    hint="Nothing may depend on an answer that never comes.",
    depends=REPORTS,
    rule="A sprinkler that answers late or never does not hold anything up",
)
def test_a_sprinkler_that_never_answers(silent: Run) -> None:
    """A sprinkler that never answers is asked again at the next change, and nothing is reported."""
    silent.must_match_requests("data")
    silent.must_match_series("data", topic="/siren", time=0.05)
    silent.must_match_series("data", topic="/report")


@check(
    points=1,
    hint="service_is_ready() does not wait. Call it in the timer's callback, too.",
    depends=REPORTS,
    misconception="forgets or waits for a late server",
    rule="is asked as soon as the siren's timer next finds it there, if it is still to change then.",
)
def test_a_sprinkler_that_appears_late(late: Run, too_late: Run) -> None:
    """A sprinkler that appears late is asked then, if a change is still needed, and the siren never stops."""
    late.must_match_requests("data")
    late.must_match_series("data", topic="/siren", time=0.05)
    late.must_match_series("data", topic="/report", time=0.25)
    too_late.must_match_requests("data")


@check(
    points=1,
    hint="Compare the names and the queue depths in __init__ with the task.",
    depends=["test_calls_the_sprinkler"],
    rule="Its node is called fire_watch.",
)
def test_node_is_as_described(fire: Run) -> None:
    """The node has the name and the quality of service of the task."""
    fire.must_be_as_declared()
