"""Grades many submissions on this machine."""

from __future__ import annotations

import contextlib
import os
import queue
import tempfile
import threading
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path

from grader.classroom.request import GradedSubmission, host_error
from grader.classroom.results import grade_key
from grader.exercise.exercise import ExerciseError
from grader.grading.grading import Grading
from grader.grading.scenario_runner import WorkStealing
from grader.report.feedback_plot import picture
from grader.submission.submission import Submission
from groundwork.files import claim_number

#: How many submissions to grade at once per core; more than one, as the grader and the program wait for each other.
PER_CORE = 2


def at_once() -> int:
    """Return how many submissions to grade at once on this machine."""
    return PER_CORE * len(os.sched_getaffinity(0))


@dataclass(frozen=True)
class LocalBackend:
    """One worker pool on this machine. The scenarios of a submission run one after another, on one core.

    When no more submissions are waiting, an idle worker runs scenarios of those in progress.
    """

    grading: Grading
    jobs: int

    @cached_property
    def key(self) -> str:
        """See `Backend`."""
        return grade_key(self.grading)

    def grade(self, submissions: Mapping[str, Submission]) -> Iterator[GradedSubmission]:
        """See `Backend`."""
        waiting: queue.SimpleQueue[tuple[str, Submission]] = queue.SimpleQueue()
        done: queue.SimpleQueue[GradedSubmission | BaseException] = queue.SimpleQueue()
        for item in submissions.items():
            waiting.put(item)
        given_up, work_stealing = threading.Event(), WorkStealing()
        threads = [
            threading.Thread(target=self._work, args=(number, waiting, done, given_up, work_stealing), daemon=True)
            for number in range(self.jobs if submissions else 0)
        ]
        for thread in threads:
            thread.start()
        try:
            for _ in submissions:
                graded = done.get()
                if isinstance(graded, BaseException):
                    raise graded
                yield graded
        finally:
            given_up.set()
            work_stealing.close()
        for thread in threads:  # by now nothing is in progress
            thread.join()

    def _work(
        self,
        number: int,
        waiting: queue.SimpleQueue[tuple[str, Submission]],
        done: queue.SimpleQueue[GradedSubmission | BaseException],
        given_up: threading.Event,
        work_stealing: WorkStealing,
    ) -> None:
        cores = sorted(os.sched_getaffinity(0))
        core = cores[number % len(cores)]
        options = replace(self.grading.runner.options, parallel=1, core=core)
        grading = replace(
            self.grading, runner=replace(self.grading.runner, options=options, work_stealing=work_stealing)
        )
        while not given_up.is_set():
            try:
                who, submission = waiting.get_nowait()
            except queue.Empty:
                work_stealing.help(core)
                return
            try:
                done.put(_graded(who, grading, submission))
            except BaseException as stopped:  # an error of the exercise's author, or the end of the run
                done.put(stopped)
                return


def _graded(who: str, grading: Grading, submission: Submission) -> GradedSubmission:
    """Grade one submission. A fault in the grader becomes this student's `host-error`; the others are still graded."""
    try:
        grade = grading.grade(submission)
    except ExerciseError:
        raise
    except Exception as error:
        return GradedSubmission(who, host_error(grading.runner, submission, f"{type(error).__name__}: {error}"), None)
    return GradedSubmission(who, grade, picture(grade, grading.runner.exercise))


@contextlib.contextmanager
def own_core() -> Iterator[int]:
    """Yield the CPU with the lowest number that no other grading on this machine has reserved."""
    folder = Path(tempfile.gettempdir()) / f"spinbook-cores-{os.getuid()}"
    folder.mkdir(mode=0o700, exist_ok=True)
    cores = sorted(os.sched_getaffinity(0))
    claimed = claim_number(folder, range(1024))
    if claimed is None:
        yield cores[0]
        return
    number, lock = claimed
    try:
        yield cores[number % len(cores)]
    finally:
        os.close(lock)
