"""The ROS domain of a notebook: one of its own, so that two notebooks open at once do not hear each other.

A domain is held by a lock on a file that every user of the machine can open; the lock goes when the kernel does,
however it ends. Domains up to 101 have ports below Linux's ephemeral range (ROS 2's concepts, "The ROS_DOMAIN_ID").
"""

from __future__ import annotations

import contextlib
import fcntl
import os
import tempfile
from dataclasses import dataclass
from pathlib import Path

#: 0 is everybody's default and is left to the terminals of this machine.
OWN_DOMAINS = range(1, 60)
HIGHEST = 101


@dataclass(frozen=True)
class Domain:
    """A ROS domain. `lock` is the open file that holds it, or None where it is shared with others on purpose."""

    number: int
    lock: int | None

    def release(self) -> None:
        """Give it back."""
        if self.lock is not None:
            os.close(self.lock)


class NoDomainLeft(Exception):
    """Every domain is held by some running notebook."""


def claim() -> Domain:
    """Take a domain that nobody on this machine holds. Raises NoDomainLeft."""
    folder = Path(tempfile.gettempdir()) / "spinbook-domains"
    folder.mkdir(exist_ok=True)
    with contextlib.suppress(PermissionError):
        folder.chmod(0o1777)
    # Begin at a place of this process's own, so that many notebooks that start at once do not queue at the first.
    start = os.getpid() % len(OWN_DOMAINS)
    for number in [*OWN_DOMAINS[start:], *OWN_DOMAINS[:start]]:
        with contextlib.suppress(OSError):
            lock = _open(folder / str(number))
            try:
                fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except OSError:
                os.close(lock)
                continue
            return Domain(number, lock)
    raise NoDomainLeft(
        f"all {len(OWN_DOMAINS)} ROS domains are in use by notebooks on this machine: close some of them."
    )


def _open(file: Path) -> int:
    try:
        return os.open(file, os.O_RDONLY | os.O_CREAT | os.O_CLOEXEC, 0o644)
    except PermissionError:
        # Sticky folders of other users forbid O_CREAT on what exists (fs.protected_regular).
        return os.open(file, os.O_RDONLY | os.O_CLOEXEC)


def shared(number: int) -> Domain:
    """A domain that others may use too. Raises ValueError where ROS has no such domain."""
    if not 0 <= number <= HIGHEST:
        raise ValueError(f"a ROS domain is a number from 0 to {HIGHEST}, not {number}.")
    return Domain(number, None)
