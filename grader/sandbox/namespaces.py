"""Makes a student's namespaces with system calls of our own, as bubblewrap would."""

from __future__ import annotations

import os
import signal
from collections.abc import Sequence
from pathlib import Path
from typing import NoReturn

from . import kernel, seccomp
from .room import Room
from .view import Step

# Where the former root lies while the new one is built.
_OLD = "/.old"
_MOUNT = kernel.MS_NOSUID | kernel.MS_NODEV


def build(plan: Sequence[Step], user_namespace: int, *, network: bool) -> Room:
    """Makes the namespaces and their root, and moves this process into them (all but the pid namespace's children).

    With `network` the network stays the one that this process is in; otherwise there is none, not even loopback.

    Raises:
        OSError: if a namespace or a mount is refused.
    """
    kernel.setns(user_namespace, kernel.CLONE_NEWUSER)
    flags = kernel.CLONE_NEWNS | kernel.CLONE_NEWPID | kernel.CLONE_NEWIPC | kernel.CLONE_NEWUTS
    kernel.unshare(flags if network else flags | kernel.CLONE_NEWNET)
    kernel.sethostname("student")
    os.chdir("/")
    told_at, told_to = os.pipe()
    init = os.fork()
    if init == 0:
        _be_init(plan, told_to, network)
    os.close(told_to)
    with os.fdopen(told_at, "rb") as stream:
        said = stream.read()
    if said != b"ready":
        os.waitpid(init, 0)
        raise OSError(said.decode(errors="replace") or "the first process of the namespace died")
    return Room(init)


def _be_init(plan: Sequence[Step], told_to: int, network: bool) -> NoReturn:
    """The first process of the pid namespace: builds the root, then only buries orphans until it is killed."""
    try:
        kernel.prctl(kernel.PR_SET_PDEATHSIG, signal.SIGKILL)
        kernel.prctl(kernel.PR_SET_NAME, b"init")
        signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGCHLD})
        build_root(plan)
        kernel.drop_bounding_capabilities()
        kernel.drop_capabilities()
        kernel.prctl(kernel.PR_SET_NO_NEW_PRIVS, 1)
        kernel.prctl(kernel.PR_SET_DUMPABLE, 0)
        if seccomp.supported():
            seccomp.install(seccomp.program(network=network))
        os.write(told_to, b"ready")
    except BaseException as fault:
        os.write(told_to, str(fault).encode())
        os._exit(1)
    os.closerange(0, 256)
    while True:
        signal.sigwait({signal.SIGCHLD})
        try:
            while os.waitpid(-1, os.WNOHANG)[0]:
                pass
        except ChildProcessError:
            pass


def build_root(plan: Sequence[Step]) -> None:
    """Replaces the root of this mount namespace by the one that the steps describe.

    Raises:
        OSError: if a mount is refused.
    """
    kernel.mount("", "/", flags=kernel.MS_REC | kernel.MS_PRIVATE)
    kernel.mount("tmpfs", "/tmp", "tmpfs", _MOUNT, "mode=0755")
    Path("/tmp" + _OLD).mkdir()
    kernel.pivot_root("/tmp", "/tmp" + _OLD)
    os.chdir("/")
    for step in plan:
        if step.path != "/":
            _take(step)
    kernel.unmount(_OLD)
    Path(_OLD).rmdir()
    _seal("/")


def _take(step: Step) -> None:
    path = Path(step.path)
    if step.action == "folder":
        path.mkdir(mode=0o755)
    elif step.action == "scratch":
        path.mkdir(exist_ok=True)
        kernel.mount("tmpfs", step.path, "tmpfs", _MOUNT, f"mode=1777,size={step.size}")
    elif step.action in ("bind", "device"):
        _bind(_OLD + (step.content or step.path), path)
        kernel.make_read_only(step.path, devices=step.action == "device")
    elif step.action == "mask" and path.is_dir():
        kernel.mount("tmpfs", step.path, "tmpfs", _MOUNT, "mode=0755,size=64k")
    elif step.action == "mask":
        kernel.mount(_OLD + "/dev/null", step.path, flags=kernel.MS_BIND)
    elif step.action == "link":
        path.symlink_to(step.content)
    elif step.action == "text":
        path.write_text(step.content)
        path.chmod(0o644)
    elif step.action == "processes":
        path.mkdir()
        _mount_processes(step.path)
    elif step.action == "seal":
        _seal(step.path)


def _bind(source: str, target: Path) -> None:
    if Path(source).is_dir():
        target.mkdir(exist_ok=True)
    else:
        target.touch()
    kernel.mount(source, str(target), flags=kernel.MS_BIND | kernel.MS_REC)


def _mount_processes(target: str) -> None:
    """Mounts /proc, in which a program's processes look whether they are idle."""
    try:
        kernel.mount("proc", target, "proc", _MOUNT | kernel.MS_NOEXEC)
    except PermissionError as fault:
        allow = "docker run --security-opt systempaths=unconfined"
        raise OSError(f"this container hides parts of its /proc, so none can be mounted ({allow}): {fault}") from fault


def _seal(target: str) -> None:
    flags = kernel.MS_REMOUNT | kernel.MS_BIND | kernel.MS_RDONLY | _MOUNT
    kernel.mount("", target, flags=flags)
