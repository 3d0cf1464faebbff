"""Does one job after another in one process, and waits for what comes of each."""

from __future__ import annotations

import contextlib
import multiprocessing.connection
import threading
from collections.abc import Callable
from types import TracebackType
from typing import TYPE_CHECKING, Any, TypeAlias

if TYPE_CHECKING:
    from grader.crew.jobs import Job

    Connection: TypeAlias = multiprocessing.connection.Connection[Any, Any]

#: No job takes this long: the student's limits end far below it.
LONGEST_S = 600.0

#: How often a job is tried when the machine or we are at fault.
TRIES = 3


class HostFault(Exception):
    """Raised when a job came to nothing by a fault of the machine's or ours, several times over."""


class Hand:
    """One process of a crew's, made when it is first needed; use it as a context manager, and from one thread.

    What the process has made ready for one job it has ready for the next: a rig its namespaces, and all that is
    copied from the worker when it is first touched. So a hand is for jobs that may share a process: the spins of one
    submission, not those of two.
    """

    def __init__(self, process: Callable[[], Connection]) -> None:
        """`process` connects to a new process; it raises OSError where there is none to be had."""
        self._new = process
        self._process: Connection | None = None

    def do(self, job: Job, cancelled: threading.Event | None = None) -> Any:
        """What `job` returns. An `ExerciseError` of the job's is raised here as it is, anything else as `HostFault`.

        Returns None when `cancelled` was set meanwhile; the job's process then ends.
        """
        faults: list[str] = []
        for _ in range(TRIES):
            kind, result = self._once(job, cancelled or threading.Event())
            if kind == "result":
                return result
            self.close()  # nobody knows what the fault has left behind
            if kind == "author":
                raise result
            faults.append(str(result))
        raise HostFault(faults[-1])

    def _once(self, job: Job, cancelled: threading.Event) -> tuple[str, Any]:
        try:
            self._process = process = self._process or self._new()
        except OSError as error:
            return "host", f"the worker process is gone: {error}"
        try:
            process.send(job)
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

    def close(self) -> None:
        """End the process, and with it the job that it may be doing."""
        if self._process is not None:
            with contextlib.suppress(OSError):
                self._process.close()
        self._process = None

    def __enter__(self) -> Hand:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, fault: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()
