"""The harder scenarios of `go_to_goal`. Every rule that they rely on is in task.md."""

from __future__ import annotations

import itertools
import math

from grader.checking import Run, check, fail

POSE, COMMANDS = "/turtle1/pose", "/turtle1/cmd_vel"
#: What shows that it works at all, and what shows that it steers.
DRIVES, COMES_CLOSER = ["test_drives"], ["test_comes_closer"]
CARRIED, AGAIN = 11.0, 12.5  # s after the start: somebody carries the turtle away, and publishes the same goal again

#: The goal counts as reached here (m). Whether the turtle gets within 0.1 m is judged by the checks of reaching alone.
NEAR = 0.5


def must_come_near(run: Run, x: float, y: float, start: float, within: float = 10.0) -> None:
    """Fail unless the turtle gets near this place in time."""
    run.must_reach(POSE, {"x": x, "y": y}, tolerance=NEAR, within=within, start=start, stay=False)


@check(
    points=6,
    hint="Without a goal, return at once.",
    todo="Set self.goal = None in __init__, and let on_pose return at once as long as it is None. A Point() "
    "that nobody has filled in has x = y = 0.0: as a goal it is the lower left corner, and the turtle "
    "drives there. Nor may an attribute of the class or a default argument have a place in it.",
    depends=DRIVES,
    misconception="a goal from the beginning",
    rule="no_goal",
)
def test_stands_still_without_a_goal(no_goal: Run) -> None:
    """Until the first goal, it sends no command other than zeros."""
    for command in no_goal.messages_on(COMMANDS):
        if any(command.fields["linear"].values()) or any(command.fields["angular"].values()):
            text = "there is no goal yet, but your node drives."
            no_goal.wrong_at(command.at, text, "", "nothing, or zeros", "a command to move")


@check(
    points=6,
    hint="Bring the difference of the two angles back to between -pi and pi: atan2(sin(d), cos(d)) does that.",
    todo="atan2 gives an angle between -pi and pi, and so does theta. Their difference may be anything between "
    "-2 pi and 2 pi: from 3.0 to -3.0 it is -6.0, nearly a whole turn to the right, where 0.28 to the "
    "left would do. Bring the difference back, not the two angles: subtract first, then take "
    "atan2(sin(difference), cos(difference)), or add or subtract 2 pi while it is outside.",
    depends=COMES_CLOSER,
    misconception="angle not wrapped",
    rule="shorter_way",
)
def test_turns_the_shorter_way(short_way: Run) -> None:
    """It turns the shorter way, even if that crosses 180 degrees."""
    headings = [(at, theta) for at, (theta,) in short_way.trajectory(POSE, "theta") if at < CARRIED]
    turns = [abs(math.remainder(b - a, math.tau)) for (_, a), (_, b) in itertools.pairwise(headings)]
    turned = sum(turns)
    if not 0.4 <= turned <= math.pi:
        far = (
            at for (at, _), so_far in zip(headings[1:], itertools.accumulate(turns), strict=True) if so_far > math.pi
        )
        text = f"the goal is 0.83 rad to the left, but the turtle turned by {turned:.2f} rad."
        short_way.wrong_at(next(far, None), text, "", "at most half a turn", f"{turned:.2f} rad")


@check(
    points=6,
    hint="Steer by the pose, until the turtle is there.",
    todo="Go through on_pose with a goal exactly behind the turtle: the angle is near pi, so the turtle has to "
    "turn on the spot first. Is the angle wrapped, and does the turn go on in one direction, or does its "
    "sign change with each pose? Then it needs enough speed: 10 s for up to 10 m. A speed that is "
    "proportional to the distance alone may become very small near the goal; is it inside 0.1 m when you "
    "stop?",
    depends=COMES_CLOSER,
    rule="reach",
)
def test_reaches_a_goal_behind(behind: Run) -> None:
    """It reaches a goal that is behind the turtle."""
    behind.must_reach(POSE, {"x": 9.8, "y": 9.8}, tolerance=0.1, within=10.0, start=0.5, stay=False)


@check(
    points=5,
    hint="Let the speed depend on the distance.",
    todo="With 2 m/s the turtle moves by more than 3 cm between two poses, and it obeys the last command until "
    "the next one comes. Make linear.x depend on the distance, such as min(distance, 2.0) or twice the "
    "distance, so that it is slow when it gets there. Driving and turning at once makes curves: drive "
    "ahead only while the angle to the goal is small, for example with a factor of cos(angle) that is "
    "never negative.",
    depends=COMES_CLOSER,
    rule="not_past",
)
def test_does_not_go_past_the_goal(ahead: Run) -> None:
    """The turtle goes at most 0.2 m beyond the goal."""
    place = {"x": 8.5, "y": 7.0}
    ahead.must_reach(POSE, place, tolerance=NEAR, within=10.5, overshoot=0.2, start=0.5, stay=False)


@check(
    points=4,
    hint="Does your node do the same for the second goal as for the first?",
    todo="After the first goal, which attributes still have a value from it? A flag such as self.done must "
    "become false again in on_goal, or the second goal is never driven to. Simplest is one attribute: "
    "self.goal, which on_goal sets and which becomes None at the goal. Do not end the program, destroy "
    "the subscription or stop the timer at the first goal.",
    depends=COMES_CLOSER,
    rule=("stop", "newest", "reach"),
)
def test_reaches_the_next_goal(next_goal: Run) -> None:
    """After one goal it drives to the next."""
    must_come_near(next_goal, 3.0, 6.0, start=4.0)


