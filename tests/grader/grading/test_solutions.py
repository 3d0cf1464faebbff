"""Every right solution gets full marks, every usual mistake loses exactly the checks it names, the starter gets 0."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import pytest

from grader.exercise import load, starter
from grader.exercise.mistakes import Mistake, mistakes_of
from grader.grading.grading import Grading
from grader.submission import read
from grader.submission.reader import of_source

ROOT = Path(__file__).parents[3]
SOLUTIONS = ROOT / "solutions" / "joint_velocity"
MISTAKES = mistakes_of(load(ROOT / "exercises" / "joint_velocity"))

#: The usual mistakes that must exist.
USUAL = {
    *("fixed_dt", "wall_clock", "position_for_velocity", "sign_turned_round", "joints_by_index", "no_guard_for_dt_0"),
    *("publishes_on_the_first_message", "forgets_the_stamp", "republishes_the_input", "averaged_over_two"),
    *("wrong_topic", "wrong_type", "integer_division", "forgets_nanosec", "degrees"),
}

#: GradedSubmission by every `make test`; `make soak` grades all. tests/grader/audit also tests, for all of them
#: and in less time, that each mistake loses exactly the checks that it names.
ALWAYS = {
    *("fixed_dt", "traceback_on_ctrl_c"),
    *("numpy_arrays", "without_main", "several_threads", "asyncio_loop"),
}


def few_always(programs: Mapping[str, object]) -> list[object]:
    """Return a parameter for each program, by name; all but a few are only for `make soak`."""
    return [
        pytest.param(program, id=name, marks=() if name in ALWAYS else pytest.mark.soak)
        for name, program in programs.items()
    ]


def test_the_solution_gets_full_marks(grading: Grading) -> None:
    grade = grading.grade(read(str(SOLUTIONS / "solution.py"), grading.runner.exercise))
    assert grade.full_marks, grade
    assert grade.score == 100


@pytest.mark.parametrize("file", few_always({file.stem: file for file in sorted((SOLUTIONS / "right").glob("*.py"))}))
def test_a_right_solution_in_another_style_gets_full_marks(grading: Grading, file: Path) -> None:
    grade = grading.grade(read(str(file), grading.runner.exercise))
    assert grade.full_marks, [v for v in grade.verdicts if v.status != "passed"]


@pytest.mark.parametrize("mistake", few_always({mistake.name: mistake for mistake in MISTAKES}))
def test_a_mistake_loses_exactly_the_checks_that_it_names(grading: Grading, mistake: Mistake) -> None:
    grade = grading.grade(of_source("mistake.py", mistake.source.encode(), grading.runner.exercise))
    assert grade.outcome == "graded"
    assert {v.name for v in grade.verdicts if v.status == "failed"} == set(mistake.caught_by)
    failed = [v for v in grade.verdicts if v.status == "failed"]
    assert all(v.finding and v.finding.text and v.hint for v in failed), "a student needs to be told"


def test_the_usual_mistakes_are_all_there() -> None:
    assert {mistake.name for mistake in MISTAKES} >= USUAL


def test_the_starter_runs_and_gets_nothing(grading: Grading) -> None:
    source = starter((SOLUTIONS / "solution.py").read_text(encoding="utf-8"))
    grade = grading.grade(of_source("starter", source.encode(), grading.runner.exercise))
    assert grade.outcome == "graded"
    assert grade.score == 0
    assert "6 joints arrived" in grade.log
