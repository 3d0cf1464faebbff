"""The harder scenarios of `go_to_goal`. Every rule that they rely on is in task.md."""

from __future__ import annotations

import itertools
import math

from grader.checking import Run, check, fail

POSE, COMMANDS = "/turtle1/pose", "/turtle1/cmd_vel"
DRIVES = ["test_drives"]
REACHES = ["test_reaches_the_goal"]
CARRIED = 11.0  # s after the start: somebody carries the turtle away


@check(
    points=6,
    hint="Without a goal, return at once.",
    depends=DRIVES,
    misconception="a goal from the beginning",
    rule="Before the first message on /goal, publish nothing, or zeros.",
)
def test_stands_still_without_a_goal(no_goal: Run) -> None:
    """Until the first goal, it sends no command other than zeros."""
    for command in no_goal.messages_on(COMMANDS):
        if any(command.fields["linear"].values()) or any(command.fields["angular"].values()):
            text = "there is no goal yet, but your node drives."
            no_goal.wrong_at(command.at, text, "", "nothing, or zeros", "a command to move")


@check(
    points=8,
    hint="Bring the difference of the two angles back to between -pi and pi: atan2(sin(d), cos(d)) does that.",
    depends=REACHES,
    misconception="angle not wrapped",
    rule="what matters is the difference of two angles, brought back to between −π and π.",
)
def test_turns_the_shorter_way(short_way: Run) -> None:
    """It turns the shorter way, even if that crosses 180 degrees."""
    headings = [theta for at, (theta,) in short_way.trajectory(POSE, "theta") if at < CARRIED]
    turned = sum(abs(math.remainder(b - a, math.tau)) for a, b in itertools.pairwise(headings))
    if turned > math.pi:
        text = f"the goal is 0.83 rad to the left, but the turtle turned by {turned:.2f} rad."
        short_way.wrong_at(None, text, "", "at most half a turn", f"{turned:.2f} rad")


@check(
    points=6,
    hint="Steer by the pose, until the turtle is there.",
    depends=REACHES,
    rule="10 s after a goal was published, the turtle is within 0.1 m of it, wherever it was before.",
)
def test_reaches_a_goal_behind(behind: Run) -> None:
    """It reaches a goal that is behind the turtle."""
    behind.must_reach(POSE, {"x": 9.8, "y": 9.8}, tolerance=0.1, within=10.0, start=0.5, stay=False)


@check(
    points=5,
    hint="Let the speed depend on the distance.",
    depends=REACHES,
    rule="The turtle goes at most 0.2 m beyond the goal, and never drives in circles around it.",
)
def test_does_not_go_past_the_goal(ahead: Run) -> None:
    """The turtle goes at most 0.2 m beyond the goal."""
    ahead.must_reach(POSE, {"x": 8.5, "y": 7.0}, tolerance=0.1, within=10.0, overshoot=0.2, start=0.5, stay=False)


@check(
    points=5,
    hint="Wait for the next goal when one is reached.",
    depends=REACHES,
    rule="From then on the turtle stands still, until there is another goal.",
)
def test_reaches_the_next_goal(next_goal: Run) -> None:
    """After one goal it reaches the next."""
    next_goal.must_reach(POSE, {"x": 3.0, "y": 6.0}, tolerance=0.1, within=10.0, start=4.0, stay=False)


@check(
    points=5,
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
    hint="Close to the goal, after the command of zeros, set self.goal to None.",
    depends=[*REACHES, "test_stops_at_the_goal"],
    misconception="a goal is never done",
    rule="if somebody carries the turtle away afterwards, it stays where it was put.",
)
def test_forgets_a_goal_that_was_reached(short_way: Run) -> None:
    """When the turtle is carried away from a goal that it has reached, it does not drive back."""
    way = [point for at, point in short_way.trajectory(POSE, "x", "y") if at > CARRIED + 0.05]
    if (driven := max(math.dist(point, way[0]) for point in way)) > 0.01:
        text = f"somebody carried the turtle away from the goal at {CARRIED:g} s, and it drove {driven:.2f} m."
        short_way.wrong_at(None, text, "", "a turtle that stays there", f"{driven:.2f} m")


@check(
    points=3,
    hint="Publish one command in on_pose, and do nothing that takes long in any callback.",
    depends=["test_takes_a_new_goal_on_its_way"],
    rule="publish a command at least every 0.2 s, and at most one for each pose.",
)
def test_keeps_steering(new_goal: Run) -> None:
    """Until the turtle is there, a command comes at least every 0.2 s, and at most one for each pose."""
    way = new_goal.trajectory(POSE, "x", "y")
    reached = next((at for at, point in way if at > 2.0 and math.dist(point, (3.0, 3.0)) <= 0.1), way[-1][0])
    new_goal.must_have_no_gap(0.2, COMMANDS, start=0.5, end=reached)
    if (count := len(new_goal.messages_on(COMMANDS))) > len(way):
        text = f"there were {count} commands for {len(way)} poses."
        new_goal.wrong_at(None, text, "", "at most one command for each pose", f"{count} commands")


@check(
    points=2,
    hint="Turn on the spot as long as the goal is behind the turtle.",
    depends=["test_reaches_a_goal_behind"],
    rule="the turtle never gets more than 0.3 m farther from the goal than it was when the goal was published.",
)
def test_turns_before_it_drives(behind: Run) -> None:
    """With the goal behind it, the turtle does not drive away from it first."""
    distances = [math.dist(point, (9.8, 9.8)) for at, point in behind.trajectory(POSE, "x", "y") if at >= 0.5]
    if (farther := max(distances) - distances[0]) > 0.3:
        text = f"the turtle first drives away from the goal, by {farther:.2f} m."
        behind.wrong_at(None, text, "", "at most 0.3 m", f"{farther:.2f} m")


@check(
    points=2,
    hint="Let the speed depend on the distance.",
    depends=["test_does_not_go_past_the_goal"],
    rule="within 0.3 m of it, linear.x is at most 0.8 m/s.",
)
def test_slows_down(ahead: Run) -> None:
    """Within 0.3 m of the goal, linear.x is at most 0.8 m/s."""
    way = ahead.trajectory(POSE, "x", "y")
    close = next((at for at, point in way if math.dist(point, (8.5, 7.0)) <= 0.3), way[-1][0])
    for at, (speed,) in ahead.trajectory(COMMANDS, "linear.x"):
        if at > close + 0.06 and abs(speed) > 0.8 + 1e-6:
            text = f"within 0.3 m of the goal since {close:.2f} s, it drives at {speed:.3g} m/s at {at:.2f} s."
            ahead.wrong_at(None, text, "", "at most 0.8 m/s", f"{speed:.3g} m/s")


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
    hint="Create the publisher and both subscriptions in __init__, each with a plain 10.",
    depends=DRIVES,
    rule="Create each of the three once, with a queue depth of 10, as the chapter does.",
)
def test_quality_of_service(ahead: Run, no_goal: Run) -> None:
    """There is one publisher and one subscription to each topic, reliable and volatile as a queue depth makes them."""
    for run in (ahead, no_goal):
        run.must_have_qos()
        for kind, topic in (("publisher", COMMANDS), ("subscription", POSE), ("subscription", "/goal")):
            if (count := len(run.end_points(kind, topic))) != 1:
                fail(f"The number of {kind}s of {topic} is wrong.", expected=1, got=count)
