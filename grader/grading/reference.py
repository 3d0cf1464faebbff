"""The solution's recordings, against which students' are compared: made once, then kept."""

from __future__ import annotations

import contextlib
import hashlib
import json
import os
import re
import tempfile
from pathlib import Path

from grader.checking.proofreading import line_with, points_that_do_not_add_up, same_name_twice
from grader.checking.verdict import Verdict
from grader.crew.jobs import JudgeJob
from grader.exercise import Exercise, ExerciseError
from grader.exercise.starter import MarkError, starter
from grader.grading.spinning import Spinner
from grader.grading.versions import digest_of, versions
from grader.recording import Recording
from grader.recording.store import from_json, to_json
from grader.submission.reading import of_source
from interface_compiler import activation


def reference(spinner: Spinner) -> dict[str, Recording]:
    """The solution's recordings, by scenario.

    They are made when anything that they depend on has changed; then the exercise itself is put to the test: the
    solution must pass every check and the points must add up. Raises `ExerciseError` where they do not.
    """
    kept = _kept_in(spinner)
    try:
        return from_json(kept.read_text(encoding="utf-8"))
    except (OSError, ValueError, KeyError, TypeError):
        pass
    recordings = _made(spinner)
    _prove(spinner, recordings)
    with contextlib.suppress(OSError):  # where nothing can be kept, it is made anew each time
        _keep(recordings, kept)
    return recordings


def _keep(recordings: dict[str, Recording], file: Path) -> None:
    file.parent.mkdir(parents=True, exist_ok=True)
    with tempfile.NamedTemporaryFile("w", encoding="utf-8", dir=file.parent, delete=False) as temporary:
        temporary.write(to_json(recordings))
    Path(temporary.name).replace(file)


def cache_folder() -> Path:
    """Where the solution's recordings are kept: `SPINBOOK_CACHE`, else the user's cache folder."""
    if given := os.environ.get("SPINBOOK_CACHE"):
        return Path(given) / "reference"
    base = os.environ.get("XDG_CACHE_HOME") or Path("~/.cache").expanduser()
    return Path(base) / "spinbook" / "reference"


def solution_file(exercise: Exercise) -> Path:
    """The author's solution. Raises `ExerciseError` when there is none."""
    file = exercise.solution_file
    if not file or not file.exists():
        expected = exercise.folder.parent.parent / "solutions" / exercise.name / "solution.py"
        raise ExerciseError(expected, "there is no such file", "The checks compare with the solution; write it here.")
    return file


def key_of(spinner: Spinner) -> str:
    """A digest of everything that gradings by `spinner` depend on, but for the submissions."""
    exercise = spinner.exercise
    key = {
        "solution": digest_of([solution_file(exercise)]),
        "exercise": digest_of([exercise.folder / "exercise.toml", *exercise.check_files]),
        "scenarios": [scenario.digest for scenario in spinner.scenarios],
        "versions": versions(spinner.middleware),
        "interfaces": [prefix.name for prefix in activation.active()],
        "pace": spinner.options.pace,
    }
    return hashlib.sha256(json.dumps(key, sort_keys=True).encode()).hexdigest()


def _kept_in(spinner: Spinner) -> Path:
    return cache_folder() / f"{spinner.exercise.name}-{key_of(spinner)[:24]}.json"


def _made(spinner: Spinner) -> dict[str, Recording]:
    file = solution_file(spinner.exercise)
    code = file.read_bytes()
    try:
        starter(code.decode("utf-8"))
    except MarkError as error:
        raise ExerciseError(file, str(error), "Put every mark in order; the starter is made from them.") from None
    recordings = spinner.spin(of_source("the solution", code, spinner.exercise))
    for recording in recordings.values():
        ending = recording.ending
        if ending.outcome != "completed":
            found = f"the solution does not come through the scenario {recording.scenario}: {ending.story}"
            raise ExerciseError(file, found, "Mend the solution or the scenario.", ending.line)
    return recordings


def _prove(spinner: Spinner, recordings: dict[str, Recording]) -> None:
    exercise = spinner.exercise
    titles = {scenario.name: scenario.title for scenario in spinner.scenarios}
    verdicts: tuple[Verdict, ...] = spinner.crew.do(JudgeJob(exercise, recordings, recordings, titles))
    for verdict in verdicts:
        file = exercise.folder / ("hidden_checks.py" if verdict.hidden else "checks.py")
        line = line_with(file, rf"def {re.escape(verdict.name)}\b")
        if verdict.status == "error":
            raise ExerciseError(file, f"the check {verdict.name} breaks: {verdict.error}", "Fix the check.", line)
        if verdict.status == "failed":
            told = verdict.finding.text if verdict.finding else ""
            found = f"the solution does not pass the check {verdict.name}: {told}"
            raise ExerciseError(file, found, "Fix the check or the solution.", line)
    for file in exercise.check_files:
        for fault in same_name_twice(file):
            raise fault
    for fault in points_that_do_not_add_up(exercise, [(verdict.hidden, verdict.points) for verdict in verdicts]):
        raise fault
