"""The worker pool: a worker process that forks one process per job, and gives it one job after another."""

from __future__ import annotations

import contextlib
import importlib
import multiprocessing.connection
import os
import pickle
import shutil
import socket
import sys
import tempfile
import threading
from collections.abc import Callable, Iterable
from functools import partial
from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING, Any, TypeAlias

from grader.sandbox.environment import for_trusted
from grader.sandbox.filesystem import memory_file
from grader.sandbox.middleware import require_middleware
from grader.sandbox.zygote_start import PRELOAD, start_zygote
from grader.workers.shared import SharedObjects

if TYPE_CHECKING:
    from grader.checking.verdict import Verdict
    from grader.workers.jobs import Job, JudgeJob

    Connection: TypeAlias = multiprocessing.connection.Connection[Any, Any]


#: No job takes this long: the student's limits are far below it.
LONGEST_S = 600.0

#: How often a job is tried when we or the machine are at fault.
TRIES = 3


class HostFault(Exception):
    """Raised if a job failed several times because of a fault of ours or the machine's."""


class Worker(contextlib.AbstractContextManager["Worker"]):
    """One process of a worker pool, created when it is first needed; use it as a context manager, from one thread.

    The process keeps what it has prepared for one job, such as a runner's namespaces and memory copied from the worker,
    for the next. So use it for jobs that may share a process: the runs of one submission, not those of two.
    """

    def __init__(self, process: Callable[[], Connection], shared: SharedObjects) -> None:
        """`process` connects to a new process; it raises OSError if there is none."""
        self._new, self._shared, self._known = process, shared, 0
        self._process: Connection | None = None

    def do(self, job: Job, cancelled: threading.Event | None = None) -> Any:
        """Return what `job` returns. An `ExerciseError` in the job is raised as it is, anything else as `HostFault`.

        Returns None when `cancelled` was set meanwhile; the job's process then ends.
        """
        faults: list[str] = []
        for _ in range(TRIES):
            kind, result = self._once(job, cancelled or threading.Event())
            if kind == "result":
                return result
            self.close()  # its state is unknown after a fault
            if kind == "author":
                raise result
            faults.append(str(result))
        raise HostFault(faults[-1])

    def _once(self, job: Job, cancelled: threading.Event) -> tuple[str, Any]:
        try:
            process = self._process or self._started()
        except OSError as error:
            return "host", f"the worker process is gone: {error}"
        try:
            process.send_bytes(self._shared.pickled(job, self._known))
            waited = 0.0
            while not process.poll(0.1):
                waited += 0.1
                if cancelled.is_set():
                    self.close()
                    return "result", None
                if waited > LONGEST_S:
                    return "host", f"no result after {LONGEST_S:g} s"
            answer: tuple[str, Any] = process.recv()
            return answer
        except (EOFError, OSError):
            return "host", "the process that did the work died"

    def _started(self) -> Connection:
        self._known = self._shared.count  # this process does not have what is shared later
        self._process = process = self._new()
        return process

    def close(self) -> None:
        """End the process, and any job in progress."""
        if self._process is not None:
            with contextlib.suppress(OSError):
                self._process.close()
        self._process = None

    def __exit__(self, *error: object) -> None:
        self.close()


#: For students' programs. No time stamps in the log, so that two runs log the same.
STUDENT_ENVIRONMENT = {
    "RCUTILS_CONSOLE_OUTPUT_FORMAT": "[{severity}] [{name}]: {message}",
    "RCUTILS_COLORIZED_OUTPUT": "0",
}


def leave_cpus_to_workers() -> None:
    """Import numpy, which ROS's message classes import, only if it is used, and without a thread per CPU: each of them
    computes for 0.1 s before it waits. Commands call this. Their child processes inherit the number of threads.
    """
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    sys.modules.setdefault("numpy", _NumpyWhenUsed("numpy"))


class _NumpyWhenUsed(ModuleType):
    """Stands for numpy until somebody looks up a name in it. `import` itself would load a `LazyLoader`'s module."""

    _lock = threading.Lock()

    def __getattr__(self, name: str) -> Any:
        with self._lock:
            if sys.modules.get("numpy") is self:
                del sys.modules["numpy"]
        return getattr(importlib.import_module("numpy"), name)


BEGIN, PREPARE_TO_JUDGE, PREPARE_TYPES, PROCESS, SHARE, JUDGE = b"b", b"p", b"t", b"j", b"s", b"c"


