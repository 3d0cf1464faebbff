"""The client of the fork server, which starts a student's program in 25 ms; a new Python takes 150 ms."""

from __future__ import annotations

import contextlib
import json
import os
import pickle
import signal
import socket
from collections.abc import Sequence
from dataclasses import replace

from grader.sandbox import bubblewrap, filesystem, landlock, namespaces
from grader.sandbox.confine import StartRequest
from grader.sandbox.isolation import forget
from grader.sandbox.monitor import Monitor
from grader.sandbox.program import START_REQUEST, Isolation, Limits, ProgramSpec, SandboxError
from grader.sandbox.zygote_start import PRELOAD, start_zygote
from groundwork.process_exit import ProcessExit

_START_S = 30.0
_DEATH_S = 30.0


class SandboxedProgram(Monitor, contextlib.AbstractContextManager["SandboxedProgram"]):
    """A student's program in its sandbox, which is watched. Leaving the `with` block kills all of it."""

    def __init__(self, control: socket.socket, output: int, limits: Limits) -> None:
        """Wait until the supervisor at the other end of the socket has started the program.

        `control` is the socket to the supervisor. `output` is the read end of the pipe that the program prints to.
        `limits` is what it may use. Raises `SandboxError` if it could not be started.
        """
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
        super().__init__(control, output, limits, answer["pid"], answer["init"], frozenset(answer["own_processes"]))

    def poll(self) -> ProcessExit | None:
        """Return how the node's process ended; None while it runs."""
        return self.exit

    def wait(self, timeout_s: float) -> ProcessExit | None:
        """Wait for the end of the node's process, at most this many seconds; return None if it still runs."""
        self.ended.wait(timeout_s)
        return self.exit

    def interrupt(self) -> None:
        """Send SIGINT to the node's process, as Ctrl-C would, and return when it is sent; do nothing if it has ended.

        Raises `SandboxError` if the supervisor does not answer.
        """
        with contextlib.suppress(OSError):
            self._control.send(b"interrupt")
        if not self.interrupted.wait(_DEATH_S):
            raise SandboxError(f"the student's process {self.pid} was not interrupted within {_DEATH_S:g} s")

    def pids(self) -> tuple[int, ...]:
        """Return its processes' ids, as seen from outside the sandbox: the first, and others found within 50 ms."""
        return (self.pid, *self.others)

    def kill(self) -> ProcessExit:
        """Kill all its processes, including daemons, and return when all are dead. A second call returns the same.

        Raises `SandboxError` if one of its processes does not die.
        """
        with contextlib.suppress(OSError):
            self._control.send(b"kill")
        if not self.dead.wait(_DEATH_S):
            raise SandboxError(f"the student's process {self.pid} did not die within {_DEATH_S:g} s of being killed")
        self.join()
        return self.exit or ProcessExit(None, int(signal.SIGKILL), None)

    def __exit__(self, *error: object) -> None:
        """Kill everything."""
        self.kill()


class ForkServer(contextlib.AbstractContextManager["ForkServer"]):
    """Starts students' programs. One serves a whole worker: create it before the runners fork; they share it."""

    def __init__(self, preload: Sequence[str] = PRELOAD, forked: tuple[socket.socket, int] | None = None) -> None:
        """Start the process that students are forked from. It imports the modules while the caller continues.

        `preload` names the modules to import beforehand; those that are not installed are left out. If this process has
        `forked` that one already, it has a socket to it, and its id. Raises `MiddlewareUnavailable` if the middleware
        has not been compiled here.
        """
        self._preload, self._owner = set(preload), os.getpid()
        if forked is None:
            requests, process = start_zygote(preload)
            process.returncode = 0  # `close` waits for it
            forked = requests, process.pid
        self._socket, self._pid = forked

    def preload(self, module: str) -> None:
        """Import one more module for the programs that are started from now on: the types that an exercise uses."""
        if module not in self._preload:
            self._preload.add(module)
            with contextlib.suppress(OSError):  # if the process has ended, the next request says so
                self._socket.send(module.encode())

    def start(
        self, program: ProgramSpec, isolation: Isolation, limits: Limits | None = None, core: int | None = None
    ) -> SandboxedProgram:
        """Start a student's program in a new sandbox, without a network.

        Args:
            program: what to start.
            isolation: the level.
            limits: what it may use.
            core: the CPU to keep it on; several cores make some executors slow without making any faster.

        Raises `SandboxError` if the sandbox could not be made: our fault or the machine's, never the student's.
        """
        limits = limits or Limits()
        # Where the author's files are stays here: a program could search its memory for it.
        shown = replace(program, hidden=())
        start = StartRequest(shown, isolation, limits, core, *_root(program, isolation, limits))
        ours, control = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
        output, output_end = os.pipe2(os.O_CLOEXEC)
        passed = [filesystem.memory_file(pickle.dumps(start)), control.detach(), output_end]
        if program.hub is not None:
            passed.append(os.dup(program.hub))
        try:
            passed += _confinement(program, isolation)
            socket.send_fds(self._socket, [START_REQUEST], passed)
        except OSError as fault:
            os.close(output)
            ours.close()
            raise SandboxError(f"the process that starts students is gone, or can't confine them: {fault}") from fault
        finally:
            for number in passed:
                os.close(number)
        try:
            return SandboxedProgram(ours, output, limits)
        except SandboxError:
            forget()
            raise

    def has_ended(self) -> bool:
        """Return whether the process is gone, for example for lack of memory; then it can start nothing more."""
        return os.waitid(os.P_PID, self._pid, os.WEXITED | os.WNOHANG | os.WNOWAIT) is not None

    def close(self) -> None:
        """End the process. The students it has started end with their runners."""
        self._socket.close()
        if os.getpid() == self._owner:
            os.kill(self._pid, signal.SIGTERM)
            os.waitpid(self._pid, 0)

    def __exit__(self, *error: object) -> None:
        """Close it."""
        self.close()


def _root(program: ProgramSpec, isolation: Isolation, limits: Limits) -> tuple[tuple[filesystem.Mount, ...], bytes]:
    """Return what builds the root of a program's sandbox: steps, or options for bubblewrap."""
    if isolation not in (Isolation.BUBBLEWRAP, Isolation.NAMESPACES):
        return (), b""
    plan = filesystem.mounts(program.readonly, program.hidden, limits.file_bytes)
    return ((), bubblewrap.options(plan)) if isolation is Isolation.BUBBLEWRAP else (plan, b"")


def _confinement(program: ProgramSpec, isolation: Isolation) -> list[int]:
    """Return the descriptor that confines a program: of a user namespace or of Landlock rules."""
    if isolation is Isolation.LANDLOCK:
        return [landlock.rules(program.readonly, program.hidden)]
    return [] if isolation is Isolation.NONE else [os.dup(namespaces.user_namespace_of_this_process())]
