"""Fast DDS only: takes a runner and its students out of the machine's network and shared memory."""

from __future__ import annotations

import os
from pathlib import Path

from grader.sandbox import namespaces, syscalls
from grader.sandbox.isolation import Isolation
from grader.sandbox.program import SandboxError


def enter(isolation: Isolation) -> None:
    """Move this process into namespaces of its own: a network with nothing but loopback, /dev/shm, and System V IPC.

    Only for students without a hub, which talk to their runner over Fast DDS. Those with a hub have no network.

    Call it in a freshly forked process with a single thread, before rclpy is initialised. Its students join the same
    network, so that runner and student can reach each other and nothing else. At the levels without namespaces only
    orphans are caught (see PR_SET_CHILD_SUBREAPER in prctl(2)); there a ROS domain of its own separates the runner.

    Called again by the same thread, before its next student, it moves into another new network: in the old one the
    kernel may still reserve a port for a connection of the previous student.

    Raises:
        OSError: if this machine allows no such namespaces.
    """
    syscalls.prctl(syscalls.PR_SET_CHILD_SUBREAPER, 1)
    if isolation not in (Isolation.BUBBLEWRAP, Isolation.NAMESPACES):
        return
    if _made:
        syscalls.unshare(syscalls.CLONE_NEWNET)
        syscalls.bring_loopback_up()
        return
    flags = syscalls.CLONE_NEWNET | syscalls.CLONE_NEWNS | syscalls.CLONE_NEWIPC
    user, group = os.geteuid(), os.getegid()
    try:
        syscalls.unshare(flags if user == 0 else flags | syscalls.CLONE_NEWUSER)
    except OSError as fault:
        which = "network or mount" if user == 0 else "user"
        raise OSError(f"this machine allows no {which} namespaces: {fault}") from fault
    if user != 0:
        Path("/proc/self/setgroups").write_text("deny")
        Path("/proc/self/uid_map").write_text(f"{user} {user} 1\n")
        Path("/proc/self/gid_map").write_text(f"{group} {group} 1\n")
    syscalls.mount("", "/", flags=syscalls.MS_REC | syscalls.MS_PRIVATE)
    if Path("/dev/shm").is_dir():
        syscalls.mount("tmpfs", "/dev/shm", "tmpfs", syscalls.MS_NOSUID | syscalls.MS_NODEV, "mode=1777,size=64m")
    syscalls.bring_loopback_up()
    _made.append(namespaces.create_user_namespace())


# The descriptor of the students' user namespace, once this process is a runner.
_made: list[int] = []


def students_users() -> int:
    """Return the user namespace that this runner's students run in, in turn: a descriptor.

    Raises:
        SandboxError: if this process has not entered namespaces of its own.
    """
    if not _made:
        raise SandboxError("call grader.sandbox.enter(isolation) in the rig's process before it starts a student")
    return _made[-1]
