"""Finds out which levels of isolation work on this machine, and chooses one.

A trial takes as long as four scenarios, so the levels that worked are remembered until something changes that they
depend on. This makes no start less safe: each start makes a new sandbox, and if that fails, nothing runs. Levels that
did not work are tried again each time.
"""

from __future__ import annotations

import contextlib
import errno
import hashlib
import os
import resource
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from functools import cache
from pathlib import Path

from grader.sandbox import filesystem, landlock
from grader.sandbox.environment import RUNTIME_VARIABLES, for_trusted
from grader.sandbox.program import IN_DOCKER, OPEN_FILES, Isolation, Limits, SandboxUnavailable
from groundwork.clean_environment import module_command
from groundwork.files import cached, keep

#: A trial takes a second of CPU. If a busy machine ended it, a weaker level would be chosen (s).
_TRIAL_S = 240.0

#: The files that determine whether a process may make namespaces, and which process this is: proc(5),
#: user_namespaces(7). The first one changes at each boot.
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


def available() -> dict[Isolation, str | None]:
    """Return None for each level that works here, otherwise the reason. This starts a program at each level."""
    return {level: _tried(level) for level in Isolation}


def choose(requested: Isolation | None = None) -> Isolation:
    """Return the level to use: `requested`, or the strongest that works here. It is NONE only if that is `requested`.

    Raises `SandboxUnavailable` if `requested`, or without it every level, does not work here, or what all need is
    missing.
    """
    _refuse_what_no_level_works_with()
    if requested is not Isolation.NONE:
        refuse_what_students_can_not_read()
    if requested is not None:
        reason = _reason_against(requested)
        if reason is not None:
            raise SandboxUnavailable(f"The sandbox '{requested}' does not work on this machine: {reason}.")
        return requested
    reasons = []
    for level in (Isolation.BUBBLEWRAP, Isolation.NAMESPACES, Isolation.LANDLOCK):
        reason = _reason_against(level)
        if reason is None:
            return level
        reasons.append(f"\n  {level}: {reason}")
    raise SandboxUnavailable(
        "No sandbox works on this machine, so students' code will not be run." + "".join(reasons) + "\n"
        f"Allow user namespaces (in a container: {IN_DOCKER} ...), or use a kernel with Landlock (5.13 or newer). "
        "If you trust the code, --isolation none runs it without a sandbox."
    )


def _refuse_what_no_level_works_with() -> None:
    if not Path("/proc/self/statm").exists():
        raise SandboxUnavailable(
            "/proc is not there, from which the grader reads what a program uses. Mount it: proc(5)."
        )
    for which, does, needed, letter in _NEEDED_LIMITS:
        hard = resource.getrlimit(which)[1]
        if 0 <= hard < needed:
            raise SandboxUnavailable(
                f"A program here may {does.format(hard)}, and a student's needs {needed}. Raise the limit: "
                f"`ulimit -H{letter}` shows it, /etc/security/limits.conf or the container's --ulimit sets it."
            )
    if not Path(os.devnull).is_char_device():
        raise SandboxUnavailable(
            "/dev/null is a file here. Make it again: rm -f /dev/null; mknod -m 666 /dev/null c 1 3"
        )
    _refuse_full_shared_memory()


#: What the hard limits of a session must allow: the limit, what it reads like, how much, and its letter for `ulimit`.
_NEEDED_LIMITS = (
    (resource.RLIMIT_NOFILE, "open {} files at once", OPEN_FILES, "n"),
    (resource.RLIMIT_AS, "use {} bytes of addresses", 512 * 2**20, "v"),
    (resource.RLIMIT_CPU, "compute for {} s", int(Limits().cpu_s) + 2, "t"),
)


