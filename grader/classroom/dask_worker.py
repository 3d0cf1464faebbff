"""Grades submissions on a worker of a Dask cluster."""

from __future__ import annotations

import contextlib
import hashlib
import tempfile
import threading
import time
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import NoReturn

from grader.classroom.local import own_core
from grader.classroom.request import GradedSubmission, host_error
from grader.classroom.results import grade_key
from grader.exercise.exercise import Exercise
from grader.exercise.loading import COURSE, load
from grader.grading.grade import Options
from grader.grading.grading import Grading, grading_of
from grader.grading.reference import versions
from grader.report.feedback_plot import picture
from grader.sandbox.isolation import choose
from grader.sandbox.middleware import MiddlewareUnavailable, require_middleware
from grader.sandbox.program import SandboxUnavailable
from grader.submission.submission import Submission
from grader.workers.pool import WorkerPool
from groundwork.files import cached, write_if_changed
from interface_compiler.near import CURRENT, STORE, current

#: What tells the commands that are grading that a worker has left the cluster: a topic of Dask's events.
LEFT = "spinbook-left"

#: After this time without a submission, a worker forgets an exercise with its solution and hidden checks (s).
UNUSED_S = 60.0


@dataclass(frozen=True)
class ExerciseFiles:
    """The files that grading needs, by path inside the course's folder.

    `interfaces` are those that were compiled for the course, by path inside their prefix, which is called `prefix`.
    """

    exercise: str
    files: dict[str, bytes]
    prefix: str = ""
    interfaces: dict[str, bytes] = field(default_factory=dict)

    @property
    def digest(self) -> str:
        """The SHA-256 of all names and contents."""
        total = hashlib.sha256(self.exercise.encode())
        for name, content in (*sorted(self.files.items()), *sorted(self.interfaces.items())):
            total.update(f"{name} {len(content)}\n".encode())
            total.update(content)
        return total.hexdigest()

    def unpack(self, into: Path) -> Path:
        """Write the files into the folder `into`; return the exercise's folder."""
        _write(into, self.files)
        if self.prefix:
            store = self._keep_interfaces()
            (into / STORE).parent.mkdir(parents=True)
            (into / STORE).symlink_to(store)
        return into / "exercises" / self.exercise

    def _keep_interfaces(self) -> Path:
        """Write the interfaces where they stay: Python has loaded them when the next exercise needs them."""
        store = cached("cluster-interfaces") / self.prefix
        if not (store / CURRENT).is_file():
            _write(store / self.prefix, self.interfaces)
            write_if_changed(store / CURRENT, self.prefix)
        return store


def _write(into: Path, files: Mapping[str, bytes]) -> None:
    for name, content in files.items():
        file = into / name
        file.parent.mkdir(parents=True, exist_ok=True)
        write_if_changed(file, content)


def pack_exercise(exercise: Exercise) -> ExerciseFiles:
    """Return the exercise's folder, the author's solution, and the interfaces that were compiled for the course."""
    name = exercise.name
    found = [file for file in sorted(exercise.folder.rglob("*")) if file.is_file() and "__pycache__" not in file.parts]
    files = {f"exercises/{name}/{file.relative_to(exercise.folder).as_posix()}": file.read_bytes() for file in found}
    if exercise.solution_file:
        files[f"solutions/{name}/solution.py"] = exercise.solution_file.read_bytes()
    course = next((folder for folder in exercise.folder.parents if (folder / COURSE).is_file()), None)
    prefix = current(course / STORE) if course else None
    if prefix is None:
        return ExerciseFiles(name, files)
    inside = (file for file in sorted(prefix.rglob("*")) if file.is_file() and "__pycache__" not in file.parts)
    interfaces = {file.relative_to(prefix).as_posix(): file.read_bytes() for file in inside}
    return ExerciseFiles(name, {**files, COURSE: b""}, prefix.name, interfaces)


@dataclass
class PreparedGrading:
    """One exercise, prepared for grading. Close `resources` when nobody has used it for some time."""

    grading: Grading
    key: str
    resources: contextlib.ExitStack
    users: int = 0
    last_used: float = 0.0


