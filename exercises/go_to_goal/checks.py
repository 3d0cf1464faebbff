"""What every student may read: the checks of `go_to_goal`.

Each fixture is a scenario of scenarios.py; hidden_checks.py goes through the harder ones.
"""

from __future__ import annotations

import math

from grader.checking import Run, check

POSE, COMMANDS = "/turtle1/pose", "/turtle1/cmd_vel"


def distances_of(ahead: Run) -> list[float]:
    """Return how far the turtle is from the goal at each pose (m)."""
    return [math.dist(point, (8.5, 7.0)) for _, point in ahead.trajectory(POSE, "x", "y")]


def comes_closer(ahead: Run) -> bool:
    """Return whether the turtle leaves most of its way behind."""
    distances = distances_of(ahead)
    return min(distances) <= 0.4 * distances[0]


@check(
    points=3,
    hint="What does on_pose publish for each pose, once there is a goal?",
    todo="Two callbacks work together. on_goal keeps the goal in an attribute of the node. on_pose is called for "
    "each pose: with a goal, it makes a new Twist, fills in linear.x (how fast ahead) and angular.z (how fast "
    "it turns), and publishes it. Both numbers are floats. Log them for the first poses after a goal: are "
    "they other than zero?",
    rule=("pose", "goal", "command"),
)
def test_drives(ahead: Run) -> None:
    """It reads /goal and /turtle1/pose, and a goal makes it publish Twist messages on /turtle1/cmd_vel that move."""
    ahead.must_have_interface()
    ahead.must_publish(COMMANDS)
    moves = [at for at, command in ahead.trajectory(COMMANDS, "linear.x", "angular.z") if any(command)]
    if not moves:
        ahead.wrong_at(None, "linear.x and angular.z are 0 in every command.", "", "commands that move", "zeros")
    if moves[0] < 0.5 and not comes_closer(ahead):
        text = f"your node drives at {moves[0]:.2f} s, before the first goal, and not to the goal later."
        ahead.wrong_at(None, text, "", "a goal that makes it drive", "a node that drives anyway")


@check(
    points=7,
    hint="Do the numbers that on_pose publishes depend on the goal and on the pose?",
    todo="on_pose compares the pose with the goal. A command holds for one second, so the turtle stands still if "
    "no more come: publish one for each pose. Log linear.x and angular.z, with the pose, for the first poses "
    "after a goal. Does the turtle turn towards the goal, or away from it? A positive angular.z turns left, and "
    "atan2 takes the difference in y first.",
    depends=[test_drives],
    rule="reach",
)
def test_comes_closer(ahead: Run) -> None:
    """Its commands bring the turtle closer to the goal."""
    distances = distances_of(ahead)
    if not comes_closer(ahead):
        text = f"the goal was {distances[0]:.2f} m away, and the turtle never got closer than {min(distances):.2f} m."
        if (count := len(ahead.messages_on(COMMANDS))) < len(distances) / 50:
            text += f" Commands that your node published in 11 s: {count}. Each holds for 1 s only."
        way = [item for item in ahead.trajectory(POSE, "x", "y", "theta") if item[0] >= 0.5]
        turns = [(at, math.remainder(math.atan2(7.0 - y, 8.5 - x) - theta, math.tau)) for at, (x, y, theta) in way]
        cause = ahead.steers_away(COMMANDS, "angular.z", turns)
        fastest, (speed, _) = max(ahead.trajectory(COMMANDS, "linear.x", "angular.z"), key=lambda item: item[1][0])
        off = next((angle for at, angle in turns if at >= fastest), 0.0)
        if speed > 0.01 and abs(off) > 0.3:
            text += f" While it drives, the goal is {abs(off):.2f} rad to its {'left' if off > 0 else 'right'}."
        closest = ahead.trajectory(POSE, "x", "y")[distances.index(min(distances))][0]
        ahead.wrong_at(closest, text, "", "a turtle that comes closer to the goal", f"{min(distances):.2f} m", cause)


