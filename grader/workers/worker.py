"""The worker process: has rclpy in memory and forks the processes for jobs."""

from __future__ import annotations

import contextlib
import functools
import gc
import importlib
import multiprocessing.connection
import os
import pickle
import queue
import shutil
import signal
import socket
import sys
import threading
import time
from pathlib import Path
from typing import TYPE_CHECKING, NoReturn

from grader.sandbox import filesystem, middleware
from grader.sandbox.fork_server import ForkServer
from grader.workers.answers import answer_of
from grader.workers.fork import fork, limit_memory
from grader.workers.judges import Judges
from grader.workers.pool import JUDGE, PREPARE_TO_JUDGE, PREPARE_TYPES, PROCESS, SHARE
from grader.workers.shared import receive
from rmw_lockstep.type_hash import type_hash

if TYPE_CHECKING:
    from grader.workers.jobs import Job
    from grader.workers.pool import Connection


def preload() -> None:
    """Import the modules that run a program, scan the file system, and prepare the memory for sharing with forks."""
    importlib.import_module("grader.runner.run")
    importlib.import_module("grader.workers.jobs")
    filesystem.mounts((), (), 0)
    type_hash("rosgraph_msgs/msg/Clock")  # this reads what the others need
    _share()


@functools.cache
def preload_types(module: str) -> None:
    """Preload a module of message types, such as `sensor_msgs.msg`, and its compiled support."""
    middleware.load_type_support(module)
    _share()


def take_shared(descriptor: int) -> None:
    """Take what all jobs of a grading need: see `WorkerPool.share`."""
    receive(_content(descriptor))
    _share()


def _content(descriptor: int) -> bytes:
    with os.fdopen(descriptor, "rb") as stream:
        return stream.read()


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


def main(descriptor: int, fork_server: ForkServer) -> None:
    """Serve jobs until the other end of the control socket is closed; remove the folders with the jobs' files.

    `descriptor` is the control socket. A process that has already imported rclpy calls this: see
    `grader.sandbox.zygote`.
    """
    control = socket.socket(fileno=descriptor)
    folders = _begin(control)
    with fork_server:
        preload()
        working: set[int] = set()
        judges = Judges(working)
        while True:
            command, descriptors, _, _ = socket.recv_fds(control, LONGEST_COMMAND, 1)
            _reap(working)
            if not command:
                break
            if fork_server.has_ended():
                os._exit(1)  # a new worker will have another one
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
            os.kill(pid, signal.SIGKILL)
            os.waitpid(pid, 0)
    for folder in folders:
        shutil.rmtree(folder, ignore_errors=True)


def _begin(control: socket.socket) -> tuple[Path, ...]:
    """Take this process's own environment variables and working directory; return the folders to remove at the end."""
    _, [descriptor], _, _ = socket.recv_fds(control, LONGEST_COMMAND, 1)
    environment, directory, folders = pickle.loads(_content(descriptor))
    os.environ.clear()
    os.environ.update(environment)
    time.tzset()
    with contextlib.suppress(FileNotFoundError):  # it was removed: any other will do
        os.chdir(directory)
    sys.dont_write_bytecode = "PYTHONDONTWRITEBYTECODE" in environment
    sys.pycache_prefix = environment.get("PYTHONPYCACHEPREFIX")
    return tuple(folders)


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
