"""Makes the user namespace of one student: two users in it at most, and none that owns anything outside."""

from __future__ import annotations

import os
from pathlib import Path

from . import kernel
from .view import USER_ID

# Users whom systemd reserves for services without a user of their own; nobody's files belong to them.
_FIRST, _COUNT = 61184, 4336


_of_process: dict[int, int] = {}


def of_this_process() -> int:
    """The user namespace of all students that this process starts, one after the other; made when first asked for.

    Raises:
        OSError: if this machine allows no user namespaces.
    """
    if os.getpid() not in _of_process:
        _of_process[os.getpid()] = create()
    return _of_process[os.getpid()]


def create() -> int:
    """Makes a user namespace and returns a descriptor of it.

    As root, a user of no other process becomes the student (the kernel does not limit the number of root's
    processes), and root stays root inside, so that what we leave running there is out of the student's reach.
    Otherwise the only user is the present one, under the student's number.

    Raises:
        OSError: if this machine allows no user namespaces.
    """
    if os.geteuid() == 0:
        users = f"0 0 1\n{USER_ID} {dedicated_user()} 1\n"
        groups = users
    else:
        users, groups = f"{USER_ID} {os.geteuid()} 1\n", f"{USER_ID} {os.getegid()} 1\n"
    told_at, told_to = os.pipe()
    ended_at, ended_to = os.pipe()
    child = os.fork()
    if child == 0:
        try:
            os.close(ended_to)
            kernel.unshare(kernel.CLONE_NEWUSER)
            os.write(told_to, b"ready")
            os.read(ended_at, 1)
        except BaseException as fault:
            os.write(told_to, str(fault).encode())
        finally:
            os._exit(0)
    os.close(told_to)
    os.close(ended_at)
    try:
        said = os.read(told_at, 4096)
        if said != b"ready":
            raise OSError(f"this machine allows no user namespaces: {said.decode(errors='replace')}")
        process = Path(f"/proc/{child}")
        (process / "setgroups").write_text("deny")
        (process / "uid_map").write_text(users)
        (process / "gid_map").write_text(groups)
        return os.open(process / "ns" / "user", os.O_RDONLY | os.O_CLOEXEC)
    finally:
        os.close(told_at)
        os.close(ended_to)
        os.waitpid(child, 0)


def dedicated_user() -> int:
    """A user number for a student whom root starts, different from one keeper process to the next."""
    return _FIRST + os.getpid() % _COUNT
