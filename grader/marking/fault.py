"""A grading that came to nothing by a fault of ours."""

from __future__ import annotations

from grader.grading import Grade
from grader.grading.spinning import Spinner
from grader.grading.versions import versions
from grader.submission import Submission


def fault(spinner: Spinner, submission: Submission, told: str) -> Grade:
    """The grade without a score; `told` is for the instructor."""
    return Grade(
        exercise=spinner.exercise.name,
        submission=submission.name,
        digest=submission.digest,
        outcome="host-error",
        message=f"This is not your fault: {told}",
        score=0.0,
        points=spinner.exercise.points,
        verdicts=(),
        isolation=str(spinner.isolation),
        seed=spinner.options.seed,
        versions=versions(spinner.middleware),
    )
