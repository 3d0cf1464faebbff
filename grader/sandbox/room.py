"""The namespaces that a student's program runs in, once they have been made, and how they end."""

from __future__ import annotations

import contextlib
import os
import signal
import subprocess
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from . import kernel
from .program import SUBMISSION


@dataclass(frozen=True)
class Room:
    """A pid namespace with a root of its own, as seen by the process outside that made it.

    Attributes:
        init: the first process of the pid namespace; when it dies, the kernel kills all others.
        holders: processes of ours inside, which are not the student's.
        builder: the bubblewrap process outside, parent of `init`; None if `init` is this process's own child.
    """

    init: int
    holders: frozenset[int] = frozenset()
    builder: subprocess.Popen[bytes] | None = None

    def kill(self) -> None:
        """Kills everything inside. It is dead when `bury` returns."""
        with contextlib.suppress(ProcessLookupError):
            os.kill(self.init, signal.SIGKILL)

    def bury(self) -> None:
        """Returns when all is dead. Children of the caller inside have to be waited for before.

        The death of a namespace's first process is told to its parent only after every other process in it is gone:
        pid_namespaces(7).
        """
        if self.builder is not None:
            self.builder.wait()
        # bubblewrap may end without having waited for it: then it has become a child of this process.
        with contextlib.suppress(ChildProcessError):
            os.waitpid(self.init, 0)

    def forget(self) -> None:
        """Closes, in a fork of the process that made the room, what keeps it open."""
        if self.builder is not None:
            for stream in (self.builder.stdin, self.builder.stdout, self.builder.stderr):
                if stream is not None:
                    stream.close()
            self.builder.returncode = 0  # not this process's child


def place(files: Mapping[str, bytes]) -> None:
    """Writes the submission's files into a read-only tmpfs at /submission. Called inside the room's mounts."""
    size = sum(len(content) // 4096 + 1 for content in files.values()) * 4096 + 65536
    kernel.mount("tmpfs", SUBMISSION, "tmpfs", kernel.MS_NOSUID | kernel.MS_NODEV, f"mode=0755,size={size}")
    for name, content in files.items():
        path = Path(SUBMISSION, name)
        path.write_bytes(content)
        path.chmod(0o444)
    kernel.make_read_only(SUBMISSION)
