"""Every exercise of the course: the solution gets full marks, the starter gets nothing.

`make soak` tests that each right solution gets full marks and each mistake loses exactly the checks that it names, in
tests/grader/audit/test_course_exercises.py; `spinbook audit --quick` shows it in one command.
"""

from __future__ import annotations

from pathlib import Path

import pytest

from grader.exercise import load, starter
from grader.exercise.mistakes import mistakes_of
from grader.grading import Options, grading_of
from grader.grading.grading import Grading
from grader.submission.reader import of_source
from grader.workers import WorkerPool

ROOT = Path(__file__).parents[3]

#: joint_velocity has tests of its own, in test_solutions.py.
NAMES = sorted(
    file.parent.name for file in ROOT.glob("exercises/*/exercise.toml") if file.parent.name != "joint_velocity"
)


#: Its scenarios take longest. The class that `make course` grades has its solution, too.
LONG = "go_to_goal"


@pytest.fixture(
    scope="module", params=[pytest.param(name, marks=pytest.mark.soak if name == LONG else ()) for name in NAMES]
)
def graded(request: pytest.FixtureRequest, workers_with_interfaces: WorkerPool) -> Grading:
    """A grading of one exercise; its solution has been verified in this run of the tests."""
    return grading_of(load(ROOT / "exercises" / request.param), Options(), workers_with_interfaces)


def test_the_solution_gets_full_marks_and_the_starter_nothing(graded: Grading) -> None:
    exercise = graded.runner.exercise
    # Without full marks for it there would be no `graded`: see `_prove` in grader/grading/reference.py.
    assert exercise.solution_file
    assert graded.references
    source = starter(exercise.solution_file.read_text(encoding="utf-8"))
    nothing = graded.grade(of_source("starter", source.encode(), exercise))
    assert (nothing.outcome, nothing.score) == ("graded", 0)


@pytest.mark.parametrize("name", [*NAMES, "joint_velocity"])
def test_there_are_five_right_solutions_and_mistakes_that_name_a_sentence_of_the_task_and_checks(name: str) -> None:
    assert len(list((ROOT / "solutions" / name / "right").glob("*.py"))) >= 5
    mistakes = mistakes_of(load(ROOT / "exercises" / name))
    assert len(mistakes) >= 15
    assert [mistake.name for mistake in mistakes if not (mistake.breaks and mistake.caught_by)] == []
