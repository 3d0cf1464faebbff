"""The nursery's process: imports, then forks a keeper for each request; a keeper's fork runs the student.

python -m grader.sandbox.fork_server DESCRIPTOR MODULE…
"""

from __future__ import annotations

import contextlib
import gc
import importlib
import os
import pickle
import signal
import socket
import sys

from . import type_support, view
from .fork import fork
from .keeper import Job, keep
from .run import run

_MOST_DESCRIPTORS = 8
_USED_BY_MOST_NODES = (
    "rcl_interfaces",
    "rosgraph_msgs",
    "builtin_interfaces",
    "std_msgs",
    "geometry_msgs",
    "sensor_msgs",
)


def main(arguments: list[str]) -> None:
    """Serves until the last user of the socket is gone. Returns only as a student whose program has come to its end."""
    requests, modules = int(arguments[0]), arguments[1:]
    os.chdir("/")
    for name in modules:
        _import(name)
    view.system()  # found once, not in every fork
    view.interpreter()
    gc.collect()
    gc.freeze()
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    signal.signal(signal.SIGCHLD, signal.SIG_IGN)  # keepers need no burial
    job = serve(requests)
    if job is not None:
        run(job.program, job.place)


def serve(requests: int) -> Job | None:
    """Forks a keeper for each request. Returns what to run in each student, and None at the end of all requests."""
    listening = socket.socket(fileno=requests)
    while True:
        message, passed, _, _ = socket.recv_fds(listening, 64, _MOST_DESCRIPTORS)
        if not message:
            return None
        if fork() == 0:
            listening.detach()
            os.close(requests)
            request, control, output, *namespaces = passed
            with os.fdopen(request, "rb") as stream:
                start = pickle.load(stream)
            return keep(start, control, output, namespaces)
        for number in passed:
            os.close(number)


def _import(name: str) -> None:
    """Imports a module and, if most nodes use its message types, loads their compiled support."""
    if name.split(".")[0] in _USED_BY_MOST_NODES:
        type_support.load(name)
    else:
        with contextlib.suppress(ImportError):
            importlib.import_module(name)


if __name__ == "__main__":
    main(sys.argv[1:])