class WorkerPool(contextlib.AbstractContextManager["WorkerPool"]):
    """A worker process that forks the processes which do jobs, and is restarted if it dies.

    Any thread may call `do` and `reserve`; use it as a context manager.
    """

    def __init__(self, *folders: Path) -> None:
        """Start the worker. When this process ends, however it ends, the worker removes the `folders`.

        Raises `MiddlewareUnavailable` if the grader's middleware is not available on this machine.
        """
        require_middleware()
        # A cancelled job ends at once; its files are removed with the pool.
        self._temporary = Path(tempfile.mkdtemp(prefix="spinbook-"))
        self._folders = (self._temporary, *folders)
        self._lock = threading.Lock()
        self._closed = False
        self._shared = SharedObjects()
        self._sent: list[bytes] = []
        self._start()

    def _start(self) -> None:
        self._control, self._worker = start_zygote(PRELOAD, "grader.workers.worker")
        # Not the user's RMW_IMPLEMENTATION: rcl ends a process that an author's check starts if it names another one.
        environment = for_trusted() | {"TMPDIR": str(self._temporary), "RMW_IMPLEMENTATION": "", "PYTHONHASHSEED": "0"}
        here = Path("/proc/self/cwd").readlink()  # Path.cwd() raises an error if it was removed
        self._send(BEGIN, pickle.dumps((environment, here, self._folders)))
        for content in self._sent:
            self._send(SHARE, content)

    def do(self, job: Job, cancelled: threading.Event | None = None) -> Any:
        """Return what `job` returns, done in a process of its own; see `Worker.do`."""
        with self.reserve() as worker:
            return worker.do(job, cancelled)

    def judge(self, job: JudgeJob) -> tuple[Verdict, ...]:
        """Return the verdicts of a judging. The checks of a shared exercise are collected once for all judgings."""
        collected = self._shared.to_collect(job.exercise, job.recordings, job.partly)
        command = PROCESS if collected is None else JUDGE + collected
        with Worker(partial(self._process, command), self._shared) as worker:
            verdicts: tuple[Verdict, ...] = worker.do(job)
            return verdicts

    def reserve(self) -> Worker:
        """Return a process that does one job after another."""
        return Worker(self._process, self._shared)

    def share(self, objects: Iterable[object]) -> None:
        """Send what all jobs of a grading need to the worker: jobs that hold these very objects then refer to them."""
        with self._lock:
            self._sent.append(self._shared.add(objects))
            with contextlib.suppress(OSError):  # a worker that died gets it when it is started again
                self._send(SHARE, self._sent[-1])

    def _send(self, command: bytes, content: bytes) -> None:
        with os.fdopen(memory_file(content)) as stream:
            socket.send_fds(self._control, [command], [stream.fileno()])

    def prepare_types(self, modules: Iterable[str]) -> None:
        """Let the worker load modules of message types, such as `sensor_msgs.msg`, for all later jobs."""
        for module in sorted(set(modules)):
            self._command(PREPARE_TYPES + module.encode())

    def prepare_to_judge(self) -> None:
        """Let the worker import what judging needs, while scenarios are still running."""
        self._command(PREPARE_TO_JUDGE)

    def _command(self, command: bytes) -> None:
        with self._lock, contextlib.suppress(OSError):  # a worker that died is restarted with the next job
            self._control.send(command)

    def _process(self, command: bytes = PROCESS) -> Connection:
        """Return a connection to a new process that does jobs. Raises OSError if there is none."""
        ours, theirs = socket.socketpair()
        with ours, theirs:
            self._hand_over(command, theirs.fileno())
            return multiprocessing.connection.Connection(ours.detach())

    def _hand_over(self, command: bytes, descriptor: int) -> None:
        """Request one more process from the worker; if it has died, for example for lack of memory, start another."""
        with self._lock:
            try:
                socket.send_fds(self._control, [command], [descriptor])
            except OSError:
                if self._closed:
                    raise
                self._worker.kill()  # before it can see the end of the socket, and remove the folders
                self._worker.wait()
                self._control.close()
                self._start()
                socket.send_fds(self._control, [command], [descriptor])

    def close(self) -> None:
        """End the worker, and with it every job and every student's program; remove their files."""
        self._closed = True
        self._control.close()
        self._worker.wait()
        shutil.rmtree(self._temporary, ignore_errors=True)

    def __exit__(self, *error: object) -> None:
        self.close()
