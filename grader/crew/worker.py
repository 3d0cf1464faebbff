"""The worker process: has rclpy in its memory and forks the processes for jobs.

python -m grader.crew.worker DESCRIPTOR MIDDLEWARE…
"""

from __future__ import annotations

import contextlib
import multiprocessing.connection
import os
import queue
import signal
import socket
import sys
import threading
import traceback
from collections.abc import Callable
from typing import TYPE_CHECKING, Any, NoReturn

from grader.crew.crew import PREPARE_TO_JUDGE, PROCESS
from grader.exercise import ExerciseError
from grader.sandbox import Middleware, Nursery
from grader.sandbox.fork import fork

if TYPE_CHECKING:
    from grader.crew.hand import Connection
    from grader.crew.jobs import Job


def main() -> None:
    """Serve jobs until the other end of the control socket is closed."""
    control = socket.socket(fileno=int(sys.argv[1]))
    with Nursery([Middleware(name) for name in sys.argv[2:]]) as nursery:
        import grader.crew.jobs
        import grader.rig.spin
        import grader.runner.run  # noqa: F401  # for every process that is forked from this one
        from grader.crew.warmth import warm, warm_to_judge

        warm()
        working: set[int] = set()
        while True:
            command, descriptors, _, _ = socket.recv_fds(control, 16, 1)
            _reap(working)
            if not command:
                break
            if command == PREPARE_TO_JUDGE:
                warm_to_judge()
            elif command == PROCESS:
                pid = fork()
                if pid == 0:
                    control.close()
                    _work(descriptors[0], nursery)
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


def _work(descriptor: int, nursery: Nursery) -> NoReturn:
    """One job after another in this process, which ends with the first that fails, or once nobody wants any more."""
    connection = multiprocessing.connection.Connection(descriptor)
    jobs: queue.SimpleQueue[Job] = queue.SimpleQueue()
    # Whoever wanted the result may lose interest in it: then the other end is closed, and the job ends at once.
    listener = threading.Thread(target=_listen, args=(connection, jobs), daemon=True)

    def ready() -> None:
        if not listener.ident:
            listener.start()

    with contextlib.suppress(EOFError, OSError):
        jobs.put(connection.recv())
        while True:
            kind, result = _answer(jobs.get(), nursery, ready)
            ready()
            connection.send((kind, result))
            if kind != "result":
                break
    os._exit(0)


def _answer(job: Job, nursery: Nursery, ready: Callable[[], None]) -> tuple[str, Any]:
    try:
        return "result", job.run(nursery, ready)
    except ExerciseError as error:
        return "author", error
    except BaseException:
        return "host", traceback.format_exc()


def _listen(connection: Connection, jobs: queue.SimpleQueue[Job]) -> None:
    with contextlib.suppress(EOFError, OSError):
        while True:
            jobs.put(connection.recv())
    os._exit(1)


if __name__ == "__main__":
    main()
