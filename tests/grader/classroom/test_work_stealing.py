"""The end of a class takes no longer than it must."""

from __future__ import annotations

import threading

from small_class import EXERCISE, TEMPLATE

from grader.classroom.local import LocalBackend
from grader.exercise import load
from grader.exercise.mistakes import mistake_of
from grader.grading import Options, grading_of
from grader.submission.reader import of_mistake
from grader.workers import Worker, WorkerPool


class Counting(WorkerPool):
    """Knows how many threads have requested a worker for scenarios."""

    def __init__(self) -> None:
        super().__init__()
        self.threads: set[int] = set()

    def reserve(self) -> Worker:
        self.threads.add(threading.get_ident())
        return super().reserve()


def test_whoever_has_no_submission_left_helps_with_the_last_one() -> None:
    exercise = load(TEMPLATE / "exercises" / EXERCISE)
    submission = of_mistake(mistake_of(exercise, "only_forwards"), exercise)
    grades = []
    workers = Counting()
    with workers:
        grading = grading_of(exercise, Options(), workers)
        assert len(grading.runner.scenarios) >= 4
        for jobs in (1, 4):
            workers.threads.clear()
            (graded,) = LocalBackend(grading, jobs).grade({"ada": submission})
            assert len(workers.threads) == jobs
            grades.append(graded.grade)
    alone, helped = grades
    assert helped.outcome == alone.outcome == "graded"
    assert helped.verdicts == alone.verdicts
