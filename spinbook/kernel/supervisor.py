"""Supervises one process: starts it, reads its output, signals it, and ends everything that it started."""

from __future__ import annotations

import contextlib
import ctypes
import json
import os
import selectors
import signal
import socket
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

#: How many of the first and of the last bytes of a process's output are kept.
KEPT_AT_EACH_END = 2_000_000
_PR_SET_PDEATHSIG = 1
_PR_SET_CHILD_SUBREAPER = 36
#: The time that a process has to end after SIGINT and after SIGTERM (s) when the kernel is gone.
_ORPHAN_GRACE = (1.0, 0.5)


def _prctl(option: int, value: int) -> None:
    ctypes.CDLL(None, use_errno=True).prctl(option, value, 0, 0, 0)


def die_with_parent() -> None:
    """Let this process be killed when the one that started it ends."""
    _prctl(_PR_SET_PDEATHSIG, signal.SIGKILL)


class ProcessOutput:
    """The output of a process: its first and last bytes, and how many were dropped between them."""

    def __init__(self) -> None:
        self._head = bytearray()
        self._tail = bytearray()
        self.total = 0
        self.lines = 0

    def add(self, data: bytes) -> None:
        """Add output."""
        self.total += len(data)
        self.lines += data.count(b"\n")
        room = max(0, KEPT_AT_EACH_END - len(self._head))
        self._head += data[:room]
        self._tail += data[room:]
        if len(self._tail) > 2 * KEPT_AT_EACH_END:
            del self._tail[:-KEPT_AT_EACH_END]

    def since(self, offset: int) -> tuple[int, int, bytes]:
        """Return (offset, dropped, bytes): what is kept from `offset` on, and how many bytes before it are lost."""
        if offset < len(self._head):
            return offset, 0, bytes(self._head[offset:])
        start = self.total - len(self._tail)
        first = max(offset, start)
        return first, first - offset, bytes(self._tail[first - start :])


def _processes() -> Iterator[tuple[int, bytes, int]]:
    """Yield the id, the state and the parent's id of each process of this machine; see proc_pid_stat(5)."""
    for entry in Path("/proc").iterdir():
        if entry.name.isdigit():
            with contextlib.suppress(OSError, ValueError, IndexError):
                state, parent = (entry / "stat").read_bytes().rpartition(b")")[2].split()[:2]
                yield int(entry.name), state, int(parent)


def descendants(root: int) -> list[int]:
    """Return the process ids of all that `root` started and that still run, zombies left out."""
    children: dict[int, list[int]] = {}
    for pid, state, parent in _processes():
        if state != b"Z":
            children.setdefault(parent, []).append(pid)
    pids, todo = [], [root]
    while todo:
        new = children.get(todo.pop(), [])
        pids += new
        todo += new
    return pids