def _refuse_full_shared_memory() -> None:
    """Refuse a full /dev/shm: rclpy's LTTng maps a page of it, and the kernel ends a process that it can't give one."""
    try:
        with tempfile.TemporaryFile(dir="/dev/shm") as file:
            os.posix_fallocate(file.fileno(), 0, 4 * resource.getpagesize())
    except OSError as error:  # without it, or where it can't be written, rclpy does without
        if error.errno == errno.ENOSPC:
            raise SandboxUnavailable(
                "/dev/shm is full, so every program that imports rclpy is killed. Remove what nodes have left there, "
                "/dev/shm/fastrtps_*, or make it larger; in Docker: --shm-size 256m"
            ) from None


def refuse_what_students_can_not_read() -> None:
    """Refuse modules that only root can read: a student who imports one would be told that there is none."""
    closed = filesystem.closed_to_others() if os.geteuid() == 0 else []
    if closed:
        places = [path for path in closed if not any(other in path.parents for other in closed)]
        raise SandboxUnavailable(
            "Root starts students' programs as another user, who can't read what is installed here. Let others read "
            f"it: chmod -R a+rX {' '.join(map(str, places))}"
        )


def _reason_against(level: Isolation) -> str | None:
    """Return None if the level works, or has worked under the same circumstances; otherwise the reason."""
    if level is Isolation.LANDLOCK:
        try:  # a trial does not have this course's interfaces
            landlock.student_user()
        except OSError as error:
            return f"the sandbox could not be made: {error}"
    if has_worked(level):
        return None
    reason = _tried(level)
    if reason is None:
        keep(_file(level), "")
    return reason


@cache
def _tried(level: Isolation) -> str | None:
    if not sys.platform.startswith("linux"):
        return None if level is Isolation.NONE else "it needs Linux"
    try:
        trial = subprocess.run(
            module_command("grader.sandbox.trial", level.value),
            env=for_trusted(RUNTIME_VARIABLES),
            capture_output=True,
            text=True,
            timeout=_TRIAL_S,
            check=False,
        )
    except (OSError, subprocess.TimeoutExpired) as fault:
        return f"trying it failed: {fault}"
    if trial.returncode == 0:
        return None
    lines = (trial.stdout.strip() or trial.stderr.strip()).splitlines()
    return lines[-1] if lines else f"trying it ended with {trial.returncode}"


def has_worked(level: Isolation) -> bool:
    """Return whether a trial of this level has worked under the same circumstances."""
    try:
        return _file(level).stat().st_uid == os.geteuid()
    except OSError:  # not tried yet, or another user's folder
        return False


def forget() -> None:
    """Try every level again next time, because a level that had worked has failed."""
    shutil.rmtree(cached("sandbox"), ignore_errors=True)


def _file(level: Isolation) -> Path:
    text = "\n".join((level.value, *_circumstances()))
    return cached("sandbox") / f"{level.value}-{hashlib.sha256(text.encode()).hexdigest()[:32]}"


def _circumstances() -> Iterator[str]:
    yield from map(_text, _FILES)
    yield from (line for line in _text("/proc/self/status").splitlines() if line.partition(":")[0] in _STATUS)
    for name in _NAMESPACES:
        with contextlib.suppress(OSError):
            yield os.readlink(f"/proc/self/ns/{name}")  # noqa: PTH115 - no path
    limits = (getattr(resource, name) for name in sorted(vars(resource)) if name.startswith("RLIMIT_"))
    yield repr([resource.getrlimit(which) for which in dict.fromkeys(limits)])
    yield repr((sys.executable, sys.version, os.uname(), os.geteuid(), sorted(os.getgroups())))
    for name, value in sorted(for_trusted(RUNTIME_VARIABLES).items()):
        yield f"{name}={sorted(value.split(os.pathsep))}"  # ROS wheels add entries in any order
    bubblewrap = shutil.which("bwrap")
    programs = [Path(sys.executable).resolve(), *([Path(bubblewrap)] if bubblewrap else [])]
    for file in (*sorted(Path(__file__).parent.glob("*.py")), *programs):
        status = file.stat()
        yield f"{file} {status.st_mtime_ns} {status.st_size} {status.st_mode} {status.st_uid}"


def _text(file: str) -> str:
    try:
        return Path(file).read_text(errors="replace")
    except OSError:
        return ""
