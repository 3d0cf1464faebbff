"""The specification of a program in a sandbox: files, arguments, paths and limits; and the errors."""

from __future__ import annotations

import contextlib
import os
import resource
from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import Enum
from pathlib import Path, PurePosixPath

SUBMISSION = "/submission"

#: The descriptor of every program through which its processes connect to the hub.
HUB = 1000
#: How many files a program may have open: `HUB` is one of them, and liblockstep reads three per thread of the program.
OPEN_FILES = 1024

#: The message to the fork server that requests a supervisor. Any other message is the name of a module to import.
START_REQUEST = b" start"


#: What lets students' programs have the strongest sandbox in a Docker container, as doctor and docs say it, too.
IN_DOCKER = "docker run " + " ".join(
    f"--security-opt {option}=unconfined" for option in ("seccomp", "apparmor", "systempaths")
)


class SandboxUnavailable(Exception):
    """Raised if this machine does not allow the requested sandbox or lacks the middleware."""


class SandboxError(Exception):
    """Raised if a sandbox could not be made or ended: a fault of ours or the machine's, never the student's."""


class Isolation(str, Enum):
    """The levels, strongest first. docs/sandbox.md says what each of them isolates."""

    BUBBLEWRAP = "bubblewrap"
    """Namespaces of its own, made by bubblewrap."""
    NAMESPACES = "namespaces"
    """The same namespaces, made by our own system calls."""
    LANDLOCK = "landlock"
    """No namespaces: the kernel's Landlock for files, seccomp for the network."""
    NONE = "none"
    """A plain process of the same user, with limits. For code that you trust."""

    def __str__(self) -> str:
        """Return the word that is used on the command line and in a grade."""
        return self.value


@dataclass(frozen=True)
class ProgramSpec:
    """A student's program.

    Attributes:
        main: the Python file to run as `__main__`: a name in `files`, or an absolute path inside one of `readonly`
            (the executable of an installed package).
        files: name to content, written into the read-only folder /submission. Contents and not paths, so that neither a
            symlink nor a change made meanwhile can show the program another file of this machine.
        arguments: what follows the file's name in sys.argv.
        environment: variables beyond those that Python and ROS 2 need; nothing of the caller's own is passed on.
        readonly: files and folders of this machine that the program sees, read-only, at the same path.
        hidden: files and folders of this machine that it never sees, even inside one that it does.
        hub: the descriptor, in the caller's process, of the socket through which each of its processes connects to the
            hub. None: it runs in the computer's time, and reaches no other program.
        preloaded: run in a fork of the fork server, in which rclpy has been imported already. Otherwise in a new Python
        process.
    """

    main: str
    files: Mapping[str, bytes] = field(default_factory=dict)
    arguments: tuple[str, ...] = ()
    environment: Mapping[str, str] = field(default_factory=dict)
    readonly: tuple[Path, ...] = ()
    hidden: tuple[Path, ...] = ()
    preloaded: bool = True
    hub: int | None = None

    def __post_init__(self) -> None:
        """Check that all paths are inside the submission's folder and that the main file exists.

        Raises ValueError for a path that could lead outside or has a NUL in it, or a main file that does not exist.
        """
        for name in self.files:
            if any(part in ("", ".", "..") for part in name.split("/")) or "\0" in name:
                raise ValueError(f"{name!r} is not a path inside the submission")
        absolute = PurePosixPath(self.main).is_absolute()
        if not absolute and self.main not in self.files:
            raise ValueError(f"the main file {self.main!r} is not among the files: {', '.join(self.files) or 'none'}")
        if absolute and not any(Path(self.main).is_relative_to(shown) for shown in self.readonly):
            raise ValueError(f"the main file {self.main} is in none of the readonly folders")


@dataclass(frozen=True)
class Paths:
    """The folders of a student's program, as it sees them: its files, its home, for temporary files."""

    folder: str
    home: str
    temporary: str


_MIB = 1024 * 1024


@dataclass(frozen=True)
class Limits:
    """What one start of a student's program may use before it is killed.

    CPU time and blocked time decide verdicts (the runner counts them); these are the outer limits, wide enough for
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
    """Bytes that it prints."""
    wall_s: float = 300.0
    """Seconds from its start to its end, only to catch what every other limit misses."""

    def __post_init__(self) -> None:
        """Refuse limits that rclpy is known not to start with.

        Raises ValueError if the memory is below 512 MiB or there are fewer than 20 processes.
        """
        if self.memory_bytes < 512 * _MIB:
            raise ValueError(f"memory_bytes is {self.memory_bytes}: rclpy needs at least {512 * _MIB} (512 MiB)")
        if self.processes < 20:
            raise ValueError(f"processes is {self.processes}: rclpy's own threads need at least 20")


def apply_limits(limits: Limits, *, other_processes: int) -> None:
    """Set the kernel's limits for this process and its children: setrlimit(2).

    `limits` is what is allowed. `other_processes` is how many processes and threads of the same user the kernel counts,
    too: 0 in a user namespace of its own, on a kernel that counts for each namespace.
    """
    cpu_s = int(limits.cpu_s) + 1
    rlimits = {
        resource.RLIMIT_AS: limits.memory_bytes,
        resource.RLIMIT_NPROC: limits.processes + other_processes,
        resource.RLIMIT_FSIZE: limits.file_bytes,
        resource.RLIMIT_NOFILE: OPEN_FILES,
        resource.RLIMIT_CORE: 0,
        resource.RLIMIT_MEMLOCK: 8 * _MIB,
        resource.RLIMIT_MSGQUEUE: 0,
    }
    for which, value in rlimits.items():
        hard = resource.getrlimit(which)[1]
        value = value if hard == resource.RLIM_INFINITY else min(value, hard)
        resource.setrlimit(which, (value, value))
    resource.setrlimit(resource.RLIMIT_CPU, (cpu_s, cpu_s + 1))


def tasks_of_user(uid: int) -> int:
    """Return how many processes and threads a user has on this machine now, as RLIMIT_NPROC counts them."""
    count = 0
    for entry in os.scandir("/proc"):
        if entry.name.isdigit():
            with contextlib.suppress(OSError):  # it has just ended
                if entry.stat().st_uid == uid:
                    count += len(os.listdir(Path(entry.path) / "task"))  # noqa: PTH208 - names alone
    return count


def counts_for_each_user_namespace() -> bool:
    """Return whether the kernel counts a user's processes separately in each user namespace: since Linux 5.14."""
    major, minor = os.uname().release.split(".")[:2]
    return (int(major), int("".join(filter(str.isdigit, minor)) or 0)) >= (5, 14)
