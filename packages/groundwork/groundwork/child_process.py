"""Runs a program to its end, for a limited time, and ends everything that it has started when the time is over. Use it
for trusted programs: students' programs and nodes of notebooks have other ways to run.
"""

from __future__ import annotations

import contextlib
import os
import select
import signal
import subprocess
from collections.abc import Mapping, Sequence
from pathlib import Path

import psutil


def run_program(
    argv: Sequence[str], seconds: float, *, cwd: Path | None = None, env: Mapping[str, str] | None = None
) -> subprocess.CompletedProcess[str]:
    """Run `argv` without input for at most `seconds`, and return its exit code and what it printed.

    Raises subprocess.TimeoutExpired when it takes longer; the program and all its descendants are then killed. Raises
    OSError when it can't be started.
    """
    process = subprocess.Popen(
        argv,
        cwd=cwd,
        env=env,
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        errors="replace",
        # Ctrl-C in the terminal is ours: whoever runs a program decides how it ends.
        start_new_session=True,
    )
    try:
        out, err = process.communicate(timeout=seconds)
    except BaseException:
        _kill_family(process.pid)
        process.communicate()
        raise
    return subprocess.CompletedProcess([os.fspath(word) for word in argv], process.returncode, out, err)


#: A killed process ends as soon as the kernel lets it; one that waits for a disk that is gone may never do so (s).
_DEATH_S = 10.0


def _kill_family(pid: int) -> None:
    """Kill a process and its descendants, and wait until they are dead.

    The parent is killed first, so that it starts no more.
    """
    try:
        parent = psutil.Process(pid)
        parent.suspend()
        family = [parent, *parent.children(recursive=True)]
    except psutil.NoSuchProcess:
        return
    for death in [_kill(member.pid) for member in family]:
        if death is not None:
            _wait(death)


def _kill(pid: int) -> int | None:
    """Kill a process. Return a descriptor that is readable once it is dead (pidfd_open(2)); None if it is gone."""
    try:
        death = os.pidfd_open(pid)
    except ProcessLookupError:
        return None
    with contextlib.suppress(ProcessLookupError):
        signal.pidfd_send_signal(death, signal.SIGKILL)
    return death


def _wait(death: int) -> None:
    poll = select.poll()
    poll.register(death, select.POLLIN)
    poll.poll(_DEATH_S * 1000)
    os.close(death)
