"""Right solutions get full marks, mistakes lose exactly the checks that they name, and the starter gets nothing.

The solution has full marks once there is a `grading`. `make soak` tests all of them in all scenarios, in
tests/grader/audit/test_course_exercises.py.
"""

from __future__ import annotations

from pathlib import Path

import pytest
from few_scenarios import in_scenarios

from grader.exercise import Exercise, starter
from grader.exercise.mistakes import mistake_of, mistakes_of
from grader.grading.grading import Grading
from grader.submission import read
from grader.submission.reader import of_source

SOLUTIONS = Path(__file__).parents[3] / "solutions" / "joint_velocity"

#: The usual mistakes that must exist.
USUAL = {
    *("fixed_dt", "wall_clock", "position_for_velocity", "sign_turned_round", "joints_by_index", "no_guard_for_dt_0"),
    *("publishes_on_the_first_message", "forgets_the_stamp", "republishes_the_input", "averaged_over_two"),
    *("wrong_topic", "wrong_type", "integer_division", "forgets_nanosec", "degrees"),
}

#: With the joints in one order and in another.
FEW = ("chapter", "reordered")


@pytest.mark.parametrize("name", ["numpy_arrays", "without_main", "asyncio_loop"])
def test_a_right_solution_in_another_style_gets_full_marks(grading: Grading, name: str) -> None:
    file = SOLUTIONS / "right" / f"{name}.py"
    grade = in_scenarios(grading, *FEW).grade(read(str(file), grading.runner.exercise))
    assert grade.full_marks, [v for v in grade.verdicts if v.status != "passed"]


def test_a_mistake_loses_exactly_the_checks_that_it_names(grading: Grading) -> None:
    mistake = mistake_of(grading.runner.exercise, "fixed_dt")
    grade = grading.grade(of_source("mistake.py", mistake.source.encode(), grading.runner.exercise))
    assert grade.outcome == "graded"
    assert {v.name for v in grade.verdicts if v.status == "failed"} == set(mistake.caught_by)
    failed = [v for v in grade.verdicts if v.status == "failed"]
    assert all(v.finding and v.finding.text and v.hint for v in failed), "a student needs to be told"


def test_the_usual_mistakes_are_all_there(exercise: Exercise) -> None:
    assert {mistake.name for mistake in mistakes_of(exercise)} >= USUAL


def test_the_starter_runs_and_gets_nothing(grading: Grading) -> None:
    source = starter((SOLUTIONS / "solution.py").read_text(encoding="utf-8"))
    grade = in_scenarios(grading, *FEW).grade(of_source("starter", source.encode(), grading.runner.exercise))
    assert grade.outcome == "graded"
    assert grade.score == 0
    assert "6 joints arrived" in grade.log
