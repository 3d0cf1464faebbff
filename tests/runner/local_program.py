"""A program that runs over the grader's own middleware without a sandbox, for tests of what is above it."""

from __future__ import annotations

import contextlib
import os
import signal
import subprocess
import sys
import tempfile
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from types import SimpleNamespace

import psutil

ARGUMENTS = ("--ros-args", "-p", "use_sim_time:=true")


@dataclass(frozen=True)
class Exit:
    """See `grader.runner.student.Exit`."""

    code: int | None
    signal: int | None
    limit: str | None = None


class LocalProgram:
    """See `grader.runner.student.Student`."""

    def __init__(self, file: Path, environment: Mapping[str, str]) -> None:
        self._output = tempfile.TemporaryFile()  # noqa: SIM115 - closed with this object
        self._process = subprocess.Popen(
            [sys.executable, str(file), *ARGUMENTS],
            env={**os.environ, **environment},
            stdout=self._output,
            stderr=subprocess.STDOUT,
            stdin=subprocess.DEVNULL,
            start_new_session=True,
        )
        self.pid = self._process.pid

    def pids(self) -> tuple[int, ...]:
        return (self.pid,)

    def output(self) -> SimpleNamespace:
        size = self._output.seek(0, os.SEEK_END)
        return SimpleNamespace(text=os.pread(self._output.fileno(), size, 0).decode(errors="replace"), dropped=0)

    def poll(self) -> Exit | None:
        code = self._process.poll()
        if code is None:
            return None
        return Exit(code, None) if code >= 0 else Exit(None, -code)

    def wait(self, timeout_s: float) -> Exit | None:
        with contextlib.suppress(subprocess.TimeoutExpired):
            self._process.wait(timeout_s)
        return self.poll()

    def interrupt(self) -> None:
        self._process.send_signal(signal.SIGINT)

    def cpu_seconds(self) -> float:
        with contextlib.suppress(psutil.Error):
            times = psutil.Process(self.pid).cpu_times()
            return float(times.user + times.system + times.children_user + times.children_system)
        return 0.0

    def at_limit(self) -> bool:
        return False

    def kill(self) -> Exit:
        with contextlib.suppress(ProcessLookupError):
            os.killpg(self.pid, signal.SIGKILL)
        self._process.wait()
        return self.poll() or Exit(None, signal.SIGKILL)
