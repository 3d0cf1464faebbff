"""One program started twice, each in its namespace; files for it; a world whose truth only checks see."""

from __future__ import annotations

import re
from collections.abc import Iterator

import pytest

from grader.exercise import Exercise, ExerciseError, load
from grader.grading import Options, grading_of
from grader.grading.grading import Grading
from grader.scenario.declared import declared
from grader.submission.reader import of_source
from grader.workers import WorkerPool

FILES = {
    "exercise.toml": """\
title = "Two robots"
points = 4
file = "robot.py"
node = "robot"

[[subscribe]]
topic = "/z"
type = "std_msgs/msg/Float64"

[[publish]]
topic = "/height"
type = "std_msgs/msg/Float64"
units = { data = "m" }
""",
    "task.md": "# Two robots\n\nEstimate the height.\n",
    "data/maps/bias.txt": "0.5",
    "noise.py": "BIAS, SIGNS = 0.5, (1.0, -1.0)\n",
    "peers.py": """\
import noise
import rclpy
from std_msgs.msg import Float64

rclpy.init()
node = rclpy.create_node("peer")
publisher = node.create_publisher(Float64, "/peer", 10)
node.create_timer(0.1, lambda: publisher.publish(Float64(data=noise.BIAS)))
rclpy.spin(node)
""",
    "scenarios.py": """\
from noise import BIAS, SIGNS

from grader.scenario import Companion, Program, Scenario, World, at


class Heights:
    reads = {}
    publishes = {f"/{side}/z": "std_msgs/msg/Float64" for side in ("left", "right")}
    step_number = 0

    def hear(self, topic, message): ...

    def step(self, seconds):
        self.step_number += 1

    def height(self):
        return 0.01 * self.step_number

    def truth(self):
        return {"height": self.height(), "where": {"left": [1.0]}}

    def state(self):
        noisy = self.height() + BIAS + 0.02 * SIGNS[self.step_number % 2]
        return {topic: {"data": noisy} for topic in self.publishes}


def scenarios(seed):
    both = [Program("robot.py", name=side, namespace=f"/{side}") for side in ("left", "right")]
    both[1] = Program("robot.py", name="right", namespace="/right", parameters={"sign": -1.0},
                      remappings={"height": "altitude"}, starts=0.2)
    return (Scenario("both", "two robots", at(0.9).kill("right"), programs=both, world=World(Heights, period=0.1),
                     companions=Companion("peers.py"), duration=1.0),)
""",
    "checks.py": """\
from grader.checking import Run, check


@check(points=4, hint="Subtract the bias.")
def test_both(both: Run) -> None:
    \"\"\"Both robots estimate the height.\"\"\"
    both.must_have_nodes()
    both.must_have_interface()
    both.must_estimate("/left/height", {"data": "height"}, rmse=0.03, start=0.3)
    assert [round(state.height, 3) for state in both.truth[:2]] == [0.01, 0.02]
    assert both.truth[0].where.left == [1.0] and round(both.truth[-1].at, 3) == 1.0
    both.must_stay_between("truth", "height", 0.0, 0.11)
    values = {message.fields["data"] for message in both.messages_on("/right/altitude")}
    assert values and max(values) < 0, values
""",
}

SOLUTION = """\
from pathlib import Path

import rclpy
from std_msgs.msg import Float64

BIAS = float((Path(__file__).parent / "data" / "maps" / "bias.txt").read_text())

rclpy.init()
node = rclpy.create_node("robot")
sign = node.declare_parameter("sign", 1.0).value
publisher = node.create_publisher(Float64, "height", 10)


def on_z(message):
    # TODO: publish the height.
    # BEGIN SOLUTION
    publisher.publish(Float64(data=sign * (message.data - BIAS + 0.0)))
    # END SOLUTION


node.create_subscription(Float64, "z", on_z, 10)
rclpy.spin(node)
"""


@pytest.fixture(scope="module")
def exercise(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Exercise]:
    root = tmp_path_factory.mktemp("robots")
    files = {f"exercises/robots/{name}": text for name, text in FILES.items()}
    for name, text in {**files, "solutions/robots/solution.py": SOLUTION}.items():
        (root / name).parent.mkdir(parents=True, exist_ok=True)
        (root / name).write_text(text)
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("SPINBOOK_CACHE", str(root / "cache"))
        yield load(root / "exercises" / "robots")


@pytest.fixture(scope="module")
def graded(exercise: Exercise, workers: WorkerPool) -> Grading:
    return grading_of(exercise, Options(), workers)


def text_of(grading: Grading, source: str) -> str:
    verdict = grading.grade(of_source("robot", source.encode(), grading.runner.exercise)).verdicts[0]
    return verdict.finding.text if verdict.finding else verdict.status


def test_a_program_runs_twice_in_namespaces_and_reads_the_exercises_files(graded: Grading) -> None:
    recording = graded.references["both"]
    assert recording.nodes == ("/left/robot", "/right/robot")
    assert [(exit_.program, exit_.by) for exit_ in recording.exits] == [("right", "grader")]
    assert {message.topic for message in recording.received} == {"/left/height", "/right/altitude"}
    assert text_of(graded, SOLUTION) == "passed"


def test_a_wrong_estimate_is_told_by_its_error_and_the_pattern_of_it(graded: Grading) -> None:
    text = text_of(graded, SOLUTION.replace("+ 0.0)", "+ 0.2)"))
    assert re.search(r"the root of the mean squared error of data on /left/height is 0\.2\d* m; at most 0\.03 m", text)
    assert "no node /left/robot" in text_of(graded, SOLUTION.replace('"robot"', '"other"'))
    assert "does not subscribe to /left/z" in text_of(graded, SOLUTION.replace('"z"', '"y"'))


def test_the_truth_is_no_topic_and_the_files_are_read_only(graded: Grading) -> None:
    spies = SOLUTION.replace(
        "    # BEGIN",
        "    topics = [name for name, _ in node.get_topic_names_and_types()]\n"
        "    assert not any('truth' in name for name in topics), topics\n"
        "    import os\n"
        "    assert not os.access(Path(__file__).parent / 'data' / 'maps', os.W_OK)\n"
        "    # BEGIN",
    )
    assert text_of(graded, spies) == "passed"


def test_another_file_makes_another_recording(exercise: Exercise, graded: Grading, workers: WorkerPool) -> None:
    file = exercise.folder / "data" / "maps" / "bias.txt"
    file.write_text("0.75")
    try:
        with pytest.raises(ExerciseError, match="the solution does not pass the check test_both"):
            grading_of(exercise, Options(), workers)
    finally:
        file.write_text("0.5")


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ('name="right"', 'name="left"', "two programs are called 'left'.*Give each its own name"),
        ('Program("robot.py", name="right"', 'Program("robt.py", name="right"', "no program 'robt.py'.*robot.py"),
        ('kill("right")', 'kill("robot.py")', "no program 'robot.py'.*left, right"),
    ],
)
def test_a_program_that_is_not_there_is_reported(exercise: Exercise, old: str, new: str, message: str) -> None:
    text = exercise.scenarios_file.read_text()
    exercise.scenarios_file.write_text(text.replace(old, new))
    try:
        with pytest.raises(ExerciseError) as caught:
            declared(exercise, 1)
    finally:
        exercise.scenarios_file.write_text(text)
    assert re.search(message, f"{caught.value.problem.problem} {caught.value.problem.fix}")
    assert caught.value.problem.line
