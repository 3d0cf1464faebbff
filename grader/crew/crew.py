"""The worker process, and the processes for jobs that it makes."""

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
from grader.crew.hand import Hand
from grader.sandbox import Middleware, choose_middleware

if TYPE_CHECKING:
    from grader.crew.hand import Connection
    from grader.crew.jobs import Job

PREPARE_TO_JUDGE, PROCESS = b"p", b"j"


class Crew:
    """A worker process that forks the processes which do jobs, and is started again should it die.

    Any thread may call `do` and `hand`; use it as a context manager.
    """

    def __init__(self, *middlewares: Middleware | None) -> None:
        """Starts the worker, ready for programs of these middlewares; None is the one that is used without a wish.

        Raises:
            MiddlewareUnavailable: if one of them can't be had on this machine.
        """
        chosen = {choose_middleware(one).middleware for one in middlewares or (None,)}
        self._middlewares = sorted(one.value for one in chosen)
        self._lock = threading.Lock()
        self._closed = False
        self._start()

    def _start(self) -> None:
        self._control, theirs = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
        self._worker = subprocess.Popen(
            [sys.executable, "-m", "grader.crew.worker", str(theirs.fileno()), *self._middlewares],
            pass_fds=[theirs.fileno()],
            stdin=subprocess.DEVNULL,
            start_new_session=True,
            env={**os.environ, **OURS},
        )
        theirs.close()

    def do(self, job: Job, cancelled: threading.Event | None = None) -> Any:
        """What `job` returns, done in a process of its own; see `Hand.do`."""
        with self.hand() as hand:
            return hand.do(job, cancelled)

    def hand(self) -> Hand:
        """A process that does one job after another."""
        return Hand(self._process)

    def prepare_to_judge(self) -> None:
        """Let the worker import what judging needs, while spins are still running."""
        with self._lock, contextlib.suppress(OSError):  # a worker that died is started again with the next job
            self._control.send(PREPARE_TO_JUDGE)

    def _process(self) -> Connection:
        """A connection to a new process that does jobs. Raises OSError where there is none to be had."""
        ours, theirs = socket.socketpair()
        try:
            self._hand_over(theirs.fileno())
        except OSError:
            ours.close()
            raise
        finally:
            theirs.close()
        return multiprocessing.connection.Connection(ours.detach())

    def _hand_over(self, descriptor: int) -> None:
        """Ask the worker for a process more; where it has died, as by the kernel for want of memory, start another."""
        with self._lock:
            try:
                socket.send_fds(self._control, [PROCESS], [descriptor])
            except OSError:
                if self._closed:
                    raise
                self._control.close()
                self._worker.kill()
                self._worker.wait()
                self._start()
                socket.send_fds(self._control, [PROCESS], [descriptor])

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
