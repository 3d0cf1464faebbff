"""The worker process: has rclpy in memory and forks the processes for jobs."""

from __future__ import annotations

import contextlib
import functools
import gc
import importlib
import multiprocessing.connection
import os
import queue
import shutil
import signal
import socket
import sys
import threading
from typing import TYPE_CHECKING, NoReturn

from grader.sandbox import filesystem, middleware
from grader.sandbox.fork_server import ForkServer
from grader.workers.answers import answer_of
from grader.workers.fork import fork, limit_memory
from grader.workers.judges import Judges
from grader.workers.pool import JUDGE, PREPARE_TO_JUDGE, PREPARE_TYPES, PROCESS, SHARE
from grader.workers.shared import receive

if TYPE_CHECKING:
    from grader.workers.jobs import Job
    from grader.workers.pool import Connection


def preload() -> None:
    """Import the modules that run a program, scan the file system, and prepare the memory for sharing with forks."""
    importlib.import_module("grader.runner.run")
    filesystem.mounts((), (), 0)
    _share()


@functools.cache
def preload_types(module: str) -> None:
    """Preload a module of message types, such as `sensor_msgs.msg`, and its compiled support."""
    middleware.load_type_support(module)
    _share()


def take_shared(descriptor: int) -> None:
    """Take what all jobs of a grading need: see `WorkerPool.share`."""
    with os.fdopen(descriptor, "rb") as stream:
        stream.seek(0)
        receive(stream.read())
    _share()


#: In bytes. The longest holds the names of all scenarios.
LONGEST_COMMAND = 65536


@functools.cache
def preload_judging() -> None:
    """Preload what judging needs."""
    from grader.checking.judge import load_pytest

    load_pytest()
    _share()


def _share() -> None:
    # A later collection in each fork would copy this memory.
    gc.collect()
    gc.freeze()


# python -m grader.workers.worker DESCRIPTOR FOLDER...


def main() -> None:
    """Serve jobs until the other end of the control socket is closed; remove the folders with the jobs' files."""
    gc.disable()  # until a fork works: it would look through all that is imported, a tenth of the time
    descriptor, *folders = sys.argv[1:]
    control = socket.socket(fileno=int(descriptor))
    with ForkServer() as fork_server:
        preload()
        working: set[int] = set()
        judges = Judges(working)
        while True:
            command, descriptors, _, _ = socket.recv_fds(control, LONGEST_COMMAND, 1)
            _reap(working)
            if not command:
                break
            if command == PREPARE_TO_JUDGE:
                preload_judging()
            elif command.startswith(PREPARE_TYPES):
                module = command.removeprefix(PREPARE_TYPES).decode()
                fork_server.preload(module)
                preload_types(module)
            elif command == SHARE:
                take_shared(descriptors[0])
                judges.close()  # they lack the newly shared objects
            elif command.startswith(JUDGE):
                judges.request(command.removeprefix(JUDGE), descriptors[0], control)
                os.close(descriptors[0])
            elif command == PROCESS:
                pid = fork()
                if pid == 0:
                    control.close()
                    judges.close()
                    _work(descriptors[0], fork_server)
                os.close(descriptors[0])
                working.add(pid)
        for pid in working:
            with contextlib.suppress(ProcessLookupError):
                os.kill(pid, signal.SIGKILL)
            with contextlib.suppress(ChildProcessError):
                os.waitpid(pid, 0)
    for folder in folders:
        shutil.rmtree(folder, ignore_errors=True)


def _reap(working: set[int]) -> None:
    for pid in list(working):
        if os.waitpid(pid, os.WNOHANG)[0]:
            working.discard(pid)


def _work(descriptor: int, fork_server: ForkServer) -> NoReturn:
    """Do one job after another, until one fails or the client closes the connection."""
    gc.enable()
    limit_memory()
    connection = multiprocessing.connection.Connection(descriptor)
    jobs: queue.SimpleQueue[Job] = queue.SimpleQueue()
    # If the client no longer needs the result, it closes the other end, and the job ends at once.
    listener = threading.Thread(target=_listen, args=(connection, jobs), daemon=True)

    def ready() -> None:
        if not listener.ident:
            listener.start()

    with contextlib.suppress(EOFError, OSError):
        jobs.put(connection.recv())
        while True:
            job = jobs.get()
            answer = answer_of(functools.partial(job.run, fork_server, ready))
            ready()
            connection.send(answer)
            if answer[0] != "result":
                break
    os._exit(0)


def _listen(connection: Connection, jobs: queue.SimpleQueue[Job]) -> None:
    with contextlib.suppress(EOFError, OSError):
        while True:
            jobs.put(connection.recv())
    os._exit(1)


if __name__ == "__main__":
    main()
