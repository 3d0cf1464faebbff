"""Hands jobs to a worker process and waits for what comes of them."""

from __future__ import annotations

import contextlib
import multiprocessing.connection
import os
import socket
import subprocess
import sys
import threading
from types import TracebackType
from typing import TYPE_CHECKING, Any

from grader.crew.environment import OURS

if TYPE_CHECKING:
    from grader.crew.jobs import Job

#: No job takes this long: the student's limits end far below it.
LONGEST_S = 600.0

#: How often a job is tried when the machine or we are at fault.
TRIES = 3

PREPARE_TO_JUDGE, JOB = b"p", b"j"


class HostFault(Exception):
    """Raised when a job came to nothing by a fault of the machine's or ours, several times over."""


class Crew:
    """A worker process that forks one process for each job, and is started again should it die.

    Any thread may call `do`; use it as a context manager.
    """

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._closed = False
        self._start()

    def _start(self) -> None:
        self._control, theirs = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
        self._worker = subprocess.Popen(
            [sys.executable, "-m", "grader.crew.worker", str(theirs.fileno())],
            pass_fds=[theirs.fileno()],
            stdin=subprocess.DEVNULL,
            start_new_session=True,
            env={**os.environ, **OURS},
        )
        theirs.close()

    def do(self, job: Job, cancelled: threading.Event | None = None) -> Any:
        """What `job` returns. An `ExerciseError` of the job's is raised here as it is, anything else as `HostFault`.

        Returns None when `cancelled` was set meanwhile; the job's process then ends.
        """
        faults: list[str] = []
        for _ in range(TRIES):
            kind, result = self._once(job, cancelled or threading.Event())
            if kind == "result":
                return result
            if kind == "author":
                raise result
            faults.append(str(result))
        raise HostFault(faults[-1])

    def prepare_to_judge(self) -> None:
        """Let the worker import what judging needs, while spins are still running."""
        with self._lock, contextlib.suppress(OSError):  # a worker that died is started again with the next job
            self._control.send(PREPARE_TO_JUDGE)

    def _once(self, job: Job, cancelled: threading.Event) -> tuple[str, Any]:
        ours, theirs = socket.socketpair()
        try:
            self._hand_over(theirs.fileno())
        except OSError as error:
            ours.close()
            return "host", f"the worker process is gone: {error}"
        finally:
            theirs.close()
        with multiprocessing.connection.Connection(ours.detach()) as connection:
            try:
                connection.send(job)
                waited = 0.0
                while not connection.poll(0.1):
                    waited += 0.1
                    if cancelled.is_set():
                        return "result", None
                    if waited > LONGEST_S:
                        return "host", f"no result after {LONGEST_S:g} s"
                answer: tuple[str, Any] = connection.recv()
                return answer
            except (EOFError, OSError):
                return "host", "the process that did the work died"

    def _hand_over(self, descriptor: int) -> None:
        """Give the worker one more job; where it has died, as by the kernel for want of memory, start another."""
        with self._lock:
            try:
                socket.send_fds(self._control, [JOB], [descriptor])
            except OSError:
                if self._closed:
                    raise
                self._control.close()
                self._worker.kill()
                self._worker.wait()
                self._start()
                socket.send_fds(self._control, [JOB], [descriptor])

    def close(self) -> None:
        """End the worker, and with it every job and every student's program."""
        self._closed = True
        self._control.close()
        self._worker.wait()

    def __enter__(self) -> Crew:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, fault: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()
