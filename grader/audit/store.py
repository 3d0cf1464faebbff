"""Keeps the results of audits: what programs published, and how they were judged.

After a change to a check, no program has to run again. A program is judged again only if something that its verdict
depends on has changed.
"""

from __future__ import annotations

import contextlib
import dataclasses
import gzip
import hashlib
import json
import os
import threading
import time
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any

from grader.audit.result import Trial
from grader.grading.grading import Grading
from grader.grading.reference import GRADER, cache_folder, digest_of, exercise_digest, solution_file, versions
from grader.grading.scenario_runner import ScenarioRunner
from grader.recording.recording import Recording, from_json, to_json
from grader.scenario.scenario import Scenario
from grader.submission.submission import Submission
from grader.workers.pool import Worker
from groundwork.files import keep, read_kept
from groundwork.plain_data import restored

#: The parts of the grader that decide what a recording contains.
RECORDING = ("workers", "exercise", "recording", "runner", "sandbox", "scenario", "submission")
RECORDING_FILES = ("grading/scenario_runner.py",)

#: What decides a trial, besides what decides a recording.
JUDGING = ("checking", "audit/trial.py", "audit/check_list.py")

#: Entries that were not used for this long are deleted.
KEPT_DAYS = 30

#: A program that logs more than this is run each time.
LONGEST_LOG = 20_000


class AuditStopped(Exception):
    """Raised instead of a recording when the audit must end at once."""


class RecordedRuns:
    """The stored recordings of one exercise's programs. Once `stopped` is set, no more are made."""

    def __init__(self, grading: Grading) -> None:
        self.stopped = threading.Event()
        self._grading = grading
        self._folder = audit_folder(grading.runner.exercise.name)

    def process(self) -> Worker:
        """Return a process for the runs of one program, so that what it loads for one run is there for the next."""
        return self._grading.runner.workers.reserve()

    def run(self, submission: Submission, scenario: Scenario, turn: int, process: Worker) -> Recording:
        """Return the recording of a program in one scenario, stored or made now; `turn` chooses the core that it runs
        on.

        Raises `HostFault` if the machine or the grader is at fault, and `AuditStopped` once the audit is stopped.
        """
        runner = self._grading.runner
        made_by = (str(runner.isolation), engine())
        exercise = runner.exercise
        interface = (exercise.topics, exercise.endpoints, exercise.parameters, exercise.programs, exercise.node_name)
        key = (submission.digest, scenario.digest, interface, exercise.reference_node, *made_by)
        file = self._folder / f"{hashlib.sha256(repr(key).encode()).hexdigest()[:32]}.run.gz"
        kept = read_kept(file, lambda content: from_json(gzip.decompress(content))[scenario.name])
        if kept:
            _used(file)
            return kept
        recording: Recording | None = process.do(runner.job(submission, scenario, turn), self.stopped)
        if recording is None:
            raise AuditStopped
        if len(recording.log) <= LONGEST_LOG:
            keep(file, gzip.compress(to_json({scenario.name: recording}).encode(), 5))
        return recording


def audit_folder(exercise: str) -> Path:
    """Return the folder in which an exercise's audits keep their results."""
    return cache_folder().parent / "audit" / exercise


def _used(file: Path) -> None:
    """Note that a file is still of use: see `tidy`."""
    with contextlib.suppress(OSError):
        file.touch()


def tidy(exercise: str) -> None:
    """Delete entries that have not been used for a long time."""
    oldest = time.time() - KEPT_DAYS * 24 * 3600
    with contextlib.suppress(OSError):
        for entry in os.scandir(audit_folder(exercise)):
            if entry.stat().st_mtime < oldest:
                Path(entry.path).unlink(missing_ok=True)


@cache
def engine(also: tuple[str, ...] = ()) -> str:
    """Return a digest of our code that decides what a recording contains, and of the versions of Python, ROS and the
    middleware.

    `also` names further files and folders, by their paths below grader/.
    """
    named = [GRADER / name for name in (*RECORDING_FILES, *RECORDING, *also)]
    files = [file for path in named for file in (sorted(path.rglob("*.py")) if path.is_dir() else [path])]
    others = {name: version for name, version in versions().items() if name != "grader"}
    return f"{digest_of(files)} {json.dumps(others, sort_keys=True)}"


class Store:
    """The stored trials of one exercise. `made` and `kept` count those made now and those reused."""

    def __init__(self, runner: ScenarioRunner) -> None:
        exercise = runner.exercise
        self._folder = audit_folder(exercise.name)
        self._common = {
            "solution": digest_of([solution_file(exercise)]),
            "exercise": exercise_digest(exercise),
            "scenarios": [scenario.digest for scenario in runner.scenarios],
            "engine": engine(JUDGING),
            "isolation": str(runner.isolation),
        }
        self._lock = threading.Lock()
        self.made = 0
        self.kept = 0

    def trial(self, key: dict[str, Any], make: Callable[[], Trial]) -> Trial:
        """Return the trial for `key`, stored or made now."""
        text = json.dumps({**self._common, **key}, sort_keys=True)
        file = self._folder / f"{hashlib.sha256(text.encode()).hexdigest()[:32]}.json"
        kept = read_kept(file, lambda content: restored(Trial, json.loads(content)))
        with self._lock:
            self.kept += bool(kept)
            self.made += not kept
        if kept:
            _used(file)
            return kept
        trial = make()
        keep(file, json.dumps(dataclasses.asdict(trial)))
        return trial
