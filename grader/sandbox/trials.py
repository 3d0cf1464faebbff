"""Which levels have been tried and work, kept until something changes that this depends on.

A trial takes as long as the spins of four scenarios. What is kept makes no start less safe: each start makes its
sandbox anew, and where a step of that fails nothing runs. What did not work is not kept.
"""

from __future__ import annotations

import contextlib
import hashlib
import os
import resource
import shutil
import sys
from collections.abc import Iterator
from pathlib import Path

from grader.files import cached, write_if_changed
from grader.sandbox import filesystem

#: What decides on this machine whether a process may make namespaces, and which process this is: proc(5), and
#: user_namespaces(7). The first differs each time that the machine is started.
_FILES = (
    "/proc/sys/kernel/random/boot_id",
    "/proc/sys/user/max_user_namespaces",
    "/proc/sys/kernel/unprivileged_userns_clone",
    "/proc/sys/kernel/apparmor_restrict_unprivileged_userns",
    "/proc/self/attr/current",
    "/proc/self/uid_map",
)
_NAMESPACES = ("user", "mnt", "pid", "net", "ipc")
_STATUS = ("Uid", "Gid", "CapEff", "CapBnd", "NoNewPrivs", "Seccomp", "Seccomp_filters")


def has_worked(level: str) -> bool:
    """Whether a trial of this level has worked, under all the same circumstances."""
    try:
        return _file(level).exists()
    except OSError:  # another user's folder: it is tried each time
        return False


def keep(level: str) -> None:
    """Remember that a trial has worked."""
    with contextlib.suppress(OSError):  # where nothing can be kept, it is tried each time
        write_if_changed(_file(level), "")


def forget() -> None:
    """Try every level again the next time: a sandbox could not be made that ought to work."""
    shutil.rmtree(cached("sandbox"), ignore_errors=True)


def _file(level: str) -> Path:
    text = "\n".join((level, *_circumstances()))
    return cached("sandbox") / f"{level}-{hashlib.sha256(text.encode()).hexdigest()[:32]}"


def _circumstances() -> Iterator[str]:
    yield from map(_text, _FILES)
    yield from (line for line in _text("/proc/self/status").splitlines() if line.partition(":")[0] in _STATUS)
    for name in _NAMESPACES:
        with contextlib.suppress(OSError):
            yield os.readlink(f"/proc/self/ns/{name}")  # noqa: PTH115 - no path
    yield repr([resource.getrlimit(which) for which in (resource.RLIMIT_NPROC, resource.RLIMIT_AS)])
    yield repr((sys.executable, sys.version))
    for name in sorted({*filesystem.RUNTIME_VARIABLES} - {"PATH"}):
        yield f"{name}={sorted(os.environ.get(name, '').split(os.pathsep))}"  # ROS's wheels give theirs in any order
    bubblewrap = shutil.which("bwrap")
    for file in (*sorted(Path(__file__).parent.glob("*.py")), *([Path(bubblewrap)] if bubblewrap else [])):
        found = file.stat()
        yield f"{file} {found.st_mtime_ns} {found.st_size} {found.st_mode}"


def _text(file: str) -> str:
    try:
        return Path(file).read_text(errors="replace")
    except OSError:
        return ""
