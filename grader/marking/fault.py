"""A grading that came to nothing by a fault of ours."""

from __future__ import annotations

from grader.exercise import Exercise
from grader.grading import Grade, Options
from grader.grading.versions import versions
from grader.sandbox import Isolation
from grader.submission import Submission


def fault(exercise: Exercise, options: Options, isolation: Isolation, submission: Submission, told: str) -> Grade:
    """The grade without a score; `told` is for the instructor."""
    return Grade(
        exercise=exercise.name,
        submission=submission.name,
        digest=submission.digest,
        outcome="host-error",
        message=f"This is not your fault: {told}",
        score=0.0,
        points=exercise.points,
        verdicts=(),
        isolation=str(isolation),
        seed=options.seed,
        versions=versions(),
    )
