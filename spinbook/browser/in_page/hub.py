"""The grader's hub in a page: the program runs in the same interpreter, and turns replace the sockets.

The grader's own code (grader/runner, rmw_lockstep/hub) decides what happens, and when. This module only connects it to
the program: `PageHub` and `PageConnection` are the hub's side, and `Turns` alternates between the hub and the program.
"""

from __future__ import annotations

from collections import deque
from pathlib import Path

from rmw_lockstep.hub import Hub, HubLimits
from rmw_lockstep.hub.frames import HelloFrame, IdleFrame
from rmw_lockstep.hub.limits import HubUsage
from rmw_lockstep.hub.link import ProcessLink
from rmw_lockstep.hub.router import Router
from spinbook.browser.in_page import program_imports, threads

#: The number of the program among the processes of its run.
PROGRAM = 1


class RunFinished(BaseException):
    """Raised in the program when its run has ended. Programs can't catch it by mistake."""


class Turns:
    """Lets the program's threads and the hub's thread take turns: the two sides never run at the same time."""

    def __init__(self) -> None:
        self._program, self._hub = threads.raw_lock(), threads.raw_lock()
        self._program.acquire()
        self._hub.acquire()
        self.is_over = False
        """Whether the program must end now, as if it were killed."""
        self.has_ended = False
        self.fault: BaseException | None = None
        """The exception in the hub's code while it handled what the program sent."""
        self.signal = ""
        """The name of a signal that the program gets when it continues; "" if there is none."""

    @property
    def is_done(self) -> bool:
        """Whether the program will not continue."""
        return self.is_over or self.has_ended

    def let_program_go_on(self) -> None:
        """Wait, on the hub's side, until the program is idle or has ended. Raises `fault` if there is one."""
        if not self.has_ended:
            program_imports.turn_to_program()
            self._program.release()
            self._hub.acquire()
            program_imports.turn_to_page()
        fault, self.fault = self.fault, None
        if fault is not None:
            raise fault

    def wait_for_first(self) -> None:
        """Wait, on the program's side, for its first turn."""
        self._program.acquire()

    def let_hub_go_on(self) -> None:
        """Give the hub its turn, on the program's side, and wait for the next turn or the end of the run."""
        if not self.is_done:
            self._hub.release()
            self._program.acquire()

    def end(self) -> None:
        """Note that the program has ended."""
        self.has_ended = True
        self._hub.release()


class PageConnection(ProcessLink):
    """The hub's end of the connection to the program."""

    def __init__(self, use: HubUsage) -> None:
        self.queued: deque[bytes] = deque()
        # There is no socket: the program's side takes the frames out of the queue. No process has the number 0.
        super().__init__(None, PROGRAM, use, pid=0)  # type: ignore[arg-type]
        self.hello = HelloFrame(1, PROGRAM, 0, True)

    def queue(self, frame: bytes) -> None:
        """Put a frame into the program's queue."""
        self.queued.append(frame)
        self.sent += 1
        self.idle = None

    def flush(self) -> None:
        """Do nothing: frames are never in transit."""

    def close(self) -> None:
        """Do nothing: there is nothing to close."""

    def report_idle(self, now: int, until: int | None, in_ros: int) -> None:
        """Note that the program is idle until `until` (ns), or until a frame arrives; `in_ros` threads wait in ROS."""
        self.believe(IdleFrame(self.handled, now, -1 if until is None else until, in_ros, 0, 0, 0, 1, ()))


class PageHub(Hub):
    """The hub of one run."""

    def __init__(self, turns: Turns, limits: HubLimits | None = None) -> None:
        super().__init__(limits=limits)
        self._turns = turns
        self._use.connection(0)
        self.connection = PageConnection(self._use)
        self._router.links.append(self.connection)

    def _listen(self, folder: Path | None) -> None:
        """Do nothing: there are no sockets."""

    @property
    def router(self) -> Router:
        """The router that handles the program's frames."""
        return self._router

    def pause(self) -> None:
        """Let the program continue, and check whether it takes too long."""
        self._take()
        self.on_tick()

    def drain(self) -> None:
        """Do nothing: frames are handled when the program sends them."""

    def _take(self) -> None:
        self._turns.let_program_go_on()
        if self._turns.has_ended:
            if self.connection in self.links:
                self.before_end()
                self._router.forget(self.connection)
            self.on_tick()

    def _flush(self) -> None:
        """Do nothing: frames are never in transit."""

    def _accept(self) -> bool:
        return False
