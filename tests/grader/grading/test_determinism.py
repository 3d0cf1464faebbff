"""A verdict depends on the submission alone: not on how busy the machine is, nor on how the node is built and spun."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest
from busy_loops import busy

from grader.exercise import Exercise
from grader.exercise.mistakes import mistake_of
from grader.grading import Grade, Options, grading_of
from grader.grading.grading import Grading
from grader.recording.recording import to_json
from grader.submission import Submission, read
from grader.submission.reader import of_mistake, of_source
from grader.workers import WorkerPool

ROOT = Path(__file__).parents[3]
SOLUTIONS = ROOT / "solutions" / "joint_velocity"

#: Neither misuses the computer's clock, whose time may differ from one run to the next.
SUBMISSIONS = ("joints_by_index", "several_threads")

#: Never done with its first message, until the hub ends it.
ANSWERS_ITSELF = ROOT / "benchmarks/determinism/programs/answers_itself.py"


def submission_of(name: str, exercise: Exercise) -> Submission:
    """Return a usual mistake, or the program in a file."""
    if name == "joints_by_index":
        return of_mistake(mistake_of(exercise, name), exercise)
    return read(str(ANSWERS_ITSELF if name == "answers_itself" else SOLUTIONS / "right" / f"{name}.py"), exercise)


@pytest.fixture(scope="module")
def grading(exercise: Exercise, workers: WorkerPool) -> Grading:
    """A grading of joint_velocity that runs several scenarios at once, as by default."""
    return grading_of(exercise, Options(), workers)


@pytest.fixture(scope="module")
def short(exercise: Exercise, workers: WorkerPool) -> Grading:
    """A grading of joint_velocity by its public checks alone, which takes two scenarios."""
    return grading_of(exercise.public(), Options(), workers)


def recorded(grade: Grade) -> str:
    """Return everything that was sent and received, as text: NaN is not equal to itself."""
    return to_json(
        {name: replace(r, log="", seconds=0.0, lockstep_seconds=0.0) for name, r in grade.recordings.items()}
    )


@pytest.mark.parametrize(
    "name",
    [pytest.param(name, marks=() if name == "several_threads" else pytest.mark.soak) for name in SUBMISSIONS]
    + [pytest.param("answers_itself", marks=pytest.mark.soak)],
)
def test_beside_busy_loops_the_grade_is_the_same(short: Grading, name: str) -> None:
    submission = submission_of(name, short.runner.exercise)
    alone = short.grade(submission)
    with busy(4):
        beside = short.grade(submission)
    assert alone.full_marks == (name != "answers_itself")
    assert alone == beside
    assert recorded(alone) == recorded(beside), "to the last bit of every message"


#: What is replaced in the solution, and by what, for another way to make the node or to spin it.
WAYS = {
    "no parameter services": {
        "super().__init__('joint_velocity')": "super().__init__('joint_velocity', start_parameter_services=False)"
    },
    "no services at all": {
        "super().__init__('joint_velocity')": "super().__init__('joint_velocity', start_parameter_services=False, "
        "parameter_overrides=[rclpy.Parameter('start_type_description_service', value=False)])"
    },
    "without the command line": {"rclpy.init()": "rclpy.init(args=[])"},
    "asleep between its looks": {
        "rclpy.spin(node)": "while rclpy.ok(): rclpy.spin_once(node, timeout_sec=0.002); time.sleep(0.003)",
        "import rclpy\n": "import time\nimport rclpy\n",
    },
}


def is_right(grading: Grading, way: str) -> None:
    """Grade the solution, made and spun in this way, and check that it gets full marks."""
    source = (SOLUTIONS / "solution.py").read_text(encoding="utf-8")
    for old, new in WAYS[way].items():
        assert old in source
        source = source.replace(old, new)
    grade = grading.grade(of_source("test.py", source.encode(), grading.runner.exercise))
    assert grade.full_marks, [v for v in grade.verdicts if v.status != "passed"]
    assert grade.recordings["chapter"].uses_sim_time, "it has been told to"


@pytest.mark.parametrize("way", WAYS)
def test_however_a_node_is_made_and_spun_its_grade_is_right(short: Grading, way: str) -> None:
    is_right(short, way)


@pytest.mark.soak
@pytest.mark.parametrize("way", WAYS)
def test_however_a_node_is_made_and_spun_it_is_right_in_every_scenario(grading: Grading, way: str) -> None:
    is_right(grading, way)
