"""What every student may read: the checks of `joint_operator`.

Each fixture is a scenario of scenarios.py; hidden_checks.py goes through the servers that misbehave.
"""

from __future__ import annotations

import itertools

from grader.checking import Run, check, fail

OUTCOMES, PROGRESS = "/outcomes", "/progress"


@check(points=10, hint="Call send_goal_async() in the callback of /targets, with the target as the goal's position.")
def test_sends_a_goal(succeeds: Run) -> None:
    """It sends a goal for /move_joint with the position that it received on /targets."""
    succeeds.must_have_interface()
    succeeds.must_match_goals("position")


@check(
    points=10,
    hint="Ask for the result when the goal has been accepted, and check its status.",
    depends=[test_sends_a_goal],
)
def test_publishes_the_outcome(succeeds: Run) -> None:
    """When the goal has succeeded, it publishes succeeded on /outcomes."""
    succeeds.must_match_series("data", OUTCOMES, time=0.25)


@check(
    points=8,
    hint="Give send_goal_async() a feedback callback.",
    depends=[test_sends_a_goal],
)
def test_publishes_progress(succeeds: Run) -> None:
    """It publishes each feedback on /progress."""
    succeeds.must_match_series("data", PROGRESS, time=0.06)


@check(
    points=8,
    hint="Keep targets in a list, and take the first one out when you send it.",
    depends=[test_publishes_the_outcome],
    misconception="loses targets",
)
def test_every_target_in_order(several: Run) -> None:
    """Each of several targets becomes a goal, in the order in which they arrived."""
    several.must_match_goals("position")


@check(
    points=8,
    hint="Remember that a goal is under way, until it has ended.",
    depends=[test_every_target_in_order],
    misconception="several goals at once",
)
def test_one_goal_at_a_time(several: Run) -> None:
    """It sends the next goal when the one before has ended, not earlier and not much later."""
    goals = several.goals(by="node")
    for before, goal in itertools.pairwise(goals):
        wait = (goal.at - (before.finished or goal.at + 1)) / 1_000_000_000
        if not 0.0 <= wait <= 0.25:
            text = f"goal {goal.number} was expected when goal {before.number} had ended, "
            text += "got it before that." if wait < 0 else f"got it {wait:.2f} s later."
            several.wrong_at(goal.at, text, "", "one goal at a time", "before the end" if wait < 0 else f"{wait:.2f} s")


@check(points=3, hint="super().__init__('joint_operator')", depends=[test_sends_a_goal])
def test_node_is_called_joint_operator(succeeds: Run) -> None:
    """There is one node, it is called joint_operator, and it publishes on no other topics."""
    succeeds.must_have_nodes()
    declared = {topic.name for topic in succeeds.exercise.outputs}
    if others := sorted({end.topic for end in succeeds.end_points("publisher")} - declared):
        fail("Your node publishes on other topics, too.", expected="none", got=", ".join(others))


@check(
    points=3,
    hint="Catch KeyboardInterrupt and ExternalShutdownException around rclpy.spin, then call rclpy.try_shutdown().",
    depends=[test_sends_a_goal],
)
def test_ends_on_ctrl_c(succeeds: Run) -> None:
    """On Ctrl-C it ends within 2 s, with no traceback."""
    succeeds.must_end_on_ctrl_c()
