"""Claims a file for one process of this machine. The kernel gives it back when the process ends, however it ends."""

from __future__ import annotations

import fcntl
import os
from collections.abc import Iterable
from pathlib import Path


def try_lock(file: Path) -> int | None:
    """The descriptor that holds the lock on `file`, until it is closed; None where another process holds it.

    The file is made if it is missing. Raises OSError where it can't be opened.
    """
    descriptor = _open(file)
    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError:
        os.close(descriptor)
        return None
    return descriptor


def claim_number(folder: Path, numbers: Iterable[int]) -> tuple[int, int] | None:
    """The first of `numbers` that nobody holds in `folder`, and the descriptor that holds it; None where all are taken.

    Numbers whose files can't be opened are left out.
    """
    for number in numbers:
        try:
            lock = try_lock(folder / str(number))
        except OSError:
            continue
        if lock is not None:
            return number, lock
    return None


def _open(file: Path) -> int:
    flags = os.O_RDONLY | os.O_CLOEXEC | os.O_NOFOLLOW
    try:
        return os.open(file, flags | os.O_CREAT, 0o644)
    except PermissionError:
        # In folders that all users share, the kernel forbids O_CREAT on others' files (fs.protected_regular).
        return os.open(file, flags)
