"""A ROS domain that no other rig on this machine uses."""

from __future__ import annotations

import fcntl
import os
import tempfile
from functools import cache
from pathlib import Path

from grader.sandbox import Isolation

#: Inside network namespaces of its own a rig is alone in every domain.
ALONE = 42

#: Domains whose UDP ports lie above those that Linux gives to programs which ask for none in particular
#: (7400 + 250 x domain > 60999), and which no ROS user takes by hand.
SHARED = range(215, 233)


@cache
def domain_for(isolation: Isolation) -> int:
    """The domain for this process; it stays this process's own until it ends. Raises OSError when none is left."""
    if isolation in (Isolation.BUBBLEWRAP, Isolation.NAMESPACES):
        return ALONE
    folder = Path(tempfile.gettempdir()) / f"spinbook-domains-{os.getuid()}"
    folder.mkdir(mode=0o700, exist_ok=True)
    for domain in SHARED:
        # Never closed: the lock goes with the process.
        lock = os.open(folder / str(domain), os.O_CREAT | os.O_RDWR | os.O_CLOEXEC | os.O_NOFOLLOW, 0o600)
        try:
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError:
            os.close(lock)
        else:
            return domain
    raise OSError("all ROS domains for rigs are in use by other gradings on this machine")
