"""What the public checks say of a submission, before it is handed in."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from grader.exercise import Exercise, ExerciseError
from grader.grading import Grade, grade_submission
from grader.submission import Submission


@dataclass(frozen=True)
class SelfCheck:
    """The public part of a grade, or `why` there is none. It is never the grade of record."""

    grade: Grade | None
    why: str = ""

    @property
    def record(self) -> dict[str, Any]:
        """As plain data, for the upload's record."""
        if self.grade is None:
            return {"not_run": self.why}
        return {
            "outcome": self.grade.outcome,
            "score": self.grade.score,
            "points": self.grade.points,
            "isolation": self.grade.isolation,
            "checks": {verdict.name: verdict.status for verdict in self.grade.verdicts},
        }


def self_check(exercise: Exercise, submission: Submission) -> SelfCheck:
    """Run the public checks. Nothing that goes wrong is raised, for it must not keep anybody from handing in."""
    try:
        grade = grade_submission(exercise.public(), submission)
    except KeyboardInterrupt:
        return SelfCheck(None, "It was interrupted.")
    except ExerciseError as error:
        return SelfCheck(None, f"The checks can't run here: {error.found} ({error.file.name}).")
    except Exception as error:
        return SelfCheck(None, f"{type(error).__name__}: {error}")
    if grade.outcome == "host-error":
        return SelfCheck(None, grade.message)
    return SelfCheck(replace(grade, submission=Path(grade.submission).name))
