"""Spreads gradings over the CPUs of a machine, also those of several processes that know nothing of one another."""

from __future__ import annotations

import contextlib
import fcntl
import os
import tempfile
from collections.abc import Iterator
from pathlib import Path


@contextlib.contextmanager
def own_core() -> Iterator[int]:
    """A CPU to keep a program on. It is that of the first number that nobody on this machine holds: 0, 1, 2 …"""
    folder = Path(tempfile.gettempdir()) / f"spinbook-cores-{os.getuid()}"
    folder.mkdir(mode=0o700, exist_ok=True)
    cores = sorted(os.sched_getaffinity(0))
    for number in range(1024):
        lock = os.open(folder / str(number), os.O_CREAT | os.O_RDWR | os.O_CLOEXEC | os.O_NOFOLLOW, 0o600)
        try:
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError:
            os.close(lock)
            continue
        try:
            yield cores[number % len(cores)]
        finally:
            os.close(lock)
        return
    yield cores[0]
