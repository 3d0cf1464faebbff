"""Grades a class on a Dask cluster."""

from __future__ import annotations

import contextlib
import logging
import queue
import warnings
from collections.abc import Callable, Iterable, Iterator, Mapping, Set
from concurrent.futures import CancelledError
from dataclasses import dataclass, field
from typing import Any

from distributed import Client, Future, Scheduler, TimeoutError  # before Python 3.11 not the built-in one
from distributed.versions import VersionMismatchWarning

from grader.classroom.dask_worker import (
    LEFT,
    ExerciseFiles,
    describe_worker,
    differences,
    grade_on_worker,
    pack_exercise,
)
from grader.classroom.request import ClusterLost, GradedSubmission, NoCluster, host_error
from grader.classroom.results import grade_key
from grader.grading.grading import Grading
from grader.grading.reference import versions
from grader.sandbox.program import SandboxUnavailable
from grader.submission.submission import Submission
from groundwork.words import counted

# Every worker has the same versions of Spinbook and of ROS 2, and gets the exercise with its first task. For how
# `dask.distributed` handles the tasks of a worker that died, see
# https://distributed.dask.org/en/stable/resilience.html.

#: How long to wait for the scheduler's answer (s).
SCHEDULER_S = 10.0

#: Without news for this time, the command looks at the cluster and says what it waits for (s).
LOOK_S = 10.0

#: After this many looks without a first worker, or without a sign of life, the cluster or the worker is given up.
SILENT_LOOKS = 6

LOST = "The connection to the scheduler is lost."


@dataclass
class ClusterWatch:
    """Looks at the cluster while no results come, tells the instructor, and removes workers that have fallen silent.

    It counts looks, not seconds, as a busy computer may have held this process for as long as a worker.
    """

    client: Client
    say: Callable[[str], None]
    unanswered: int = 0
    """How many looks the scheduler has left without an answer."""
    seen: dict[str, tuple[float, int]] = field(default_factory=dict)
    """By worker: its last sign of life by the scheduler's clock, and how many looks that has been the last one."""

    def look(self, waiting: int) -> None:
        """Say what the command waits for. Raises `ClusterLost`."""
        workers = self._workers()
        if workers is None:
            return
        self.seen = {worker: self._looks(worker, info["last_seen"]) for worker, info in workers.items()}
        silent = [worker for worker, (_, looks) in self.seen.items() if looks >= SILENT_LOOKS]
        if silent:
            remove_workers(self.client, silent)
            self.say(f"No sign of life for {SILENT_LOOKS * LOOK_S:g} s, so others take over: {', '.join(silent)}.")
        self._say_what_is_awaited(waiting, self.seen.keys() - silent)

    def _looks(self, worker: str, sign: float) -> tuple[float, int]:
        last, looks = self.seen.get(worker, (None, 0))
        return sign, looks + 1 if sign == last else 0

    def _say_what_is_awaited(self, waiting: int, workers: Set[str]) -> None:
        on = counted(len(workers), "worker") if workers else "a worker to join"
        quiet = {worker: self.seen[worker][1] * LOOK_S for worker in sorted(workers) if self.seen[worker][1]}
        silent = "".join(f" {worker} has been silent for {quiet_s:g} s." for worker, quiet_s in quiet.items())
        self.say(f"Waiting for {counted(waiting, 'submission')} on {on}.{silent}")

    def _workers(self) -> Mapping[str, Any] | None:
        """Return what the scheduler knows of its workers, by address; None if it does not answer at the moment."""
        try:
            info = self.client.sync(self._identity, callback_timeout=LOOK_S)
        except (OSError, TimeoutError):
            self.unanswered += 1
            if self.unanswered >= SILENT_LOOKS:
                raise ClusterLost("The scheduler does not answer any more.") from None
            self.say("The scheduler does not answer. Waiting for it.")
            return None
        self.unanswered = 0
        workers: Mapping[str, Any] = info["workers"]
        return workers

    async def _identity(self) -> Any:
        assert self.client.scheduler
        return await self.client.scheduler.identity(n_workers=-1)


def remove_workers(client: Client, addresses: list[str]) -> None:
    """Let the scheduler forget these workers, so that others get their submissions."""

    async def remove(dask_scheduler: Scheduler) -> None:
        for address in addresses:
            await dask_scheduler.remove_worker(address, stimulus_id="spinbook-silent")

    client.run_on_scheduler(remove)


