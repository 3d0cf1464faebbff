"""Every right solution gets full marks, every usual mistake loses exactly the checks it names, the starter gets 0."""

from __future__ import annotations

import ast
import re
from pathlib import Path

import pytest

from grader.exercise import starter
from grader.grading.grading import Grading
from grader.submission import read
from grader.submission.reading import of_source

SOLUTIONS = Path(__file__).parents[2] / "solutions" / "joint_velocity"

#: The usual mistakes that must exist.
USUAL = {
    *("fixed_dt", "wall_clock", "position_for_velocity", "sign_turned_round", "joints_by_index", "no_guard_for_dt_0"),
    *("publishes_on_the_first_message", "forgets_the_stamp", "republishes_the_input", "averaged_over_two"),
    *("wrong_topic", "wrong_type", "integer_division", "forgets_nanosec", "degrees"),
}

#: Graded by every `make test`; `make soak` grades all. tests/audit/test_course_exercises.py also tests, for all of them
#: and in less time, that each mistake loses exactly the checks that it names.
ALWAYS = {
    *("fixed_dt", "traceback_on_ctrl_c"),
    *("numpy_arrays", "without_main", "several_threads", "asyncio_loop"),
}


def caught_by(file: Path) -> set[str]:
    """Return the checks that the mistake's header names."""
    header = ast.get_docstring(ast.parse(file.read_text(encoding="utf-8"))) or ""
    return set(re.findall(r"^- (test_\w+)$", header, re.MULTILINE))


def every(folder: str) -> list[object]:
    files = sorted((SOLUTIONS / folder).glob("*.py"))
    return [pytest.param(f, id=f.stem, marks=() if f.stem in ALWAYS else pytest.mark.soak) for f in files]


def test_the_solution_gets_full_marks(grading: Grading) -> None:
    grade = grading.grade(read(str(SOLUTIONS / "solution.py"), grading.runner.exercise))
    assert grade.full_marks, grade
    assert grade.score == 100


@pytest.mark.parametrize("file", every("right"))
def test_a_right_solution_in_another_style_gets_full_marks(grading: Grading, file: Path) -> None:
    grade = grading.grade(read(str(file), grading.runner.exercise))
    assert grade.full_marks, [v for v in grade.verdicts if v.status != "passed"]


@pytest.mark.parametrize("file", every("mistakes"))
def test_a_mistake_loses_exactly_the_checks_that_it_names(grading: Grading, file: Path) -> None:
    grade = grading.grade(read(str(file), grading.runner.exercise))
    assert grade.outcome == "graded"
    assert {v.name for v in grade.verdicts if v.status == "failed"} == caught_by(file)
    failed = [v for v in grade.verdicts if v.status == "failed"]
    assert all(v.finding and v.finding.text and v.hint for v in failed), "a student needs to be told"


def test_the_usual_mistakes_are_all_there() -> None:
    assert {f.stem for f in (SOLUTIONS / "mistakes").glob("*.py")} >= USUAL


def test_the_starter_runs_and_gets_nothing(grading: Grading) -> None:
    source = starter((SOLUTIONS / "solution.py").read_text(encoding="utf-8"))
    grade = grading.grade(of_source("starter", source.encode(), grading.runner.exercise))
    assert grade.outcome == "graded"
    assert grade.score == 0
    assert "6 joints arrived" in grade.log