@check(
    points=5,
    hint="on_goal replaces the goal, whatever the turtle does.",
    todo="on_goal should only replace self.goal, with no condition before it. Then on_pose uses the new goal "
    "with the very next pose. If your node computes something once per goal, such as a direction, a start "
    "or a state (turn, then drive), compute it again in on_goal. A loop in on_goal that drives until the "
    "turtle is there keeps the next goal waiting.",
    depends=COMES_CLOSER,
    misconception="sticks to the first goal",
    rule=("newest", "reach"),
)
def test_takes_a_new_goal_on_its_way(new_goal: Run) -> None:
    """A new goal replaces the one to which the turtle is on its way, at once."""
    must_come_near(new_goal, 3.0, 3.0, start=2.0)
    ways = [(at, math.dist(point, (10.0, 5.5))) for at, point in new_goal.trajectory(POSE, "x", "y") if at > 2.0]
    for at, distance in ways:
        if distance < ways[0][1] / 2:
            text = f"there is another goal since 2 s, but the turtle drove on to the old one, up to {distance:.2f} m."
            new_goal.wrong_at(at, text, "", "the new goal", "the old one")


@check(
    points=3,
    hint="Every message on /goal is a new goal, whatever it says.",
    depends=COMES_CLOSER,
    rule=("newest", "reach"),
)
def test_same_goal_again(short_way: Run) -> None:
    """A goal that is the same as the last one is a goal like any other."""
    must_come_near(short_way, 3.0, 4.0, start=AGAIN)


@check(
    points=4,
    hint="Close to the goal, after the command of zeros, set self.goal to None.",
    todo="The turtle may be carried away after it was at the goal. If your node still compares each pose with "
    "the old goal, it drives back. When the turtle is there, publish the zeros, and set self.goal to "
    "None: on_pose then returns at once until on_goal gets another one. A flag does it, too, if on_goal "
    "resets it.",
    depends=COMES_CLOSER,
    misconception="a goal is never done",
    rule="done",
)
def test_forgets_a_goal_that_was_reached(short_way: Run) -> None:
    """When the turtle is carried away from a goal that it has reached, it does not drive back."""
    way = [point for at, point in short_way.trajectory(POSE, "x", "y") if CARRIED + 0.05 < at < AGAIN]
    if (driven := max(math.dist(point, way[0]) for point in way)) > 0.01:
        text = f"somebody carried the turtle away from the goal at {CARRIED:g} s, and it drove {driven:.2f} m."
        short_way.wrong_at(None, text, "", "a turtle that stays there", f"{driven:.2f} m")


@check(
    points=3,
    hint="Compare with the newest pose for each command.",
    depends=COMES_CLOSER,
    misconception="drives blind",
    rule=("newest_pose", "reach"),
)
def test_turtle_that_is_pushed(pushed: Run) -> None:
    """When the turtle is pushed aside on its way, it still gets to the goal."""
    must_come_near(pushed, 9.0, 4.0, start=0.5)


@check(
    points=3,
    hint="Publish one command in on_pose, and do nothing that takes long in any callback.",
    depends=DRIVES,
    rule=("steering", "clock"),
)
def test_keeps_steering(new_goal: Run) -> None:
    """Until the turtle is there, a command comes at least every 0.2 s, and at most one for each pose."""
    way = new_goal.trajectory(POSE, "x", "y")
    reached = next((at for at, point in way if at > 2.0 and math.dist(point, (3.0, 3.0)) <= NEAR), way[-1][0])
    new_goal.must_have_no_gap(0.2, COMMANDS, start=0.5, end=reached)
    poses = sum(0.5 <= at <= reached for at, _ in way)
    count = sum(0.5 <= at <= reached for at, _ in new_goal.trajectory(COMMANDS, "linear.x"))
    if count > poses + 1:
        text = f"there were {count} commands for {poses} poses until the turtle was there."
        new_goal.wrong_at(None, text, "", "at most one command for each pose", f"{count} commands")


@check(
    points=2,
    hint="Turn on the spot as long as the goal is behind the turtle.",
    depends=COMES_CLOSER,
    rule="not_away",
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
    depends=COMES_CLOSER,
    rule="slow_down",
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
    points=2,
    hint="Only turtlesim publishes poses.",
    depends=DRIVES,
    rule="other_topics",
)
def test_leaves_other_topics_alone(ahead: Run) -> None:
    """It publishes on /turtle1/cmd_vel only: nothing on /turtle1/pose, nothing on /goal."""
    ahead.must_publish_on_no_others()


@check(
    points=1,
    hint="Create the publisher and both subscriptions in __init__, each with a plain 10.",
    depends=DRIVES,
    rule="queue",
)
def test_quality_of_service(ahead: Run, no_goal: Run) -> None:
    """There is one publisher and one subscription to each topic, reliable and volatile, with a depth of 10."""
    for run in (ahead, no_goal):
        run.must_have_qos(depth=True)
        for kind, topic in (("publisher", COMMANDS), ("subscription", POSE), ("subscription", "/goal")):
            if (count := len(run.end_points(kind, topic))) != 1:
                fail(f"The number of {kind}s of {topic} is wrong.", expected=1, got=count)
