"""What /proc tells about a student's processes: which there are, and what they have used.

Source: proc(5). Processes end while they are looked at; what has ended counts nothing.
"""

from __future__ import annotations

import os
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import psutil

_TICKS = os.sysconf("SC_CLK_TCK")
_PAGE = os.sysconf("SC_PAGE_SIZE")


@dataclass(frozen=True)
class Usage:
    """What one process has used: CPU seconds with its buried children, resident bytes, and its number of threads."""

    cpu_s: float = 0.0
    resident_bytes: int = 0
    threads: int = 0


def descendants(pid: int) -> set[int]:
    """The children of a process, and theirs."""
    found: set[int] = set()
    new = {pid}
    while new:
        new = {child for parent in new for child in _children(parent)} - found
        found |= new
    return found


def usage(pid: int) -> Usage:
    """What a process has used until now."""
    fields = _fields(f"/proc/{pid}/stat")
    if not fields:
        return Usage()
    cpu_ticks = sum(int(fields[at]) for at in (11, 12, 13, 14))  # utime, stime, cutime, cstime
    return Usage(cpu_ticks / _TICKS, int(fields[21]) * _PAGE, int(fields[17]))


def proportional_bytes(pid: int) -> int:
    """The resident memory of a process, with what it shares divided by how many share it; 0 if that is not told."""
    for line in _read(f"/proc/{pid}/smaps_rollup").splitlines():
        if line.startswith(b"Pss:"):
            return int(line.split()[1]) * 1024
    return 0


def _children(pid: int) -> set[int]:
    if not _kernel_lists_children():
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
    """The fields of a stat file from the third (the state) on; the second may contain anything."""
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
        return os.listdir(folder)  # noqa: PTH208 - names alone, many times a second
    except OSError:
        return []


def buried_cpu_seconds(pid: int) -> float:
    """The CPU seconds of the children that a process has buried."""
    fields = _fields(f"/proc/{pid}/stat")
    return (int(fields[13]) + int(fields[14])) / _TICKS if fields else 0.0