class Supervisor:
    """Supervises one process. `run` returns when the process and the kernel have both ended."""

    def __init__(self, control: socket.socket) -> None:
        self._control = control
        self._selector = selectors.DefaultSelector()
        self._selector.register(control, selectors.EVENT_READ)
        self._requests = bytearray()
        self._printed = ProcessOutput()
        self._process: subprocess.Popen[bytes] | None = None
        self._exit: int | None = None
        self._ended_by: str | None = None
        self._stopping: list[tuple[float, signal.Signals]] = []
        self._orphaned = False

    def run(self) -> None:
        """Serve requests until both the process and the kernel have ended."""
        _prctl(_PR_SET_CHILD_SUBREAPER, 1)
        signal.signal(signal.SIGINT, signal.SIG_IGN)
        signal.signal(signal.SIGTERM, lambda *_: self._orphan())
        while not (self._orphaned and (self._process is None or self._exit is not None)):
            for key, _ in self._selector.select(timeout=0.05):
                if key.fileobj is self._control:
                    self._serve()
                else:
                    self._drain()
            self._look_after()
        self._kill_all()

    def _serve(self) -> None:
        try:
            data = self._control.recv(1 << 20)
        except OSError:
            data = b""
        if not data:
            self._selector.unregister(self._control)
            self._orphan()
            return
        self._requests += data
        while b"\n" in self._requests:
            line, _, rest = bytes(self._requests).partition(b"\n")
            self._requests = bytearray(rest)
            self._handle(json.loads(line))

    def _handle(self, request: dict[str, Any]) -> None:
        if "start" in request:
            self._start(**request["start"])
        elif "read" in request:
            self._answer(request["read"])
        elif "stop" in request:
            self._stop(*request["stop"])

    def _start(self, argv: list[str], env: dict[str, str], cwd: str) -> None:
        def prepare() -> None:
            die_with_parent()
            signal.signal(signal.SIGINT, signal.default_int_handler)

        try:
            self._process = subprocess.Popen(
                argv,
                env=env,
                cwd=cwd,
                stdin=subprocess.DEVNULL,
                stdout=subprocess.PIPE,
                stderr=subprocess.STDOUT,
                start_new_session=True,
                preexec_fn=prepare,
            )
        except OSError as error:
            self._printed.add(f"{argv[0]}: {error.strerror}\n".encode())
            self._exit = 127
            return
        assert self._process.stdout is not None
        os.set_blocking(self._process.stdout.fileno(), False)
        self._selector.register(self._process.stdout, selectors.EVENT_READ)

    def _drain(self) -> bool:
        """Read from the pipe. Return whether there may be more."""
        assert self._process is not None
        assert self._process.stdout is not None
        try:
            data = os.read(self._process.stdout.fileno(), 1 << 20)
        except BlockingIOError:
            return False
        if not data:
            with contextlib.suppress(KeyError):
                self._selector.unregister(self._process.stdout)
            return False
        self._printed.add(data)
        return True

    def _look_after(self) -> None:
        if self._process is None or self._exit is not None:
            return
        code = self._process.poll()
        if code is not None:
            # End what it started, too, so that the pipe has an end; then read the last bytes.
            self._kill_all()
            while self._drain():
                pass
            self._exit = code
            return
        while self._stopping and time.monotonic() >= self._stopping[0][0]:
            self._signal(self._stopping.pop(0)[1])

    def _stop(self, after_interrupt: float, after_terminate: float) -> None:
        now = time.monotonic()
        self._stopping = [
            (now + after_interrupt, signal.SIGTERM),
            (now + after_interrupt + after_terminate, signal.SIGKILL),
        ]
        self._signal(signal.SIGINT)

    def _signal(self, number: signal.Signals) -> None:
        if self._process is None or self._process.poll() is not None:
            return
        self._ended_by = number.name
        if number is signal.SIGKILL:
            self._kill_all()
        else:
            # Signal the whole group, as a terminal does.
            with contextlib.suppress(ProcessLookupError, PermissionError):
                os.killpg(self._process.pid, number)

    def _kill_all(self) -> None:
        while left := descendants(os.getpid()):
            for pid in left:
                with contextlib.suppress(ProcessLookupError, PermissionError):
                    os.kill(pid, signal.SIGKILL)
            self._reap_adopted()
            time.sleep(0.002)

    def _reap_adopted(self) -> None:
        """Reap zombies that others left to this process: the first process of a PID namespace can't end before them."""
        own = self._process.pid if self._process else 0
        for pid, state, parent in _processes():
            if state == b"Z" and parent == os.getpid() and pid != own:
                with contextlib.suppress(ChildProcessError):
                    os.waitpid(pid, os.WNOHANG)

    def _orphan(self) -> None:
        if not self._orphaned:
            self._orphaned = True
            self._stop(*_ORPHAN_GRACE)

    def _answer(self, offset: int) -> None:
        first, dropped, data = self._printed.since(offset)
        head = {
            "offset": first,
            "length": len(data),
            "dropped": dropped,
            "lines": self._printed.lines,
            "exit": self._exit,
            "ended_by": self._ended_by,
        }
        with contextlib.suppress(OSError):
            self._control.sendall(json.dumps(head).encode() + b"\n" + data)


if __name__ == "__main__":
    Supervisor(socket.socket(fileno=int(sys.argv[1]))).run()
