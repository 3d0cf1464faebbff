"""What a student's program may use, and how the kernel is told."""

from __future__ import annotations

import contextlib
import os
import resource
from dataclasses import dataclass
from pathlib import Path

_MIB = 1024 * 1024


@dataclass(frozen=True)
class Limits:
    """What one start of a student's program may use before it is killed.

    CPU time and blocked time decide verdicts (the rig counts them); these are the outer walls, wide enough for
    every honest program on a busy machine.
    """

    cpu_s: float = 60.0
    """CPU seconds of all its processes together."""
    memory_bytes: int = 2048 * _MIB
    """Address space of one process, and resident memory of all. Below 512 MiB rclpy does not start."""
    processes: int = 128
    """Processes and threads together. rclpy takes about a dozen, and hangs instead of failing with less than 20."""
    file_bytes: int = 64 * _MIB
    """One file, and each of /tmp, the home directory and /dev/shm as a whole."""
    output_bytes: int = 16 * _MIB
    """What it prints."""
    wall_s: float = 300.0
    """Seconds from its start to its end, only to catch what every other limit misses."""

    def __post_init__(self) -> None:
        """Refuses what rclpy is known not to start with.

        Raises:
            ValueError: if the memory is below 512 MiB or there are fewer than 20 processes.
        """
        if self.memory_bytes < 512 * _MIB:
            raise ValueError(f"memory_bytes is {self.memory_bytes}: rclpy needs at least {512 * _MIB} (512 MiB)")
        if self.processes < 20:
            raise ValueError(f"processes is {self.processes}: rclpy's own threads need at least 20")


def apply(limits: Limits, *, processes_beside: int = 0) -> None:
    """Sets the kernel's limits for this process and its children: setrlimit(2).

    Args:
        limits: what is allowed.
        processes_beside: processes and threads of the same user that the kernel counts too: 0 in a user namespace of
            its own, on a kernel that counts for each namespace.
    """
    cpu_s = int(limits.cpu_s) + 1
    wanted = {
        resource.RLIMIT_AS: limits.memory_bytes,
        resource.RLIMIT_NPROC: limits.processes + processes_beside,
        resource.RLIMIT_FSIZE: limits.file_bytes,
        resource.RLIMIT_NOFILE: 1024,  # liblockstep looks at each thread of the program through three files
        resource.RLIMIT_CORE: 0,
        resource.RLIMIT_MEMLOCK: 8 * _MIB,
        resource.RLIMIT_MSGQUEUE: 0,
    }
    for which, value in wanted.items():
        hard = resource.getrlimit(which)[1]
        value = value if hard == resource.RLIM_INFINITY else min(value, hard)
        resource.setrlimit(which, (value, value))
    resource.setrlimit(resource.RLIMIT_CPU, (cpu_s, cpu_s + 1))


def tasks_of_user(uid: int) -> int:
    """The processes and threads that a user has on this machine now, which RLIMIT_NPROC counts."""
    count = 0
    for entry in os.scandir("/proc"):
        if entry.name.isdigit():
            with contextlib.suppress(OSError):  # it has just ended
                if entry.stat().st_uid == uid:
                    count += len(os.listdir(Path(entry.path) / "task"))  # noqa: PTH208 - names alone
    return count


def counts_for_each_user_namespace() -> bool:
    """Whether the kernel counts a user's processes in each user namespace by itself: since Linux 5.14."""
    major, minor = os.uname().release.split(".")[:2]
    return (int(major), int("".join(filter(str.isdigit, minor)) or 0)) >= (5, 14)