@check(
    points=16,
    hint="By which angle must the turtle turn to face the goal? Draw pose, goal and theta, and compare.",
    todo="The direction to the goal is atan2(goal.y - pose.y, goal.x - pose.x): y first, and the goal minus the "
    "pose. The turtle looks in the direction theta, so it must turn by the difference of the two, to the left "
    "if that is positive. Bring the difference back to between -pi and pi: without that, the turtle turns the "
    "long way round, or for ever. Drive ahead only while the goal is in front. The plot of your check shows "
    "the path: does it start in the right direction, does it circle, or does it end too early?",
    depends=[test_comes_closer],
    rule="reach",
)
def test_reaches_the_goal(ahead: Run) -> None:
    """10 s after the goal was published, the turtle is within 0.1 m of it."""
    ahead.must_reach(POSE, {"x": 8.5, "y": 7.0}, tolerance=0.1, within=10.0, start=0.5, stay=False)


@check(
    points=8,
    hint="A command holds for 1 s. Close to the goal, publish a Twist of zeros.",
    todo="turtlesim obeys each command for one second, so a turtle that gets no more commands still drives on "
    "for a while. When the distance to the goal is small enough, publish a new Twist() without setting "
    "anything: all its numbers are 0.0. Do it once, and then forget the goal, so that the turtle does not "
    "turn on the spot for ever: very close to the goal, the direction to it is chance.",
    depends=[test_comes_closer],
    misconception="never stops",
    rule="stop",
)
def test_stops_at_the_goal(ahead: Run) -> None:
    """At the goal the turtle gets a command of zeros, and stands still."""
    moment, last_command = ahead.trajectory(COMMANDS, "linear.x", "angular.z")[-1]
    if any(last_command):
        text = f"the last command came at {moment:.2f} s, and it is not all zeros."
        ahead.wrong_at(None, text, "", "a Twist of zeros", "linear.x {:.3g}, angular.z {:.3g}".format(*last_command))
    last = [point for at, point in ahead.trajectory(POSE, "x", "y", "theta") if at >= 10.5]
    if max(math.dist(point, last[0]) for point in last) > 0.01:
        ahead.wrong_at(None, "the turtle still moves at the goal.", "", "a turtle that stands still", "one that moves")


@check(
    points=8,
    hint="max(-2.0, min(value, 2.0)) keeps a value within limits.",
    todo="A speed that is proportional to the distance or to the angle is large when these are large: 10 m "
    "away with a factor of 1 is 10 m/s. Limit each number just before you publish it, in both directions: "
    "a turn to the right is negative, and -5 is too fast as well. Log the largest values that you "
    "publish. Limit after all factors and sums, not before.",
    depends=[test_comes_closer],
    misconception="too fast",
    rule="speed",
)
def test_not_too_fast(ahead: Run, behind: Run, new_goal: Run) -> None:
    """linear.x is between -2.0 and 2.0 m/s, angular.z between -2.0 and 2.0 rad/s."""
    for run in (ahead, behind, new_goal):
        for command in run.messages_on(COMMANDS):
            for part, axis, unit in (("linear", "x", "m/s"), ("angular", "z", "rad/s")):
                value = command.fields[part][axis]
                if not abs(value) <= 2.0 + 1e-6:
                    text = f"expected {part}.{axis} between -2 and 2 {unit}, got {value:.3g} {unit}."
                    run.wrong_at(command.at, text, "", f"at most 2 {unit}", f"{value:.3g} {unit}")


@check(points=3, hint="super().__init__('go_to_goal')", depends=[test_drives], rule="node")
def test_node_is_called_go_to_goal(ahead: Run) -> None:
    """There is one node, and it is called go_to_goal."""
    ahead.must_have_nodes()


@check(
    points=3,
    hint="Catch KeyboardInterrupt and ExternalShutdownException around rclpy.spin, then call rclpy.try_shutdown().",
    depends=[test_drives],
    rule="ctrl_c",
)
def test_ends_on_ctrl_c(ahead: Run) -> None:
    """On Ctrl-C it ends within 2 s, with no traceback."""
    ahead.must_end_on_ctrl_c()
