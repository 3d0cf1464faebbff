"""Makes a student's namespaces with system calls, and ends them."""

from __future__ import annotations

import contextlib
import os
import signal
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import NoReturn

from grader.sandbox import seccomp, syscalls
from grader.sandbox.filesystem import USER_ID, Mount, dedicated_user, write_file
from grader.sandbox.program import IN_DOCKER, SUBMISSION


@dataclass(frozen=True)
class Builder:
    """A process that holds namespaces open until its input is closed, and the ends of the pipes to it."""

    pid: int
    input: int
    output: int
    errors: int

    def wait(self) -> int:
        """Wait for its end; return its exit code, or the negative number of the signal that ended it."""
        return os.waitstatus_to_exitcode(os.waitpid(self.pid, 0)[1])


@dataclass(frozen=True)
class Namespaces:
    """A pid namespace with a root of its own, as seen by the process outside that made it.

    `init` is the first process of the pid namespace; when it dies, the kernel kills all others. `own_processes` are
    processes of ours inside, which are not the student's. `builder` is the bubblewrap process outside, parent of
    `init`; None if `init` is this process's own child.
    """

    init: int
    own_processes: frozenset[int] = frozenset()
    builder: Builder | None = None

    def kill(self) -> None:
        """Kill everything inside. It is dead when `reap` returns."""
        with contextlib.suppress(ProcessLookupError):
            os.kill(self.init, signal.SIGKILL)

    def reap(self) -> None:
        """Wait until everything is dead. The caller has to wait for its own children inside first.

        The parent is notified of the death of a namespace's first process only after every other process in it is gone:
        pid_namespaces(7).
        """
        if self.builder is not None:
            self.builder.wait()
        # If bubblewrap ended without waiting for it, it has become a child of this process.
        with contextlib.suppress(ChildProcessError):
            os.waitpid(self.init, 0)

    def forget(self) -> None:
        """Close the descriptors that keep the namespaces open, in a fork of the process that made them."""
        if self.builder is not None:
            for number in (self.builder.input, self.builder.output, self.builder.errors):
                os.close(number)


def write_files(files: Mapping[str, bytes]) -> None:
    """Write the submission's files into a read-only tmpfs at /submission. Called in the sandbox's mount namespace."""
    size = sum(len(content) // 4096 + 3 for content in files.values()) * 4096 + 65536
    syscalls.mount("tmpfs", SUBMISSION, "tmpfs", syscalls.MS_NOSUID | syscalls.MS_NODEV, f"mode=0755,size={size}")
    for name, content in files.items():
        write_file(Path(SUBMISSION), name, content)
    syscalls.make_read_only(SUBMISSION)


# Where the former root is while the new one is built.
_OLD = "/.old"
_MOUNT = syscalls.MS_NOSUID | syscalls.MS_NODEV


def build(plan: Sequence[Mount], user_namespace: int) -> Namespaces:
    """Make the namespaces and their root, and move this process into them (except the pid namespace's children).

    There is no network, not even loopback. Raises OSError if a namespace or a mount is refused.
    """
    syscalls.setns(user_namespace, syscalls.CLONE_NEWUSER)
    flags = syscalls.CLONE_NEWNS | syscalls.CLONE_NEWPID | syscalls.CLONE_NEWIPC | syscalls.CLONE_NEWUTS
    syscalls.unshare(flags | syscalls.CLONE_NEWNET)
    syscalls.sethostname("student")
    os.chdir("/")
    status_read, status_write = os.pipe()
    init = os.fork()
    if init == 0:
        _be_init(plan, status_write)
    os.close(status_write)
    with os.fdopen(status_read, "rb") as stream:
        status = stream.read()
    if status != b"ready":
        os.waitpid(init, 0)
        raise OSError(status.decode(errors="replace") or "the first process of the namespace died")
    return Namespaces(init)


def _be_init(plan: Sequence[Mount], status_write: int) -> NoReturn:
    """Run the first process of the pid namespace: build the root, then only reap orphans until killed."""
    try:
        syscalls.prctl(syscalls.PR_SET_PDEATHSIG, signal.SIGKILL)
        syscalls.prctl(syscalls.PR_SET_NAME, b"init")
        signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGCHLD})
        build_root(plan)
        syscalls.drop_bounding_capabilities()
        syscalls.drop_capabilities()
        syscalls.prctl(syscalls.PR_SET_NO_NEW_PRIVS, 1)
        syscalls.prctl(syscalls.PR_SET_DUMPABLE, 0)
        if seccomp.supported():
            seccomp.install(seccomp.program())
        os.write(status_write, b"ready")
    except BaseException as fault:
        os.write(status_write, str(fault).encode())
        os._exit(1)
    os.closerange(0, 256)
    while True:
        signal.sigwait({signal.SIGCHLD})
        try:
            while os.waitpid(-1, os.WNOHANG)[0]:
                pass
        except ChildProcessError:
            pass


