"""The nursery's process: imports, then forks a keeper for each request; a keeper's fork runs the student.

python -m grader.sandbox.fork_server DESCRIPTOR MIDDLEWARE MODULE…
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
from .keeper import Job, keep, refuse
from .middleware import Middleware, choosable
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
    requests, middleware, modules = int(arguments[0]), Middleware(arguments[1]), arguments[2:]
    os.chdir("/")
    fault = _load(modules, middleware)
    view.system()  # found once, not in every fork
    view.interpreter()
    gc.collect()
    gc.freeze()
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    signal.signal(signal.SIGCHLD, signal.SIG_IGN)  # keepers need no burial
    job = serve(requests, fault)
    if job is not None:
        run(job.program, job.place)


def serve(requests: int, fault: str | None) -> Job | None:
    """Forks a keeper for each request. Returns what to run in each student, and None at the end of all requests.

    With a `fault` nothing is started: it is the answer to each request.
    """
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
            if fault:
                refuse(control, fault)
            return keep(start, control, output, namespaces)
        for number in passed:
            os.close(number)


def _load(modules: list[str], middleware: Middleware) -> str | None:
    """Imports modules, and says what is wrong if rclpy has loaded another middleware than it was started for."""
    wanted = os.environ.pop("RMW_IMPLEMENTATION", None)
    if wanted and choosable():
        os.environ["RMW_IMPLEMENTATION"] = wanted
    for name in modules:
        _import(name)
    if wanted:
        os.environ["RMW_IMPLEMENTATION"] = wanted
    if "rclpy" not in sys.modules:
        return None
    loaded = sys.modules["rclpy"].get_rmw_implementation_identifier()
    if middleware.is_named(loaded):
        return None
    return f"rclpy has loaded the middleware {loaded}, not {middleware}. Run spinbook doctor: it says what is installed"


def _import(name: str) -> None:
    """Imports a module and, if most nodes use its message types, loads their compiled support."""
    if name.split(".")[0] in _USED_BY_MOST_NODES:
        type_support.load(name)
    else:
        with contextlib.suppress(ImportError):
            importlib.import_module(name)


if __name__ == "__main__":
    main(sys.argv[1:])
