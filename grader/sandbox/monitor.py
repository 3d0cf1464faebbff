"""Watches a running student's program: reads its output, counts what it uses, and kills it at its limits."""

from __future__ import annotations

import contextlib
import json
import os
import select
import signal
import socket
import threading
import time

from grader.sandbox import processes
from grader.sandbox.program import Limits
from groundwork.process_exit import ProcessExit

HEAD_BYTES = 64 * 1024
TAIL_BYTES = 64 * 1024


class OutputBuffer:
    """Collects pieces of output, and keeps all, or the first and the last 64 KiB."""

    def __init__(self) -> None:
        self._head = bytearray()
        self._tail = bytearray()
        self.total = 0
        """The number of all bytes that arrived."""

    def add(self, piece: bytes) -> None:
        """Append a piece."""
        self.total += len(piece)
        room = HEAD_BYTES - len(self._head)
        self._head += piece[:room]
        self._tail += piece[room:]
        del self._tail[:-TAIL_BYTES]

    def text(self) -> str:
        """Return what has been kept so far, with a line that says how much is missing, if anything is."""
        dropped = self.total - len(self._head) - len(self._tail)
        if not dropped:
            return (self._head + self._tail).decode(errors="replace")
        gap = f"\n[... {dropped} bytes of output are not shown ...]\n"
        return self._head.decode(errors="replace") + gap + self._tail.decode(errors="replace")


_TICK_S = 0.05
_PIECE = 1 << 18


# The last line that Python prints if the kernel refused more. A program that only pretends gets no points.
_LAST_WORDS = {
    "MemoryError": "memory",
    "std::bad_alloc": "memory",
    "Cannot allocate memory": "memory",
    "BlockingIOError: [Errno 11] Resource temporarily unavailable": "processes",
    "can't start new thread": "processes",
    "File too large": "file-size",
    "No space left on device": "file-size",
}


