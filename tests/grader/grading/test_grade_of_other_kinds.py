"""Grades of more than one node with topics: several programs, arguments, goals at once.

The solution has to pass every check before a submission is graded. So each test grades a wrong one.
"""

from __future__ import annotations

from pathlib import Path

from grader.exercise import Exercise, load
from grader.grading import Options, grading_of
from grader.submission.reader import of_source
from grader.workers import WorkerPool

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


def written(folder: Path, names: str, interface: str, scenario: str, check: str, solution: str) -> Exercise:
    """Write an exercise with this solution, one check and one scenario."""
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
    return load(exercise)


def finding(exercise: Exercise, wrong: str, workers: WorkerPool) -> str:
    """Return what is said of a wrong program."""
    grade = grading_of(exercise, Options(), workers).grade(of_source("wrong.py", wrong.encode(), exercise))
    assert (grade.outcome, grade.score) == ("graded", 0), grade.message
    [verdict] = grade.verdicts
    assert verdict.finding
    return verdict.finding.text


def test_arguments_reach_the_program(tmp_path: Path, workers: WorkerPool) -> None:
    solution = SAID.replace("NODE", "speaker").replace("TOPIC", "/said")
    exercise = written(
        tmp_path, ONE_PROGRAM.format("speaker"), SPEAKS, 'duration=1.2, arguments=("left", "right")',
        'plain.must_match_series("data")', solution,
    )  # fmt: skip
    assert "left right" in finding(exercise, solution.replace("[1:]", "[2:]"), workers)


def test_a_submission_may_have_several_programs(tmp_path: Path, workers: WorkerPool) -> None:
    speaker = SAID.replace("NODE", "speaker").replace("TOPIC", "/said")
    solution = f"# file: speaker.py\n{speaker}\n\n# file: hearer.py\n{HEARD}"
    exercise = written(
        tmp_path, TWO_PROGRAMS, f'{SPEAKS}\n[[publish]]\ntopic = "/heard"\ntype = "std_msgs/msg/String"\n',
        'duration=1.2, arguments=("up",)', 'plain.must_match_series("data", topic="/heard")', solution,
    )  # fmt: skip
    assert "UP" in finding(exercise, solution.replace("upper()", "lower()"), workers)


def test_two_goals_at_once_are_served_side_by_side(tmp_path: Path) -> None:
    wait = "    node.get_clock().sleep_for(Duration(seconds=1))"
    exercise = written(
        tmp_path, ONE_PROGRAM.format("waiter"),
        '[[action]]\nname = "/wait"\ntype = "example_interfaces/action/Fibonacci"\n',
        'at(0.5, 0.5).send_goal("/wait", order=3), duration=4.0',
        '[plain.must_end("succeeded", goal=goal, within=1.2) for goal in (1, 2)]', WAITS,
    )  # fmt: skip
    with WorkerPool() as workers:  # it has example_interfaces, which the exercise needs
        assert "oal 2" in finding(exercise, WAITS.replace(wait, f"    with lock:\n    {wait}"), workers)
