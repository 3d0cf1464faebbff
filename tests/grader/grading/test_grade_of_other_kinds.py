"""`spinbook grade` for more than one node with topics: several programs, arguments, goals at once.

The solution has to pass every check before a submission is graded. So each test grades a wrong one.
"""

from __future__ import annotations

import os
from pathlib import Path

import pytest
from prepared_python import run_prepared

SAID = """\
import sys

import rclpy
from rclpy.utilities import remove_ros_args
from std_msgs.msg import String

rclpy.init()
node = rclpy.create_node("NODE")
words = remove_ros_args(sys.argv)[1:]
publisher = node.create_publisher(String, "TOPIC", 10)
node.create_timer(0.5, lambda: publisher.publish(String(data=" ".join(words))))
rclpy.spin(node)
"""

HEARD = """\
import rclpy
from std_msgs.msg import String

rclpy.init()
node = rclpy.create_node("hearer")
publisher = node.create_publisher(String, "/heard", 10)
node.create_subscription(String, "/said", lambda message: publisher.publish(String(data=message.data.upper())), 10)
rclpy.spin(node)
"""

WAITS = """\
import threading

import rclpy
from example_interfaces.action import Fibonacci
from rclpy.action import ActionServer
from rclpy.duration import Duration
from rclpy.executors import MultiThreadedExecutor

lock = threading.Lock()


def execute(handle):
    node.get_clock().sleep_for(Duration(seconds=1))
    handle.succeed()
    return Fibonacci.Result()


rclpy.init()
node = rclpy.create_node("waiter")
server = ActionServer(node, Fibonacci, "/wait", execute)
executor = MultiThreadedExecutor(num_threads=4)
executor.add_node(node)
executor.spin()
"""

ONE_PROGRAM = 'file = "node.py"\nnode = "{}"'
TWO_PROGRAMS = """file = "both.py"

[[program]]
file = "speaker.py"
node = "speaker"

[[program]]
file = "hearer.py"
node = "hearer\""""
SPEAKS = '[[publish]]\ntopic = "/said"\ntype = "std_msgs/msg/String"\n'


def graded(folder: Path, names: str, interface: str, scenario: str, check: str, solution: str, wrong: str) -> str:
    """Return what `spinbook grade` prints for `wrong`, in an exercise with this solution, one check, one scenario."""
    exercise, solutions = folder / "exercises" / "small", folder / "solutions" / "small"
    exercise.mkdir(parents=True)
    solutions.mkdir(parents=True)
    (exercise / "exercise.toml").write_text(f'title = "Small"\npoints = 4\n{names}\n\n{interface}')
    (exercise / "task.md").write_text("# Small\n")
    (exercise / "scenarios.py").write_text(
        "from grader.scenario import Scenario, at\n\n\ndef scenarios(seed):\n"
        f'    return (Scenario("plain", "a second or two", {scenario}, rate=20.0),)\n'
    )
    (exercise / "checks.py").write_text(
        "from grader.checking import Run, check\n\n\n"
        "@check(points=4, hint='Look.')\ndef test_all(plain: Run) -> None:\n"
        f'    """It works."""\n    {check}\n'
    )
    (solutions / "solution.py").write_text(f"{solution}# BEGIN SOLUTION\n# END SOLUTION\n")
    (folder / "wrong.py").write_text(wrong)
    environment = {**os.environ, "SPINBOOK_CACHE": str(folder / "cache")}
    done = run_prepared("grader", "small", "wrong.py", cwd=folder, env=environment)
    assert (done.returncode, done.stderr) == (1, ""), done.stdout + done.stderr
    return " ".join(done.stdout.split())


@pytest.mark.timeout(120)
def test_arguments_reach_the_program(tmp_path: Path) -> None:
    solution = SAID.replace("NODE", "speaker").replace("TOPIC", "/said")
    message = graded(
        tmp_path, ONE_PROGRAM.format("speaker"), SPEAKS, 'duration=1.2, arguments=("left", "right")',
        'plain.must_match_series("data")', solution, solution.replace("[1:]", "[2:]"),
    )  # fmt: skip
    assert "0 of 4 points" in message
    assert "left right" in message


@pytest.mark.timeout(120)
def test_a_submission_may_have_several_programs(tmp_path: Path) -> None:
    speaker = SAID.replace("NODE", "speaker").replace("TOPIC", "/said")
    solution = f"# file: speaker.py\n{speaker}\n\n# file: hearer.py\n{HEARD}"
    message = graded(
        tmp_path, TWO_PROGRAMS, f'{SPEAKS}\n[[publish]]\ntopic = "/heard"\ntype = "std_msgs/msg/String"\n',
        'duration=1.2, arguments=("up",)', 'plain.must_match_series("data", topic="/heard")', solution,
        solution.replace("upper()", "lower()"),
    )  # fmt: skip
    assert "0 of 4 points" in message
    assert "UP" in message


@pytest.mark.timeout(120)
def test_two_goals_at_once_are_served_side_by_side(tmp_path: Path) -> None:
    wait = "    node.get_clock().sleep_for(Duration(seconds=1))"
    message = graded(
        tmp_path, ONE_PROGRAM.format("waiter"),
        '[[action]]\nname = "/wait"\ntype = "example_interfaces/action/Fibonacci"\n',
        'at(0.5, 0.5).send_goal("/wait", order=3), duration=4.0',
        '[plain.must_end("succeeded", goal=goal, within=1.2) for goal in (1, 2)]', WAITS,
        WAITS.replace(wait, f"    with lock:\n    {wait}"),
    )  # fmt: skip
    assert "0 of 4 points" in message
    assert "Goal 2" in message or "goal 2" in message
