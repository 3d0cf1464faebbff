"""A process that the notebook started: its output, its status, and how to end it."""

from __future__ import annotations

import contextlib
import json
import os
import socket
import subprocess
import sys
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from spinbook.kernel import supervisor

#: The time that a process has to end after Ctrl-C, and then after SIGTERM, before it is killed (s).
STOP_GRACE = (3.0, 2.0)


@dataclass(frozen=True)
class Status:
    """The status of a process. `exit` is None while it runs; negative: ended by that signal (as in subprocess)."""

    exit: int | None
    ended_by: str | None
    lines: int

    @property
    def running(self) -> bool:
        """Whether it still runs."""
        return self.exit is None


class KeptProcess:
    """A child process under a supervisor (see supervisor.py): it never outlives this process, however this process
    ends."""

    def __init__(self, argv: Sequence[str], env: Mapping[str, str], cwd: Path) -> None:
        ours, theirs = socket.socketpair()
        with theirs:
            self._supervisor = subprocess.Popen(
                [sys.executable, "-I", "-S", supervisor.__file__, str(theirs.fileno())],
                pass_fds=[theirs.fileno()],
                stdin=subprocess.DEVNULL,
                start_new_session=True,
            )
        self._control = ours
        self._answers = ours.makefile("rb")
        self._offset, self._begun = 0, b""
        self.status = Status(None, None, 0)
        self._ask({"start": {"argv": list(argv), "env": dict(env), "cwd": os.fspath(cwd)}})

    def _ask(self, request: Mapping[str, Any]) -> None:
        # If the supervisor was killed, the answer that does not come says so.
        with contextlib.suppress(BrokenPipeError):
            self._control.sendall(json.dumps(request).encode() + b"\n")

    def read(self) -> tuple[bytes, int]:
        """Return (output since the last call, number of bytes dropped before it), and update `status`."""
        data, dropped, self._offset = self.read_from(self._offset)
        return data, dropped

    def read_lines(self) -> list[str]:
        """Return the complete lines since the last call, and update `status`."""
        *lines, self._begun = (self._begun + self.read()[0]).split(b"\n")
        return [line.decode(errors="replace") for line in lines]

    def read_all(self) -> tuple[bytes, int]:
        """Return (all output that was kept, number of bytes missing in the middle)."""
        head, _, offset = self.read_from(0)
        tail, dropped, _ = self.read_from(offset)
        return head + tail, dropped

    def read_from(self, offset: int) -> tuple[bytes, int, int]:
        """Return (output from this offset on, number of bytes dropped before it, the next offset); update `status`."""
        self._ask({"read": offset})
        line = self._answers.readline()
        if not line:
            # The supervisor was killed, and its process with it.
            self.status = Status(-9, "SIGKILL", self.status.lines)
            return b"", 0, offset
        answer = json.loads(line)
        data = self._answers.read(answer["length"])
        self.status = Status(answer["exit"], answer["ended_by"], answer["lines"])
        return data, answer["dropped"], answer["offset"] + len(data)

    def descendants(self) -> list[int]:
        """Return the ids of the process and of all that it has started, as far as they are still running."""
        return supervisor.descendants(self._supervisor.pid)

    def stop(self, grace: tuple[float, float] = STOP_GRACE) -> None:
        """Begin to end it: SIGINT, then SIGTERM, then SIGKILL, `grace` seconds apart. Return without waiting."""
        self._ask({"stop": list(grace)})

    def wait(self, timeout_s: float) -> Status:
        """Wait until it has ended, or for `timeout_s`; its output stays to be read."""
        deadline = time.monotonic() + timeout_s
        while True:
            self.read_from(1 << 62)
            if not self.status.running or time.monotonic() >= deadline:
                return self.status
            time.sleep(0.01)

    def close(self) -> None:
        """Release it, and end whatever of it is still running."""
        self._answers.close()
        self._control.close()
        self._supervisor.wait()