_ready: dict[str, PreparedGrading] = {}
_lock = threading.Lock()


def describe_worker(options: Options) -> dict[str, str]:
    """Return what grades depend on besides the exercise: versions, and the level of the sandbox.

    Raises `MiddlewareUnavailable` and `SandboxUnavailable`.
    """
    require_middleware()
    return {**versions(), "sandbox": str(choose(options.isolation))}


def differences(ours: Mapping[str, str], theirs: Mapping[str, str]) -> str:
    """Return what is different on a worker, such as `python 3.12.1, here 3.11.2`; empty if nothing is."""
    return "; ".join(f"{name} {theirs.get(name)}, here {ours[name]}" for name in ours if theirs.get(name) != ours[name])


def grade_on_worker(
    packed: ExerciseFiles, options: Options, ours: Mapping[str, str], key: str, who: str, submission: Submission
) -> GradedSubmission:
    """Return one submission's grade, without recordings, and its plot.

    `ours` describes the caller, as `describe_worker` does. A worker that differs or can't grade leaves the cluster: it
    joined later. `key` is the caller's `grade_key`. If this worker's key differs, the result is a `host-error`.
    """
    try:
        if differs := differences(ours, describe_worker(options)):
            _leave(f"it differs: {differs}")
    except (MiddlewareUnavailable, SandboxUnavailable) as error:
        _leave(f"it can't grade: {str(error).rstrip('.')}")
    with contextlib.ExitStack() as prepared:
        try:
            bench = prepared.enter_context(_prepared(packed, options))
        except Exception as error:  # it would take all submissions, and grade none: its disk is full, for example
            _leave(f"it can't grade: {type(error).__name__}: {error}")
        core = prepared.enter_context(own_core())
        runner = bench.grading.runner
        if bench.key != key:
            text = "a worker of the cluster has read the exercise differently: its files or limits are not the same"
            return GradedSubmission(who, host_error(runner, submission, text), None)
        runner = replace(runner, options=replace(options, parallel=1, core=core))
        grade = replace(bench.grading, runner=runner).grade(submission)
        return GradedSubmission(who, replace(grade, recordings={}, references={}), picture(grade, runner.exercise))


def _leave(why: str) -> NoReturn:
    """Take this worker out of the cluster, and give its submission to another one."""
    from distributed import Reschedule, get_worker

    worker = get_worker()
    worker.log_event(LEFT, f"The worker {worker.address} has left the cluster, because {why}.")
    worker.loop.add_callback(worker.close_gracefully)
    raise Reschedule


@contextlib.contextmanager
def _prepared(packed: ExerciseFiles, options: Options) -> Iterator[PreparedGrading]:
    """Yield the prepared exercise. The first task prepares it for all that follow."""
    name = f"{packed.digest} {options}"
    with _lock:
        if name not in _ready:
            _ready[name] = _prepare(packed, options)
        bench = _ready[name]
        bench.users += 1
    try:
        yield bench
    finally:
        with _lock:
            bench.users, bench.last_used = bench.users - 1, time.monotonic()
            if not bench.users:
                timer = threading.Timer(UNUSED_S, close_unused)
                timer.daemon = True
                timer.start()


def _prepare(packed: ExerciseFiles, options: Options) -> PreparedGrading:
    with contextlib.ExitStack() as resources:
        folder = Path(resources.enter_context(tempfile.TemporaryDirectory(prefix="spinbook-exercise-")))
        exercise = load(packed.unpack(folder))  # before the workers start: they use its interfaces, too
        grading = grading_of(exercise, options, resources.enter_context(WorkerPool(folder)))
        return PreparedGrading(grading, grade_key(grading), resources.pop_all())


def close_unused(unused_s: float = UNUSED_S) -> None:
    """Forget the exercises that nobody has used for this time, with their files."""
    with _lock:
        for name, bench in list(_ready.items()):
            if not bench.users and time.monotonic() - bench.last_used >= unused_s:
                _ready.pop(name).resources.close()
