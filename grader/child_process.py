"""Runs a program to its end, for a limited time, and ends everything that it has started when the time is over. Use it
for trusted programs. Students' programs run in `grader.sandbox`, nodes of notebooks in `spinbook.kernel.process`.
"""

from __future__ import annotations

import os
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


def _kill_family(pid: int) -> None:
    """Kill a process and its descendants. The parent is killed first, so that it starts no more."""
    try:
        parent = psutil.Process(pid)
        parent.suspend()
        family = [parent, *parent.children(recursive=True)]
    except psutil.NoSuchProcess:
        return
    for member in family:
        try:
            member.kill()
        except psutil.NoSuchProcess:
            continue
