"""The worker process, `python -m grader.crew.worker FD`: has rclpy in its memory and forks a process for each job."""

from __future__ import annotations

import contextlib
import multiprocessing.connection
import os
import signal
import socket
import sys
import threading
import traceback

from grader.crew.crew import JOB, PREPARE_TO_JUDGE
from grader.exercise import ExerciseError
from grader.sandbox import Nursery


def main() -> None:
    """Serve jobs until the other end of the control socket is closed."""
    control = socket.socket(fileno=int(sys.argv[1]))
    with Nursery() as nursery:
        import grader.crew.jobs
        import grader.rig.spin
        from grader.crew.warmth import warm

        warm()
        working: set[int] = set()
        while True:
            command, descriptors, _, _ = socket.recv_fds(control, 16, 1)
            _reap(working)
            if not command:
                break
            if command == PREPARE_TO_JUDGE:
                import grader.checking.judging  # noqa: F401
            elif command == JOB:
                pid = os.fork()
                if pid == 0:
                    control.close()
                    _do(descriptors[0], nursery)
                os.close(descriptors[0])
                working.add(pid)
        for pid in working:
            with contextlib.suppress(ProcessLookupError):
                os.kill(pid, signal.SIGKILL)
            with contextlib.suppress(ChildProcessError):
                os.waitpid(pid, 0)


def _reap(working: set[int]) -> None:
    for pid in list(working):
        if os.waitpid(pid, os.WNOHANG)[0]:
            working.discard(pid)


def _do(descriptor: int, nursery: Nursery) -> None:
    """One job, in its own process, which ends with it."""
    connection = multiprocessing.connection.Connection(descriptor)
    try:
        job = connection.recv()
        # Whoever wanted the result may lose interest in it: then the other end is closed.
        watch = threading.Thread(target=_end_with, args=(connection,), daemon=True)
        answer = ("result", job.run(nursery, watch.start))
    except ExerciseError as error:
        answer = ("author", error)
    except BaseException:
        answer = ("host", traceback.format_exc())
    with contextlib.suppress(OSError):
        connection.send(answer)
    os._exit(0)


def _end_with(connection: multiprocessing.connection.Connection) -> None:  # type: ignore[type-arg, unused-ignore]
    with contextlib.suppress(OSError):
        connection.poll(None)
    os._exit(1)


if __name__ == "__main__":
    main()
