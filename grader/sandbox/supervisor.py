"""The trusted process of each student: makes the sandbox, starts the program, reports its end, kills everything."""

from __future__ import annotations

import contextlib
import json
import os
import select
import signal
from dataclasses import dataclass
from pathlib import Path
from typing import NoReturn

from grader.sandbox import bubblewrap, filesystem, landlock, namespaces, processes, syscalls
from grader.sandbox import program as limits
from grader.sandbox.confine import PassedDescriptors, StartRequest, confine
from grader.sandbox.program import SUBMISSION, Isolation, Paths, ProgramSpec


@dataclass(frozen=True)
class StudentToRun:
    """What a new student process has to run."""

    program: ProgramSpec
    paths: Paths


def supervise(start: StartRequest, passed: PassedDescriptors) -> StudentToRun:
    """Start a student's program and watch it until it is dead. Return only in the student; the supervisor exits.

    `start` is what to start. `passed` has the descriptors that came with it.
    """
    control, reported = passed.control, False
    try:
        signal.signal(signal.SIGCHLD, signal.SIG_DFL)
        syscalls.prctl(syscalls.PR_SET_CHILD_SUBREAPER, 1)  # orphans of the student or bubblewrap are reaped here
        os.chdir("/")
        other_tasks = _other_tasks(start)
        sandbox, paths = _build(start, passed)
        child = _fork_student(start, paths, sandbox, other_tasks, passed)
        if isinstance(child, StudentToRun):
            return child
        os.close(passed.output)
        started = {"event": "started", "pid": child}
        _report(control, started | {"init": sandbox.init, "own_processes": sorted(sandbox.own_processes)})
        reported = True
        _watch(control, child, sandbox)
        _report(control, {"event": "dead"})
    except BaseException as fault:
        if not reported:
            kind = "" if isinstance(fault, OSError) else f"{type(fault).__name__}: "
            _report(control, {"event": "failed", "reason": f"{kind}{fault}"})
    os._exit(0)


def refuse(control: int, reason: str) -> NoReturn:
    """Tell the runner that no program can be started, and exit."""
    _report(control, {"event": "failed", "reason": reason})
    os._exit(0)


def _build(
    start: StartRequest, passed: PassedDescriptors
) -> tuple[namespaces.Namespaces | processes.ProcessTree, Paths]:
    program = start.program
    if start.isolation in (Isolation.BUBBLEWRAP, Isolation.NAMESPACES):
        assert passed.confinement is not None
        if start.isolation is Isolation.BUBBLEWRAP:
            sandbox = bubblewrap.build(start.options, passed.confinement)
        else:
            sandbox = namespaces.build(start.plan, passed.confinement)
        namespaces.write_files(program.files)
        return sandbox, Paths(SUBMISSION, filesystem.HOME, "/tmp")
    paths = processes.make_paths(program.files, _owner(start.isolation))
    return processes.ProcessTree(Path(paths.folder).parent), paths


def _fork_student(
    start: StartRequest,
    paths: Paths,
    sandbox: namespaces.Namespaces | processes.ProcessTree,
    other_tasks: int,
    passed: PassedDescriptors,
) -> int | StudentToRun:
    """Fork the student. Return its pid in the parent and, once it is confined, what to run in the child."""
    fault_at, fault_to = os.pipe()
    child = os.fork()
    if child == 0:
        try:
            if isinstance(sandbox, namespaces.Namespaces):
                sandbox.forget()
            confine(start, paths, other_tasks, passed, keep_open=fault_to)
        except BaseException as fault:
            os.write(fault_to, str(fault).encode() or repr(fault).encode())
            os._exit(1)
        os.close(fault_to)
        return StudentToRun(start.program, paths)
    os.close(fault_to)
    with os.fdopen(fault_at, "rb") as stream:
        fault_text = stream.read()
    if fault_text:
        sandbox.kill()
        os.waitpid(child, 0)
        sandbox.reap()
        raise OSError(fault_text.decode(errors="replace"))
    return child


def _watch(control: int, child: int, sandbox: namespaces.Namespaces | processes.ProcessTree) -> None:
    """Pass on interrupts and report the end of the student's first process, until the command to kill."""
    ended = os.pidfd_open(child)
    poll = select.poll()
    poll.register(control, select.POLLIN)
    poll.register(ended, select.POLLIN)
    alive = True
    while True:
        ready = dict(poll.poll())
        if ended in ready:
            poll.unregister(ended)
            alive = False
            _report_end(control, child, sandbox.init)
        if control in ready:
            command = _receive(control)
            if command == b"interrupt":
                if alive:
                    os.kill(child, signal.SIGINT)
                _report(control, {"event": "interrupted"})
                continue
            sandbox.kill()
            if alive:
                _report_end(control, child, sandbox.init)
            sandbox.reap()
            return


def _report_end(control: int, child: int, init: int) -> None:
    _, status, usage = os.wait4(child, 0)
    # The monitor counts what `init` has reaped: without namespaces that is this process, and so also the child.
    cpu_s = 0.0 if init == os.getpid() else usage.ru_utime + usage.ru_stime
    _report(control, {"event": "exited", "status": status, "cpu_s": cpu_s})


def _receive(control: int) -> bytes:
    try:
        return os.read(control, 64)
    except OSError:
        return b""


def _report(control: int, message: dict[str, object]) -> None:
    with contextlib.suppress(OSError):  # the runner is gone: noticed at the next read
        os.write(control, json.dumps(message).encode())


def _other_tasks(start: StartRequest) -> int:
    """Return how many processes of the same user RLIMIT_NPROC will count besides the student's."""
    apart = start.isolation in (Isolation.BUBBLEWRAP, Isolation.NAMESPACES)
    if apart and (os.geteuid() == 0 or limits.counts_for_each_user_namespace()):
        return 4  # this process and those that hold the namespace open
    # Other processes of the user come and go. The runner counts the student's own; this is the limit behind that.
    user = landlock.student_user() if start.isolation is Isolation.LANDLOCK else os.getuid()
    return limits.tasks_of_user(user) + 3 * start.limits.processes


def _owner(isolation: Isolation) -> int | None:
    """Return the user that owns the folders of a program without namespaces."""
    return landlock.student_user() if isolation is Isolation.LANDLOCK else None
