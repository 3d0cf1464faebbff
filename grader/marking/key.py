"""What a grade depends on."""

from __future__ import annotations

import hashlib
import json
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any

from grader.grading.grading import Grading
from grader.grading.versions import digest_of, versions
from grader.submission import Submission


def key_of(grading: Grading) -> str:
    """The same for two gradings if they give every submission the same grade, as far as can be known beforehand.

    Of the exercise's text that is what grades and pages tell of it; of the machine, the versions of Python and ROS and
    the level of isolation.
    """
    spinner = grading.spinner
    exercise = spinner.exercise
    files: list[Path] = [exercise.folder / "task.md", *exercise.check_files]
    if exercise.solution_file:
        files.append(exercise.solution_file)
    depends = {
        # The exercise as it was read: a due date, which is not in it, can be changed after grading.
        "exercise": repr(replace(exercise, folder=Path(), solution_folder=None)),
        "files": digest_of([file for file in files if file.exists()]),
        **_of_a_run(grading),
    }
    return _digest(depends)


def recordings_key(grading: Grading, submission: Submission) -> str:
    """The same as long as a submission's recordings would be, whatever the checks are."""
    return with_submission(_digest(_of_a_run(grading)), submission.digest)


def _of_a_run(grading: Grading) -> dict[str, Any]:
    """What a recording depends on, besides the submission."""
    spinner = grading.spinner
    return {
        "scenarios": [scenario.digest for scenario in spinner.scenarios],
        "versions": versions(spinner.middleware),
        "seed": spinner.options.seed,
        "pace": spinner.options.pace,
        "limits": asdict(spinner.options.limits),
        "isolation": str(spinner.isolation),
    }


def _digest(depends: dict[str, Any]) -> str:
    return hashlib.sha256(json.dumps(depends, sort_keys=True).encode()).hexdigest()


def with_submission(key: str, digest: str) -> str:
    """The key of one submission's grade."""
    return hashlib.sha256(f"{key} {digest}".encode()).hexdigest()
