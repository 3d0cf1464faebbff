"""The judging processes: one collects an exercise's checks, and each judging is a fork of it."""

from __future__ import annotations

import contextlib
import gc
import multiprocessing.connection
import os
import signal
import socket
import threading
import traceback
from collections.abc import Mapping
from typing import TYPE_CHECKING, NoReturn

from grader.workers.answers import Answer, answer_of
from grader.workers.fork import fork, limit_memory
from grader.workers.shared import what_to_collect

if TYPE_CHECKING:
    from grader.checking.run import Run
    from grader.workers.jobs import JudgeJob
    from grader.workers.pool import Connection

_REQUEST = b"j"


class Judges:
    """The worker's side. A process is started when it is first needed, and restarted if it has died."""

    def __init__(self, working: set[int]) -> None:
        """`working` are the worker's processes, which this adds to."""
        self._working = working
        self._requests: dict[bytes, socket.socket] = {}

    def request(self, collected: bytes, descriptor: int, control: socket.socket) -> None:
        """Have one judging done for the other end of the socket `descriptor`.

        `collected` is what `SharedObjects.to_collect` returned. `descriptor` is the socket from which the `JudgeJob`
        comes, and to which its result goes. `control` is a socket that only the worker may keep open.
        """
        for _ in range(2):
            requests = self._requests.get(collected) or self._start(collected, descriptor, control)
            try:
                socket.send_fds(requests, [_REQUEST], [descriptor])
                return
            except OSError:
                self._requests.pop(collected).close()

    def _start(self, collected: bytes, descriptor: int, control: socket.socket) -> socket.socket:
        ours, theirs = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
        pid = fork()
        if pid == 0:
            control.close()
            ours.close()
            os.close(descriptor)
            self.close()
            _judge(theirs, collected)
        theirs.close()
        self._working.add(pid)
        self._requests[collected] = ours
        return ours

    def close(self) -> None:
        """Let each process end once it has forked for the requests that it already has."""
        for requests in self._requests.values():
            requests.close()
        self._requests.clear()


# --- in the process that collects the checks, and in its forks


def _judge(requests: socket.socket, collected: bytes) -> NoReturn:
    from grader.checking.judge import judge_when_collected

    exercise, partly, scenarios = what_to_collect(collected)
    judging = _JudgingRequest(requests)
    judging.end(answer_of(lambda: judge_when_collected(exercise, scenarios, judging.runs, partly)))


class _JudgingRequest:
    """One judging, which begins with the fork of this process."""

    def __init__(self, requests: socket.socket) -> None:
        self._requests = requests
        self._connection: Connection | None = None

    def runs(self) -> Mapping[str, Run]:
        """Wait for requests, and return, in a fork for each, what is to be judged."""
        connection = self._fork_for_each()
        try:
            job: JudgeJob = connection.recv()
        except (EOFError, OSError):
            os._exit(1)
        except Exception:
            self.end(("host", traceback.format_exc()))
        threading.Thread(target=_end_with, args=(connection,), daemon=True).start()
        return job.runs()

    def end(self, answer: Answer) -> NoReturn:
        """Answer and exit. Without a request so far, give this answer to every request: the checks can't be used."""
        connection = self._connection or self._fork_for_each()
        with contextlib.suppress(OSError):
            connection.send(answer)
        os._exit(0)

    def _fork_for_each(self) -> Connection:
        gc.collect()  # a collection in each fork would copy the memory
        gc.freeze()
        signal.signal(signal.SIGCHLD, signal.SIG_IGN)  # forks need no reaping
        while True:
            message, descriptors, _, _ = socket.recv_fds(self._requests, len(_REQUEST), 1)
            if not message:
                os._exit(0)
            if fork() == 0:
                gc.enable()
                limit_memory()
                break
            os.close(descriptors[0])
        signal.signal(signal.SIGCHLD, signal.SIG_DFL)
        self._requests.close()
        self._connection = multiprocessing.connection.Connection(descriptors[0])
        return self._connection


def _end_with(connection: Connection) -> None:
    """End this process when its client has closed the connection."""
    with contextlib.suppress(EOFError, OSError):
        connection.recv()
    os._exit(1)
