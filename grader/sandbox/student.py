"""A student's running program, as the runner sees it."""

from __future__ import annotations

import contextlib
import json
import os
import signal
import socket
from types import TracebackType

from grader.sandbox.monitor import Exit, Monitor, Output
from grader.sandbox.program import Limits, SandboxError

_START_S = 30.0
_DEATH_S = 30.0


class Student:
    """A student's program in its sandbox. Leaving the `with` block kills all of it."""

    def __init__(self, control: socket.socket, output: int, limits: Limits) -> None:
        """Wait until the supervisor at the other end of the socket has started the program.

        Args:
            control: the socket to the supervisor.
            output: the read end of the pipe that the program prints to.
            limits: what it may use.

        Raises:
            SandboxError: if it could not be started.
        """
        self._control = control
        control.settimeout(_START_S)
        try:
            answer = json.loads(control.recv(65536) or b"{}")
        except TimeoutError as fault:
            answer = {"reason": f"no answer within {_START_S:g} s: {fault}"}
        if answer.get("event") != "started":
            control.close()
            os.close(output)
            raise SandboxError(f"the sandbox could not be made: {answer.get('reason', 'the supervisor died')}")
        control.settimeout(None)
        self.pid: int = answer["pid"]
        """The id of the node's process, as seen from outside the sandbox."""
        self.folder: str = answer["folder"]
        """Where the submission's files are, as the program sees them."""
        self._monitor = Monitor(control, output, limits, self.pid, answer["init"], frozenset(answer["holders"]))

    @property
    def exit(self) -> Exit | None:
        """How the node's process ended; None while it runs."""
        return self._monitor.exit

    def poll(self) -> Exit | None:
        """Return the same as `exit`."""
        return self._monitor.exit

    def wait(self, timeout_s: float) -> Exit | None:
        """Wait for the end of the node's process, at most so many seconds; return None if it still runs."""
        self._monitor.ended.wait(timeout_s)
        return self._monitor.exit

    def output(self) -> Output:
        """Return what it has printed so far."""
        return self._monitor.output()

    def interrupt(self) -> None:
        """Send SIGINT to the node's process, as Ctrl-C would; do nothing if it has ended."""
        with contextlib.suppress(OSError):
            self._control.send(b"interrupt")

    def cpu_seconds(self) -> float:
        """Return how much CPU time all its processes have used, including those that have ended (s)."""
        return self._monitor.cpu_seconds()

    def pids(self) -> tuple[int, ...]:
        """Return its processes' ids, as seen from outside the sandbox: the first, and others found within 50 ms."""
        return (self.pid, *self._monitor.others)

    def at_limit(self) -> bool:
        """Return whether it is being ended for a limit; looks at once, as the monitor may be late."""
        return self._monitor.at_limit()

    def processes(self) -> int:
        """Return how many processes it has now."""
        return len(self._monitor.members())

    def kill(self) -> Exit:
        """Kill every process of it, daemons too, and return when all are dead. A second call returns the same.

        Raises:
            SandboxError: if one of its processes does not die.
        """
        with contextlib.suppress(OSError):
            self._control.send(b"kill")
        if not self._monitor.dead.wait(_DEATH_S):
            raise SandboxError(f"the student's process {self.pid} did not die within {_DEATH_S:g} s of being killed")
        self._monitor.join()
        return self._monitor.exit or Exit(None, int(signal.SIGKILL), None)

    def __enter__(self) -> Student:
        """Return itself: it runs already."""
        return self

    def __exit__(
        self, kind: type[BaseException] | None, fault: BaseException | None, trace: TracebackType | None
    ) -> None:
        """Kill everything."""
        self.kill()
