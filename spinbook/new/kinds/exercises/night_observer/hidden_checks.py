"""Checks that students may not read: the rest of `night_observer`. Every rule that they rely on is in task.md."""

from __future__ import annotations

from grader.checking import Run, check, fail

PHOTO = ["test_a_photo_of_what_succeeded"]
TURNS = ["test_one_goal_at_a_time"]


def _must_observe(run: Run, time: float = 0.1) -> None:
    """It must send the solution's goals, and publish what the solution publishes."""
    run.must_match_goals("theta")
    run.must_match_series("data", topic="/photo", time=time)
    run.must_match_series("data", topic="/missed", time=time)


@check(
    points=2,
    hint="Let stars wait in a queue. When a goal ends, send the next one.",
    depends=PHOTO,
    misconception="all goals at once",
    rule="The next goal is sent when the one before is done, and then at once.",
)
def test_one_goal_at_a_time(three_stars: Run) -> None:
    """It sends each goal when the one before is done, in the order of the stars."""
    _must_observe(three_stars)


@check(
    points=2,
    hint="Look at goal_handle.accepted before you ask for the result.",
    depends=TURNS,
    misconception="ignores accepted",
    rule="A goal that is rejected, aborted or canceled is a miss: publish the star on /missed.",
)
def test_a_goal_that_is_rejected(rejected: Run) -> None:
    """A star whose goal is rejected is missed, and the next one follows."""
    rejected.must_ask_only_for_accepted()
    _must_observe(rejected)


@check(
    points=1,
    hint="The result comes with a status: GoalStatus.STATUS_SUCCEEDED is one of several.",
    depends=TURNS,
    misconception="ignores the status",
    rule="A goal that is rejected, aborted or canceled is a miss: publish the star on /missed.",
)
def test_a_goal_that_is_aborted(aborted: Run) -> None:
    """A star whose goal is aborted is missed, and the next one follows."""
    _must_observe(aborted)


@check(
    points=2,
    hint="The handle of the goal has cancel_goal_async().",
    depends=TURNS,
    rule="When a message on /clouds arrives while a goal is being served, ask the telescope to cancel that goal.",
)
def test_clouds_cancel_the_goal(cloudy: Run) -> None:
    """Clouds cancel the running goal, and the next star follows."""
    _must_observe(cloudy)


@check(
    points=1,
    hint="Only the result says how a goal ended.",
    depends=["test_clouds_cancel_the_goal"],
    rule="Whether the star is missed, only the goal's result says: the telescope may refuse.",
)
def test_a_telescope_that_refuses_to_cancel(stubborn: Run) -> None:
    """When the telescope refuses to cancel and the goal succeeds, the star is a photo."""
    _must_observe(stubborn)


@check(
    points=1,
    hint="When a goal is done, forget its handle.",
    depends=TURNS,
    rule="Without a goal, clouds change nothing.",
)
def test_clouds_without_a_goal(idle_clouds: Run) -> None:
    """Clouds change nothing while no goal is running."""
    _must_observe(idle_clouds)
    if any(goal.cancels for goal in idle_clouds.goals(by="node")):
        fail("Your node asked to cancel a goal that was done.", expected="no request", got="one")


@check(
    points=2,
    hint="A timer looks for the telescope: server_is_ready() says whether it is there.",
    depends=TURNS,
    misconception="waits for the server",
    rule="Stars wait for it.",
)
def test_a_telescope_that_appears_late(late: Run) -> None:
    """Stars wait for a telescope that appears late."""
    _must_observe(late, time=0.45)


@check(
    points=1,
    hint="A goal that has been sent and not yet accepted counts as a goal, too.",
    depends=TURNS,
    rule="The next goal is sent when the one before is done, and then at once.",
)
def test_a_telescope_that_accepts_late(slow: Run) -> None:
    """It waits for a telescope that accepts goals late."""
    _must_observe(slow)


@check(
    points=1,
    hint="Compare the names and the queue depths in __init__ with the task.",
    depends=PHOTO,
    rule="Its node is called night_observer.",
)
def test_node_is_as_described(one_star: Run, cloudy: Run) -> None:
    """The node has the name and the quality of service of the task."""
    for run in (one_star, cloudy):
        run.must_be_as_declared()
