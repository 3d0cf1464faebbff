"""The harder scenarios of `go_to_goal`. Every rule that they rely on is in task.md."""

from __future__ import annotations

import itertools
import math

from grader.checking import Run, check, fail

POSE, COMMANDS = "/turtle1/pose", "/turtle1/cmd_vel"
DRIVES = ["test_drives"]
REACHES = ["test_reaches_the_goal"]


@check(
    points=8,
    hint="Without a goal, return at once.",
    depends=DRIVES,
    misconception="a goal from the beginning",
    rule="Before the first message on /goal, publish nothing, or zeros.",
)
def test_stands_still_without_a_goal(no_goal: Run) -> None:
    """Until the first goal it sends no command but zeros."""
    for command in no_goal.messages_on(COMMANDS):
        if any(command.fields["linear"].values()) or any(command.fields["angular"].values()):
            told = "there is no goal yet, but your node drives."
            no_goal.wrong_at(command.at, told, "", "nothing, or zeros", "a command to move")


@check(
    points=10,
    hint="Bring the difference of the two angles back to between -pi and pi: atan2(sin(d), cos(d)) does.",
    depends=REACHES,
    misconception="angle not wrapped",
    rule="what matters is the difference of two angles, brought back to between −π and π.",
)
def test_turns_the_shorter_way(short_way: Run) -> None:
    """It turns the shorter way, also where that goes past 180 degrees."""
    headings = [theta for _, (theta,) in short_way.trajectory(POSE, "theta")]
    turned = sum(abs(math.remainder(b - a, math.tau)) for a, b in itertools.pairwise(headings))
    if turned > math.pi:
        told = f"the goal is 0.83 rad to the left, but the turtle turned by {turned:.2f} rad."
        short_way.wrong_at(None, told, "", "at most half a turn", f"{turned:.2f} rad")


@check(
    points=8,
    hint="Steer by the pose, until the turtle is there.",
    depends=REACHES,
    rule="10 s after a goal was published, the turtle is within 0.1 m of it, wherever it was before.",
)
def test_reaches_a_goal_behind(behind: Run) -> None:
    """It reaches a goal that is behind the turtle."""
    behind.must_reach(POSE, {"x": 9.8, "y": 9.8}, tolerance=0.1, within=10.0, start=0.5, stay=False)


@check(
    points=6,
    hint="Let the speed depend on the distance.",
    depends=REACHES,
    rule="The turtle goes at most 0.2 m beyond the goal, and never drives in circles around it.",
)
def test_does_not_go_past_the_goal(ahead: Run) -> None:
    """The turtle goes at most 0.2 m beyond the goal."""
    ahead.must_reach(POSE, {"x": 8.5, "y": 7.0}, tolerance=0.1, within=10.0, overshoot=0.2, start=0.5, stay=False)


@check(
    points=6,
    hint="Wait for the next goal when one is reached.",
    depends=REACHES,
    rule="From then on the turtle stands still, until there is another goal.",
)
def test_reaches_the_next_goal(next_goal: Run) -> None:
    """After one goal it reaches the next."""
    next_goal.must_reach(POSE, {"x": 3.0, "y": 6.0}, tolerance=0.1, within=10.0, start=4.0, stay=False)


@check(
    points=8,
    hint="on_goal replaces the goal, whatever the turtle does.",
    depends=REACHES,
    misconception="sticks to the first goal",
    rule="The newest goal counts, even if the turtle is still on its way to another one.",
)
def test_takes_a_new_goal_on_its_way(new_goal: Run) -> None:
    """A new goal replaces the one to which the turtle is on its way."""
    new_goal.must_reach(POSE, {"x": 3.0, "y": 3.0}, tolerance=0.1, within=10.0, start=2.0, stay=False)


@check(
    points=4,
    hint="Only turtlesim publishes poses.",
    depends=DRIVES,
    rule="Publish nothing on /turtle1/pose and nothing on /goal.",
)
def test_leaves_other_topics_alone(ahead: Run) -> None:
    """It publishes on /turtle1/cmd_vel only: nothing on /turtle1/pose, nothing on /goal."""
    if others := sorted({end.topic for end in ahead.end_points("publisher")} - {COMMANDS}):
        fail("Your node publishes on other topics, too.", expected="none", got=", ".join(others))


@check(
    points=2,
    hint="Give create_publisher and create_subscription a plain 10.",
    depends=DRIVES,
    rule="Use a queue depth of 10 for all of them, as the chapter does.",
)
def test_quality_of_service(ahead: Run) -> None:
    """All ends are reliable and volatile, as a queue depth alone makes them."""
    ahead.must_have_qos()
