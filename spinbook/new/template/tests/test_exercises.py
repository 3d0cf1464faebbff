"""Right solutions get full marks, mistakes lose exactly the checks that they name, starters get nothing."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest

from grader.exercise import load, starter
from grader.exercise.mistakes import mistakes_of
from grader.grading import Options, grading_of
from grader.grading.grading import Grading
from grader.submission import read
from grader.submission.reader import of_source
from grader.workers import WorkerPool

COURSE = Path(__file__).parents[1]
EXERCISES = sorted(file.parent.name for file in (COURSE / "exercises").glob("*/exercise.toml"))


@pytest.fixture(scope="module")
def workers() -> Iterator[WorkerPool]:
    with WorkerPool() as workers:
        yield workers


@pytest.fixture(scope="module", params=EXERCISES)
def grading(request: pytest.FixtureRequest, workers: WorkerPool) -> Grading:
    """Ready to grade one exercise; the solution has passed every check."""
    return grading_of(load(COURSE / "exercises" / request.param), Options(), workers)


def files(grading: Grading, pattern: str) -> list[Path]:
    return sorted((COURSE / "solutions" / grading.runner.exercise.name).glob(pattern))


def test_every_right_solution_gets_full_marks(grading: Grading) -> None:
    for file in [*files(grading, "solution.py"), *files(grading, "right/*.py")]:
        grade = grading.grade(read(str(file), grading.runner.exercise))
        assert grade.full_marks, (file.name, [v for v in grade.verdicts if v.status != "passed"])


def test_every_mistake_loses_exactly_the_checks_that_it_names(grading: Grading) -> None:
    mistakes = mistakes_of(grading.runner.exercise)
    assert mistakes, "write at least one usual mistake: it shows that the checks catch something"
    for mistake in mistakes:
        grade = grading.grade(of_source(mistake.name, mistake.source.encode(), grading.runner.exercise))
        assert {v.name for v in grade.verdicts if v.status == "failed"} == set(mistake.caught_by), mistake.name


def test_the_starter_runs_and_gets_nothing(grading: Grading) -> None:
    [solution] = files(grading, "solution.py")
    source = starter(solution.read_text(encoding="utf-8"))
    grade = grading.grade(of_source("starter", source.encode(), grading.runner.exercise))
    assert (grade.outcome, grade.score) == ("graded", 0), grade.message
