"""A student's processes without namespaces, and what /proc says about them.

Source: proc(5). Processes that end while they are read count as nothing.
"""

from __future__ import annotations

import contextlib
import os
import shutil
import signal
import tempfile
import time
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path

from grader.sandbox.filesystem import write_file
from grader.sandbox.program import Paths

_TICKS = os.sysconf("SC_CLK_TCK")
_PAGE = os.sysconf("SC_PAGE_SIZE")


@dataclass(frozen=True)
class Usage:
    """What one process has used: CPU seconds (with its reaped children), resident bytes, and its number of threads."""

    cpu_s: float = 0.0
    resident_bytes: int = 0
    threads: int = 0


def descendants(pid: int) -> set[int]:
    """Return the children of a process, and their descendants."""
    found: set[int] = set()
    new = {pid}
    while new:
        new = {child for parent in new for child in _children(parent)} - found
        found |= new
    return found


def usage(pid: int) -> Usage:
    """Return what a process has used so far."""
    fields = _fields(f"/proc/{pid}/stat")
    if not fields:
        return Usage()
    cpu_ticks = sum(int(fields[at]) for at in (11, 12, 13, 14))  # utime, stime, cutime, cstime
    return Usage(cpu_ticks / _TICKS, int(fields[21]) * _PAGE, int(fields[17]))


def proportional_bytes(pid: int) -> int:
    """Return the resident memory of a process, with what it shares divided by the number of sharers; 0 if unknown."""
    for line in _read(f"/proc/{pid}/smaps_rollup").splitlines():
        if line.startswith(b"Pss:"):
            return int(line.split()[1]) * 1024
    return 0


def _children(pid: int) -> set[int]:
    if not _kernel_lists_children():
        import psutil  # it takes long, and other kernels do without

        try:
            return {child.pid for child in psutil.Process(pid).children()}
        except psutil.Error:
            return set()
    found: set[int] = set()
    for thread in _names(f"/proc/{pid}/task"):
        found.update(map(int, _read(f"/proc/{pid}/task/{thread}/children").split()))
    return found


@cache
def _kernel_lists_children() -> bool:
    return Path("/proc/self/task", str(os.getpid()), "children").exists()


def _fields(path: str) -> list[str]:
    """Return the fields of a stat file from the third (the state) on; the second may contain anything."""
    return _read(path).rpartition(b")")[2].decode().split()


def _read(path: str) -> bytes:
    try:
        number = os.open(path, os.O_RDONLY)
    except OSError:
        return b""
    try:
        return os.read(number, 65536)
    except OSError:
        return b""
    finally:
        os.close(number)


def _names(folder: str) -> list[str]:
    try:
        return os.listdir(folder)  # noqa: PTH208 - names alone, many times per second
    except OSError:
        return []


def reaped_cpu_seconds(pid: int) -> float:
    """Return the CPU seconds of the children that a process has reaped."""
    fields = _fields(f"/proc/{pid}/stat")
    return (int(fields[13]) + int(fields[14])) / _TICKS if fields else 0.0


@dataclass(frozen=True)
class ProcessTree:
    """`Namespaces` without namespaces: the supervisor adopts the student's orphans (PR_SET_CHILD_SUBREAPER)."""

    folder: Path
    init: int = field(default_factory=os.getpid)
    own_processes: frozenset[int] = frozenset()

    def kill(self) -> None:
        """Kill what the student has started. `reap` finds what it starts meanwhile."""
        alive = descendants(self.init)
        for number in (signal.SIGSTOP, signal.SIGKILL):  # stopped processes can't fork
            for process in alive:
                with contextlib.suppress(ProcessLookupError):
                    os.kill(process, number)

    def reap(self) -> None:
        """Wait until everything is dead, and remove the folder."""
        while descendants(self.init):
            self.kill()
            with contextlib.suppress(ChildProcessError):
                while os.waitpid(-1, os.WNOHANG)[0]:
                    pass
            time.sleep(0.001)
        shutil.rmtree(self.folder, ignore_errors=True)


def make_paths(files: Mapping[str, bytes], owner: int | None) -> Paths:
    """Make a folder in the machine's temporary folder, with the submission's files and a home.

    `files` has the contents by name. `owner` is the user that the home is given to; None for the current one.
    """
    top = Path(tempfile.mkdtemp(prefix="spinbook-student-"))
    top.chmod(0o755)
    submission, home, temporary = top / "submission", top / "home", top / "tmp"
    for folder in (submission, home, temporary):
        folder.mkdir(mode=0o755)
        if owner is not None and folder is not submission:
            os.chown(folder, owner, owner)
    for name, content in files.items():
        write_file(submission, name, content)
    return Paths(str(submission), str(home), str(temporary))
