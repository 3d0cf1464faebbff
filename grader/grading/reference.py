"""The solution's recordings, made once and stored, and everything that a grade depends on besides the submission."""

from __future__ import annotations

import hashlib
import json
import platform
import re
from dataclasses import replace
from functools import cache
from pathlib import Path

import ros_in_python
from grader.exercise.data_files import data_paths
from grader.exercise.exercise import Exercise, ExerciseError
from grader.exercise.imported_files import with_modules
from grader.exercise.starter import MarkerError, starter
from grader.grading.machine import machine_key
from grader.grading.scenario_runner import ScenarioRunner
from grader.recording.recording import Recording, from_json, to_json
from grader.submission.reader import of_source
from grader.workers.pool import HostFault
from groundwork.files import cached, keep, read_kept
from groundwork.installed import version_of
from interface_compiler import activation
from rmw_lockstep.library import SOURCES, sources

GRADER = Path(__file__).parents[1]


@cache
def versions() -> dict[str, str]:
    """Return the versions of Python and ROS, and digests of all source of ours that a program or its judging uses."""
    return {
        "python": platform.python_version(),
        "rclpy": version_of("ros-jazzy-rclpy", "rclpy", otherwise="unknown"),
        "rmw": digest_of([*sources(), *sorted(SOURCES.rglob("*.py"))])[:12],
        "grader": digest_of(sorted(GRADER.rglob("*.py")))[:12],
        "ros_in_python": digest_of(sorted(Path(ros_in_python.__file__).parent.rglob("*.py")))[:12],
    }


def digest_of(files: list[Path], folder: Path | None = None) -> str:
    """Return the SHA-256 of these files' names, or their paths in `folder`, and contents, in this order."""
    total = hashlib.sha256()
    for file in files:
        content = file.read_bytes()
        total.update(f"{file.relative_to(folder) if folder else file.name} {len(content)}\n".encode())
        total.update(content)
    return total.hexdigest()


def exercise_digest(exercise: Exercise) -> str:
    """Return a digest of what decides a grade, besides the scenarios and the solution: not the task or the deadline."""
    settings = repr(replace(exercise, folder=Path(), solution_folder=None, task=""))
    checks, data = digest_of([*with_modules(exercise.check_files)]), digest_of(data_paths(exercise), exercise.folder)
    return hashlib.sha256(f"{settings} {checks} {data}".encode()).hexdigest()


def reference(runner: ScenarioRunner) -> dict[str, Recording]:
    """Return the solution's recordings, by scenario.

    They are made again when anything that they depend on has changed, the machine included; then the exercise itself is
    tested: the solution must pass every check and the points must add up. Raises `ExerciseError` otherwise, or
    `HostFault` if the same solution has passed before, so that no student pays for what has changed since.
    """
    of_exercise = f"{runner.exercise.name}-{reference_key(runner)[:24]}"
    kept = cache_folder() / f"{of_exercise}-{machine_key(runner.isolation)[:12]}.json"
    if stored := read_kept(kept, from_json):
        return stored
    try:
        recordings = _made(runner)
        _prove(runner, recordings)
    except ExerciseError as error:
        if not any(cache_folder().glob(f"{of_exercise}-*.json")):
            raise
        raise HostFault(
            f"the solution of {runner.exercise.name} got full marks here before, and no longer does: "
            f"{error.problem.problem}. Python, its packages, the sandbox or the machine have changed since: "
            "run spinbook doctor"
        ) from None
    keep(kept, to_json(recordings))
    return recordings


def cache_folder() -> Path:
    """Return the folder of the solution's recordings."""
    return cached("reference")


def solution_file(exercise: Exercise) -> Path:
    """Return the author's solution. Raises `ExerciseError` when there is none."""
    file = exercise.solution_file
    if not file or not file.exists():
        expected = exercise.folder.parent.parent / "solutions" / exercise.name / "solution.py"
        raise ExerciseError(expected, "there is no such file", "The checks compare with the solution; write it here.")
    return file


def reference_key(runner: ScenarioRunner) -> str:
    """Return a digest of everything that gradings by `runner` depend on, except the submissions."""
    exercise = runner.exercise
    key = {
        "solution": digest_of([solution_file(exercise)]),
        "exercise": exercise_digest(exercise),
        "scenarios": [scenario.digest for scenario in runner.scenarios],
        "versions": versions(),
        "interfaces": [prefix.name for prefix in activation.active()],
        "pace": runner.options.pace,
    }
    return hashlib.sha256(json.dumps(key, sort_keys=True).encode()).hexdigest()


def _made(runner: ScenarioRunner) -> dict[str, Recording]:
    file = solution_file(runner.exercise)
    code = file.read_bytes()
    try:
        starter(code.decode("utf-8"))
    except MarkerError as error:
        raise ExerciseError(file, str(error), "Fix the markers; the starter is made from them.") from None
    recordings = runner.run(of_source("the solution", code, runner.exercise))
    for recording in recordings.values():
        ending = recording.ending
        if ending.outcome != "completed":
            problem = f"the solution does not complete the scenario {recording.scenario}: {ending.message}"
            fix = f"Fix the solution or the scenario. {_see_it(runner.exercise, recording.scenario)}"
            raise ExerciseError(file, problem, fix, ending.line)
    return recordings


def _see_it(exercise: Exercise, scenario: str) -> str:
    return f"See what it did: spinbook trace {exercise.name}{f' --scenario {scenario}' if scenario else ''} --log"


def _prove(runner: ScenarioRunner, recordings: dict[str, Recording]) -> None:
    from grader.checking.proofreader import line_with, points_that_do_not_add_up, same_name_twice

    exercise = runner.exercise
    verdicts = runner.judge(recordings, recordings)
    for verdict in verdicts:
        file = exercise.folder / ("hidden_checks.py" if verdict.hidden else "checks.py")
        line = line_with(file, rf"(?:async )?def {re.escape(verdict.name)}\b")
        if verdict.status == "error":
            fix = "Fix the check, or the scenario that it is about."
            raise ExerciseError(file, f"the check {verdict.name} breaks: {verdict.error}", fix, line)
        if verdict.status == "failed":
            message = verdict.finding.text if verdict.finding else ""
            problem = f"the solution does not pass the check {verdict.name}: {message}"
            scenario = verdict.finding.scenario if verdict.finding else ""
            raise ExerciseError(file, problem, f"Fix the check or the solution. {_see_it(exercise, scenario)}", line)
    for file in exercise.check_files:
        for fault in same_name_twice(file):
            raise fault
    for fault in points_that_do_not_add_up(exercise, [(verdict.hidden, verdict.points) for verdict in verdicts]):
        raise fault
