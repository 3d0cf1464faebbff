"""A verdict depends on the submission alone: not on how busy the machine is, nor on how the node is turned."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path

import pytest

from grader.grading import Grade
from grader.grading.grading import Grading
from grader.recording.store import to_json
from grader.submission import read
from grader.submission.reading import of_source

SOLUTIONS = Path(__file__).parents[2] / "solutions" / "joint_velocity"

#: Each loses different checks, none by the computer's clock.
SUBMISSIONS = (
    "solution.py",
    "mistakes/no_guard_for_dt_0.py",
    "right/several_threads.py",
    "mistakes/joints_by_index.py",
)


@contextmanager
def busy(loops: int) -> Iterator[None]:
    """That many processes that compute without an end."""
    processes = [subprocess.Popen([sys.executable, "-c", "while True: pass"]) for _ in range(loops)]
    try:
        yield
    finally:
        for process in processes:
            process.kill()
            process.wait()


def grades(grading: Grading, name: str, times: int) -> list[Grade]:
    submission = read(str(SOLUTIONS / name), grading.spinner.exercise)
    return [grading.grade(submission) for _ in range(times)]


def recorded(grade: Grade) -> str:
    """All that was sent and received, as text: NaN is not equal to itself."""
    return to_json(
        {name: replace(r, log="", seconds=0.0, lockstep_seconds=0.0) for name, r in grade.recordings.items()}
    )


def test_beside_busy_loops_the_grade_is_the_same(grading: Grading) -> None:
    name = "mistakes/joints_by_index.py"
    alone = grades(grading, name, 1)
    with busy(4):
        beside = grades(grading, name, 1)
    assert alone == beside
    assert recorded(alone[0]) == recorded(beside[0]), "to the last bit of every message"


@pytest.mark.soak
@pytest.mark.timeout(7200)
@pytest.mark.parametrize("name", SUBMISSIONS)
def test_fifty_times_half_of_them_beside_busy_loops(grading: Grading, name: str) -> None:
    all_grades = grades(grading, name, 25)
    with busy(8):
        all_grades += grades(grading, name, 25)
    assert all(grade == all_grades[0] for grade in all_grades)


@pytest.mark.parametrize(
    ("change", "hold"),
    [
        ({}, "parameters"),
        ({"super().__init__('joint_velocity')": "super().__init__('joint_velocity', start_parameter_services=False)"},
         "type description"),
        (
            {
                "super().__init__('joint_velocity')": "super().__init__('joint_velocity', "
                "start_parameter_services=False, "
                "parameter_overrides=[rclpy.Parameter('start_type_description_service', value=False)])"
            },
            "quiet",
        ),
        ({"rclpy.init()": "rclpy.init(args=[])"}, "parameters"),
    ],
    ids=["parameter services", "none", "no services at all", "deaf to the command line"],
)  # fmt: skip
def test_whatever_hold_a_node_gives_its_grade_is_right(grading: Grading, change: dict[str, str], hold: str) -> None:
    source = (SOLUTIONS / "solution.py").read_text(encoding="utf-8")
    for old, new in change.items():
        assert old in source
        source = source.replace(old, new)
    grade = grading.grade(of_source("test.py", source.encode(), grading.spinner.exercise))
    assert grade.full_marks, [v for v in grade.verdicts if v.status != "passed"]
    assert grade.hold == hold


def test_a_node_that_is_deaf_to_the_command_line_is_told_to_use_simulated_time(grading: Grading) -> None:
    source = (SOLUTIONS / "solution.py").read_text(encoding="utf-8").replace("rclpy.init()", "rclpy.init(args=[])")
    grade = grading.grade(of_source("test.py", source.encode(), grading.spinner.exercise))
    assert grade.recordings["chapter"].uses_sim_time