def build_root(plan: Sequence[Mount]) -> None:
    """Replace the root of this mount namespace by the one that the steps describe.

    Raises OSError if a mount is refused.
    """
    syscalls.mount("", "/", flags=syscalls.MS_REC | syscalls.MS_PRIVATE)
    syscalls.mount("tmpfs", "/tmp", "tmpfs", _MOUNT, "mode=0755")
    Path("/tmp" + _OLD).mkdir()
    syscalls.pivot_root("/tmp", "/tmp" + _OLD)
    os.chdir("/")
    for step in plan:
        if step.path != "/":
            _take(step)
    syscalls.unmount(_OLD)
    Path(_OLD).rmdir()
    _seal("/")


def _take(step: Mount) -> None:
    path = Path(step.path)
    if step.action == "folder":
        path.mkdir(mode=0o755)
    elif step.action == "scratch":
        path.mkdir(exist_ok=True)
        syscalls.mount("tmpfs", step.path, "tmpfs", _MOUNT, f"mode=1777,size={step.size}")
    elif step.action in ("bind", "device"):
        _bind(_OLD + (step.content or step.path), path)
        syscalls.make_read_only(step.path, devices=step.action == "device")
    elif step.action == "mask" and path.is_dir():
        syscalls.mount("tmpfs", step.path, "tmpfs", _MOUNT, "mode=0755,size=64k")
    elif step.action == "mask":
        syscalls.mount(_OLD + "/dev/null", step.path, flags=syscalls.MS_BIND)
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
    syscalls.mount(source, str(target), flags=syscalls.MS_BIND | syscalls.MS_REC)


def _mount_processes(target: str) -> None:
    """Mount /proc, in which a program's processes check whether they are idle."""
    try:
        syscalls.mount("proc", target, "proc", _MOUNT | syscalls.MS_NOEXEC)
    except PermissionError as fault:
        raise OSError(
            f"this container hides parts of its /proc, so none can be mounted ({IN_DOCKER}): {fault}"
        ) from fault


def _seal(target: str) -> None:
    flags = syscalls.MS_REMOUNT | syscalls.MS_BIND | syscalls.MS_RDONLY | _MOUNT
    syscalls.mount("", target, flags=flags)


_of_process: dict[int, int] = {}


def user_namespace_of_this_process() -> int:
    """Return the user namespace that this process uses for all students; the first call makes it.

    Raises OSError if this machine allows no user namespaces.
    """
    if os.getpid() not in _of_process:
        _of_process[os.getpid()] = create_user_namespace()
    return _of_process[os.getpid()]


def create_user_namespace() -> int:
    """Make a user namespace and return a descriptor of it.

    As root, a user of no other process becomes the student (the kernel does not limit the number of root's processes),
    and root stays root inside, so the student can't reach what we leave running there. Otherwise the only user is the
    current one, under the student's number. Raises OSError if this machine allows no user namespaces.
    """
    if os.geteuid() == 0:
        users = f"0 0 1\n{USER_ID} {dedicated_user()} 1\n"
        groups = users
    else:
        users, groups = f"{USER_ID} {os.geteuid()} 1\n", f"{USER_ID} {os.getegid()} 1\n"
    status_read, status_write = os.pipe()
    ended_at, ended_to = os.pipe()
    child = os.fork()
    if child == 0:
        try:
            os.close(ended_to)
            syscalls.unshare(syscalls.CLONE_NEWUSER)
            os.write(status_write, b"ready")
            os.read(ended_at, 1)
        except BaseException as fault:
            os.write(status_write, str(fault).encode())
        finally:
            os._exit(0)
    os.close(status_write)
    os.close(ended_at)
    try:
        status = os.read(status_read, 4096)
        if status != b"ready":
            raise OSError(f"this machine allows no user namespaces: {status.decode(errors='replace')}")
        process = Path(f"/proc/{child}")
        (process / "setgroups").write_text("deny")
        (process / "uid_map").write_text(users)
        (process / "gid_map").write_text(groups)
        return os.open(process / "ns" / "user", os.O_RDONLY | os.O_CLOEXEC)
    finally:
        os.close(status_read)
        os.close(ended_to)
        os.waitpid(child, 0)