@dataclass(frozen=True)
class DaskBackend:
    """The workers of one scheduler. Each grades as many submissions at once as it has threads."""

    grading: Grading
    client: Client
    say: Callable[[str], None]

    @property
    def key(self) -> str:
        """See `Backend`."""
        return grade_key(self.grading)

    def grade(self, submissions: Mapping[str, Submission]) -> Iterator[GradedSubmission]:
        """See `Backend`. If a worker dies, its submission is tried again; after four deaths it is a `host-error`.

        Raises `ClusterLost` when the scheduler is gone.
        """
        runner = self.grading.runner
        # A task of its own, so that the scheduler holds it once, and a worker can get it after another's death.
        packed = self.client.submit(ExerciseFiles, **vars(pack_exercise(runner.exercise)), pure=False)
        task = (packed, runner.options, _of_this_machine(self.grading), self.key)
        asked = {
            self.client.submit(grade_on_worker, *task, who, submission, pure=False): who
            for who, submission in submissions.items()
        }
        done = _as_they_end(asked)
        try:
            while asked:
                future = self._next(done, len(asked))
                who = asked.pop(future)
                yield self._result(future, who, submissions[who])
        finally:
            for future in asked:
                future.release()

    def _next(self, done: queue.SimpleQueue[Future[Any]], waiting: int) -> Future[Any]:
        watch = ClusterWatch(self.client, self.say)
        while True:
            try:
                return done.get(timeout=LOOK_S)
            except queue.Empty:
                watch.look(waiting)

    def _result(self, future: Future[Any], who: str, submission: Submission) -> GradedSubmission:
        if future.cancelled():
            raise ClusterLost(LOST)
        error = future.exception()
        if error is None:
            graded: GradedSubmission = future.result()
            return graded
        text = f"the cluster could not grade it: {type(error).__name__}: {error}"
        return GradedSubmission(who, host_error(self.grading.runner, submission, text), None)


def _as_they_end(futures: Iterable[Future[Any]]) -> queue.SimpleQueue[Future[Any]]:
    done: queue.SimpleQueue[Future[Any]] = queue.SimpleQueue()
    for future in futures:
        future.add_done_callback(done.put)
    return done


def _of_this_machine(grading: Grading) -> dict[str, str]:
    return {**versions(), "sandbox": str(grading.runner.isolation)}


@contextlib.contextmanager
def dask_backend(grading: Grading, address: str, say: Callable[[str], None]) -> Iterator[DaskBackend]:
    """Yield the cluster whose scheduler is at `address`, such as tcp://10.0.0.5:8786. It has at least one worker.

    `say` tells the instructor about the cluster. Raises `NoCluster` if there is none, or if a worker's versions or
    sandbox differ from this machine's, and `ClusterLost` when the scheduler is gone.
    """
    for name in ("distributed", "distributed.client"):
        logging.getLogger(name).setLevel(logging.CRITICAL + 1)  # what it logs, with tracebacks, is said here
    try:
        with warnings.catch_warnings(record=True) as caught:
            client = Client(address, timeout=SCHEDULER_S, set_as_default=False)
    except (OSError, ValueError, TypeError, RuntimeError, TimeoutError) as error:
        text = str(error).splitlines()[0] if str(error) else type(error).__name__
        raise NoCluster(f"--scheduler {address}: no Dask scheduler answers there: {text}") from None
    if any(issubclass(warning.category, VersionMismatchWarning) for warning in caught):
        say("Versions of Dask or Python differ in the cluster. If grading fails, install the same everywhere.")
    with client:
        try:
            _wait_for_a_worker(client, address, say)
            _check_workers(client, grading, say)
            client.subscribe_topic(LEFT, lambda event: say(event[1]))
        except (OSError, CancelledError):
            raise ClusterLost(LOST) from None
        yield DaskBackend(grading, client, say)


def _wait_for_a_worker(client: Client, address: str, say: Callable[[str], None]) -> None:
    for _ in range(SILENT_LOOKS):
        try:
            return client.wait_for_workers(1, timeout=LOOK_S)
        except TimeoutError:
            say(f"Waiting for a worker to join. To start one: dask worker {address}")
    raise NoCluster(f"--scheduler {address}: it has no worker.")


def _check_workers(client: Client, grading: Grading, say: Callable[[str], None]) -> None:
    """Compare each worker with this machine; one without an answer, when it gets a submission. Raises `NoCluster`."""
    ours, options = _of_this_machine(grading), grading.runner.options
    asked = {  # before the submissions of other commands, which may take long
        client.submit(describe_worker, options, workers=[worker], priority=1, pure=False): worker
        for worker in client.nthreads()
    }
    done = _as_they_end(asked)
    for _ in range(SILENT_LOOKS):
        with contextlib.suppress(queue.Empty):
            while asked:
                future = done.get(timeout=LOOK_S)
                _refuse_other(asked.pop(future, ""), future, ours)
        joined = client.nthreads()
        asked = {future: worker for future, worker in asked.items() if worker in joined}
        if not asked:
            return
        say(f"Waiting for {', '.join(sorted(asked.values()))} to describe itself.")


def _refuse_other(worker: str, future: Future[Any], ours: Mapping[str, str]) -> None:
    if error := future.exception():
        text = f"The worker {worker} can't grade: "
        if isinstance(error, SandboxUnavailable):
            raise NoCluster(f"{text}{error}")
        text += f"{type(error).__name__}: {str(error).partition(chr(10))[0]}"
        raise NoCluster(
            f"{text} Start the scheduler and each worker in an environment with the same Spinbook: "
            "pip install 'spinbook[cluster]'"
        )
    if differs := differences(ours, future.result()):
        raise NoCluster(
            f"The worker {worker} differs: {differs}. Install the same versions there; if only the sandbox differs, "
            "name one that both have: --isolation landlock."
        )