class Monitor:
    """A thread in the runner that watches one student's program."""

    def __init__(
        self, control: socket.socket, output: int, limits: Limits, pid: int, init: int, own_processes: frozenset[int]
    ) -> None:
        """Begin to watch.

        Args:
            control: the socket to the supervisor, which this reads from now on.
            output: the read end of the pipe that the program prints to.
            limits: what kills the program.
            pid: the program's first process.
            init: the process that adopts its orphans.
            own_processes: children of `init` that are not the program's.
        """
        self.interrupted = threading.Event()
        """Set when the first process has been sent SIGINT, or all are dead."""
        self.ended = threading.Event()
        """Set when the first process has ended."""
        self.dead = threading.Event()
        """Set when all processes are dead."""
        self.exit: ProcessExit | None = None
        self.others: frozenset[int] = frozenset()
        """The other processes, as last seen."""
        self._control, self._pipe, self._limits = control, output, limits
        self.pid, self._init, self._own_processes = pid, init, own_processes
        self._buffer = OutputBuffer()
        self._lock = threading.Lock()
        self._limit: str | None = None
        self._reaped_cpu_s = 0.0
        self._since_s = time.monotonic()
        self._thread = threading.Thread(target=self._watch, name="monitor", daemon=True)
        self._thread.start()

    def output(self) -> str:
        """Return what has been printed so far on standard output and error, also what nobody has read yet."""
        self._drain_what_is_there()
        with self._lock:
            return self._buffer.text()

    def members(self) -> set[int]:
        """Return the program's processes."""
        if self.dead.is_set():
            return set()
        everything = processes.descendants(self._init) | processes.descendants(self.pid)
        return (everything | ({self.pid} if self.exit is None else set())) - self._own_processes

    def cpu_seconds(self) -> float:
        """Return the CPU seconds of all processes, including those that have ended."""
        alive = (self.pid, *self.others) if self.exit is None else self.others
        orphans = processes.reaped_cpu_seconds(self._init) if self._init != self.pid else 0.0
        return self._reaped_cpu_s + orphans + sum(processes.usage(pid).cpu_s for pid in alive)

    def at_limit(self) -> bool:
        """Return whether the program is being killed, or has been, for a limit. This measures it now."""
        self._look()
        return self._limit is not None

    def join(self) -> None:
        """Wait for the end of the watch."""
        self._thread.join()

    def _watch(self) -> None:
        poll = select.poll()
        poll.register(self._control, select.POLLIN)
        poll.register(self._pipe, select.POLLIN)
        next_look_s = 0.0
        while not self.dead.is_set():
            ready = dict(poll.poll(_TICK_S * 1000))
            if self._pipe in ready and self._drain() == b"":
                poll.unregister(self._pipe)
            if self._control.fileno() in ready:
                self._receive()
            if time.monotonic() >= next_look_s:
                self._look()
                next_look_s = time.monotonic() + _TICK_S
        self._drain_what_is_there()
        with self._lock:
            os.close(self._pipe)
            self._pipe = -1
        self._control.close()

    def _drain(self) -> bytes | None:
        """Read a piece of the output, and return it: empty at its end, None if there is none yet."""
        with self._lock:
            if self._pipe < 0 or not select.select([self._pipe], [], [], 0)[0]:
                return None
            piece = os.read(self._pipe, _PIECE)
            self._buffer.add(piece)
        if self._buffer.total > self._limits.output_bytes:
            self._kill("output")
        return piece

    def _drain_what_is_there(self) -> None:
        """Read only what is in the pipe now: a process may still be writing."""
        for _ in range(8):
            if not self._drain():
                return

    def _receive(self) -> None:
        with contextlib.suppress(OSError):
            message = self._control.recv(4096)
            if message:
                report = json.loads(message)
                if report["event"] == "exited":
                    self._reaped_cpu_s = report["cpu_s"]
                    self._end(report["status"])
                elif report["event"] == "interrupted":
                    self.interrupted.set()
                elif report["event"] == "dead":
                    self._finish()
                return
        # The supervisor is gone. With namespaces the kernel has killed everything; without, we kill what we last saw.
        for pid in (self.pid, *self.others):
            with contextlib.suppress(OSError):
                os.kill(pid, signal.SIGKILL)
        self._finish()

    def _end(self, status: int) -> None:
        self._drain_what_is_there()
        if os.WIFSIGNALED(status):
            code, number = None, os.WTERMSIG(status)
        else:
            code, number = os.WEXITSTATUS(status), None
        self.exit = ProcessExit(code, number, self._limit or self._limit_of(code, number))
        self.ended.set()

    def _finish(self) -> None:
        if self.exit is None:
            self._end(signal.SIGKILL)
        self.interrupted.set()
        self.dead.set()

    def _limit_of(self, code: int | None, number: int | None) -> str | None:
        """Return the limit that the kernel itself has enforced, by the signal or by the program's last line."""
        if number == signal.SIGXCPU:
            return "cpu"
        if number == signal.SIGXFSZ:
            return "file-size"
        if code != 0:
            lines = self.output()[-2000:].strip().splitlines()
            for words, limit in _LAST_WORDS.items():
                if lines and words in lines[-1]:
                    return limit
        return None

    def _look(self) -> None:
        """Measure what the program uses, and kill it if it exceeds a limit."""
        members = self.members()
        self.others = frozenset(members - {self.pid})
        used = [processes.usage(pid) for pid in members]
        if time.monotonic() - self._since_s > self._limits.wall_s:
            self._kill("wall")
        elif sum(use.threads for use in used) >= self._limits.processes:
            self._kill("processes")
        elif sum(use.resident_bytes for use in used) > self._limits.memory_bytes and self._memory_is_too_much(members):
            self._kill("memory")
        elif self.cpu_seconds() > self._limits.cpu_s:
            self._kill("cpu")

    def _memory_is_too_much(self, members: set[int]) -> bool:
        """Count again, with shared memory counted once. Slow, so call it only if the first count is too high."""
        exact = [processes.proportional_bytes(pid) for pid in members]
        return sum(exact) > self._limits.memory_bytes or not any(exact)

    def _kill(self, limit: str) -> None:
        if self._limit is None and self.exit is None:
            self._limit = limit
        with contextlib.suppress(OSError):
            self._control.send(b"kill")
