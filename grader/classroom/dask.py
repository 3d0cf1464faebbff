"""Grades submissions on a Dask cluster."""

from __future__ import annotations

import contextlib
import hashlib
import tempfile
import threading
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING

from grader.classroom.local import own_core
from grader.classroom.request import GradedSubmission, NoCluster, host_error
from grader.classroom.results import grade_key
from grader.exercise.exercise import Exercise
from grader.exercise.loading import COURSE, load
from grader.grading.grade import Options
from grader.grading.grading import Grading, grading_of
from grader.grading.reference import versions
from grader.report.feedback_plot import picture
from grader.sandbox.middleware import require_middleware
from grader.submission.submission import Submission
from grader.workers.pool import WorkerPool
from groundwork.files import cached, write_if_changed
from interface_compiler.near import CURRENT, STORE, current

if TYPE_CHECKING:
    from distributed import Client


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


@dataclass(frozen=True)
class PreparedGrading:
    """One exercise, prepared for grading. Close `resources` when it is no longer needed."""

    grading: Grading
    key: str
    resources: contextlib.ExitStack


_ready: dict[str, PreparedGrading] = {}
_lock = threading.Lock()


def describe_worker() -> dict[str, str]:
    """Return the versions on this worker that grades depend on. Raises `MiddlewareUnavailable`."""
    require_middleware()
    return versions()


def grade_on_worker(
    packed: ExerciseFiles, options: Options, key: str, who: str, submission: Submission
) -> GradedSubmission:
    """Return one submission's grade, without recordings, and its plot.

    `key` is the caller's `grade_key`. If this worker's key differs, the result is a `host-error` that says so.
    """
    bench = _prepared_grading(packed, options)
    runner = bench.grading.runner
    if bench.key != key:
        text = f"a worker of the cluster has other versions than this machine: {versions()}"
        return GradedSubmission(who, host_error(runner, submission, text), None)
    with own_core() as core:
        runner = replace(runner, options=replace(options, parallel=1, core=core))
        grade = replace(bench.grading, runner=runner).grade(submission)
    return GradedSubmission(who, replace(grade, recordings={}, references={}), picture(grade, runner.exercise))


def _prepared_grading(packed: ExerciseFiles, options: Options) -> PreparedGrading:
    """Return the prepared exercise. The first task prepares it for all that follow; only the newest one is kept."""
    name = f"{packed.digest} {options}"
    with _lock:
        if name not in _ready:
            while _ready:
                _ready.popitem()[1].resources.close()
            with contextlib.ExitStack() as resources:
                folder = resources.enter_context(tempfile.TemporaryDirectory(prefix="spinbook-exercise-"))
                exercise = load(packed.unpack(Path(folder)))  # before the workers start: they use its interfaces, too
                workers = resources.enter_context(WorkerPool())
                grading = grading_of(exercise, options, workers)
                _ready[name] = PreparedGrading(grading, grade_key(grading), resources.pop_all())
        return _ready[name]


# Every worker has the same versions of Spinbook and of ROS 2, and gets the exercise with its first task. For how
# `dask.distributed` handles the tasks of a worker that died, see
# https://distributed.dask.org/en/stable/resilience.html.


#: How long to wait for the scheduler's answer, and then for its first worker (s).
SCHEDULER_S, WORKER_S = 10.0, 60.0


@dataclass(frozen=True)
class DaskBackend:
    """The workers of one scheduler. Each grades as many submissions at once as it has threads."""

    grading: Grading
    client: Client

    @property
    def key(self) -> str:
        """See `Backend`."""
        return grade_key(self.grading)

    def grade(self, submissions: Mapping[str, Submission]) -> Iterator[GradedSubmission]:
        """See `Backend`. If a worker dies, its submission is tried again; after four deaths it is a `host-error`."""
        from distributed import as_completed

        if not submissions:
            return
        runner = self.grading.runner
        packed = pack_exercise(runner.exercise)
        asked = {
            self.client.submit(grade_on_worker, packed, runner.options, self.key, who, submission, pure=False): who
            for who, submission in submissions.items()
        }
        try:
            for future in as_completed(list(asked), loop=self.client.loop):
                who = asked[future]
                error = future.exception()
                if error is None:
                    yield future.result()
                else:
                    text = f"the cluster could not grade it: {type(error).__name__}: {error}"
                    grade = host_error(runner, submissions[who], text)
                    yield GradedSubmission(who, grade, None)
        finally:
            self.client.cancel(list(asked))


@contextlib.contextmanager
def dask_backend(grading: Grading, address: str) -> Iterator[DaskBackend]:
    """Yield the cluster whose scheduler is at `address`, such as tcp://10.0.0.5:8786. It has at least one worker.

    Raises `NoCluster` if there is none, or if a worker's versions differ from this machine's.
    """
    try:
        from distributed import Client
    except ImportError:
        raise NoCluster("Dask is not installed here: pip install 'spinbook[cluster]'") from None
    try:
        client = Client(address, timeout=SCHEDULER_S, set_as_default=False)
    except (OSError, ValueError, TimeoutError) as error:
        text = str(error).splitlines()[0] if str(error) else type(error).__name__
        raise NoCluster(f"--scheduler {address}: no Dask scheduler answers there: {text}") from None
    with client:
        try:
            client.wait_for_workers(1, timeout=WORKER_S)
        except TimeoutError:
            raise NoCluster(f"--scheduler {address}: it has no worker. Start some: dask worker {address}") from None
        _same_versions(versions(), client.run(describe_worker, on_error="return"))
        yield DaskBackend(grading, client)


def _same_versions(ours: Mapping[str, str], text: Mapping[str, object]) -> None:
    for worker, theirs in sorted(text.items()):
        if not isinstance(theirs, dict):
            raise NoCluster(f"The worker {worker} can't grade: {type(theirs).__name__}: {theirs}")
        if differs := [
            f"{name} {theirs.get(name)}, here {ours[name]}" for name in ours if theirs.get(name) != ours[name]
        ]:
            raise NoCluster(
                f"The worker {worker} has other versions: {'; '.join(differs)}. Install the same versions there."
            )
