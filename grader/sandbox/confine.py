"""The last steps of a student's process before it runs the student's code: it gives up everything it does not need."""

from __future__ import annotations

import os
import signal
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from grader.sandbox import filesystem, landlock, seccomp, syscalls
from grader.sandbox.filesystem import USER_ID
from grader.sandbox.program import HUB, Isolation, Limits, Paths, ProgramSpec, apply_limits

_DESCRIPTORS = 1024


@dataclass(frozen=True)
class StartRequest:
    """A runner's request to start a program.

    Attributes:
        program: what to run.
        isolation: how far to confine it.
        limits: the resources it may use.
        core: the CPU to stay on; None for any.
        plan: the steps that build its root, for the level `namespaces`.
        options: the same for bubblewrap, ready for it.
    """

    program: ProgramSpec
    isolation: Isolation
    limits: Limits
    core: int | None
    plan: tuple[filesystem.Mount, ...] = ()
    options: bytes = b""


@dataclass(frozen=True)
class PassedDescriptors:
    """What comes with a request.

    Attributes:
        control: the socket to the runner.
        output: where the student's standard output and error go.
        hub: the socket through which the program's processes connect to the hub; None if there is no hub.
        confinement: the user namespace that the runner made, or its Landlock rules; None at the level without either.
    """

    control: int
    output: int
    hub: int | None = None
    confinement: int | None = None

    @classmethod
    def of(cls, start: StartRequest, passed: Sequence[int]) -> PassedDescriptors:
        """Return the descriptors that came with `start`, in the order in which `ForkServer.start` passes them."""
        control, output, *others = passed
        hub = others.pop(0) if start.program.hub is not None else None
        return cls(control, output, hub, others[0] if others else None)


def confine(
    start: StartRequest, paths: Paths, other_processes: int, passed: PassedDescriptors, *, keep_open: int
) -> None:
    """Confine the calling process for good.

    Args:
        start: the program, how far to confine it, and the resources it may use.
        paths: its folders.
        other_processes: see `limits.apply`.
        passed: its output becomes the process's own, its hub gets the number that programs expect.
        keep_open: a descriptor that the caller still needs; every other one is closed.

    Raises OSError if the kernel refuses one of the steps; none of the student's code may run then.
    """
    os.setsid()
    _take_descriptors(passed, keep_open)
    _reset_signals()
    apply_limits(start.limits, other_processes=other_processes)
    if start.core is not None:
        os.sched_setaffinity(0, {start.core})
    os.chdir(paths.home)
    isolation = start.isolation
    if isolation is Isolation.NONE:
        return
    filters = seccomp.program(no_signals=_signals_leave(isolation)) if seccomp.supported() else None
    user = USER_ID if isolation is not Isolation.LANDLOCK else Path(paths.home).stat().st_uid
    syscalls.drop_bounding_capabilities()
    if os.geteuid() != user:
        os.setresgid(user, user, user)
        os.setresuid(user, user, user)
    syscalls.drop_capabilities()
    syscalls.prctl(syscalls.PR_SET_NO_NEW_PRIVS, 1)
    syscalls.prctl(syscalls.PR_SET_DUMPABLE, 1)  # the change of user clears it, and /proc/self would be unreadable
    if isolation is Isolation.LANDLOCK:
        assert passed.confinement is not None
        landlock.restrict(passed.confinement, paths)
    if filters is not None:
        seccomp.install(filters)


def _take_descriptors(passed: PassedDescriptors, keep_open: int) -> None:
    nothing = os.open("/dev/null", os.O_RDONLY)
    os.dup2(nothing, 0)
    os.dup2(passed.output, 1)
    os.dup2(passed.output, 2)
    kept = {keep_open, *([] if passed.confinement is None else [passed.confinement])}
    if passed.hub is not None:
        os.dup2(passed.hub, HUB)  # also for the programs that it starts
        kept.add(HUB)
    first = 3
    for number in (*sorted(kept), _DESCRIPTORS):
        os.closerange(first, number)
        first = number + 1


def _reset_signals() -> None:
    """Reset the signals to those of a Python that was just started from a shell."""
    for number in (signal.SIGTERM, signal.SIGHUP, signal.SIGCHLD, signal.SIGQUIT):
        signal.signal(number, signal.SIG_DFL)
    signal.signal(signal.SIGINT, signal.default_int_handler)
    signal.pthread_sigmask(signal.SIG_SETMASK, set())


def _signals_leave(isolation: Isolation) -> bool:
    return isolation is Isolation.LANDLOCK and not landlock.keeps_signals_inside()
