"""Starts the process from which students' programs are forked."""

from __future__ import annotations

import socket
import subprocess
from collections.abc import Sequence

from grader.sandbox.environment import RUNTIME_VARIABLES, for_trusted
from grader.sandbox.middleware import variables
from groundwork.clean_environment import module_command

#: What it imports beforehand.
PRELOAD = (
    *("rclpy", "rclpy.action", "rclpy.executors", "rclpy.qos", "numpy", "rcl_interfaces.msg", "rcl_interfaces.srv"),
    *("rosgraph_msgs.msg", "builtin_interfaces.msg", "std_msgs.msg", "geometry_msgs.msg", "sensor_msgs.msg"),
    "type_description_interfaces.msg",  # for a service that each node has
    "type_description_interfaces.srv",
)


def start_zygote(preload: Sequence[str], owner: str = "") -> tuple[socket.socket, subprocess.Popen[bytes]]:
    """Start a new Python that imports the modules, and is then the process from which students are forked; return the
    socket to it. With an `owner` it forks that process, and becomes the owner: see `grader.sandbox.zygote`.
    """
    ours, theirs = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
    environment = for_trusted(RUNTIME_VARIABLES)
    environment |= variables(environment)
    # One thread: a child forked from several could hang. A fixed hash seed: sets have the same order in each run.
    environment |= {"OPENBLAS_NUM_THREADS": "1", "PYTHONHASHSEED": "0", "PYTHONDONTWRITEBYTECODE": "1"}
    environment["MALLOC_ARENA_MAX"] = "4"  # address space is limited: many threads would reserve 64 MiB of it each
    with theirs:
        process = subprocess.Popen(
            module_command("grader.sandbox.zygote", str(theirs.fileno()), owner, *preload),
            pass_fds=[theirs.fileno()],
            env=environment,
            cwd="/",
            stdin=subprocess.DEVNULL,
            start_new_session=True,
        )
    return ours, process
