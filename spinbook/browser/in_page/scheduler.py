"""Schedules the threads of a program that is being checked: one runs at a time, in a fixed order.

A thread runs until it waits; then it is the turn of the next one that has something new to check. When all of them
wait, the program is idle, and the hub gets its turn.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable
from typing import Any, Protocol

from rcl_python import participant
from spinbook.browser.in_page import threads

#: A thread that has to end may wait this many times more, for example in a `finally`.
_WAITS_AFTER_END = 100


class HubTime(Protocol):
    """What the scheduler needs of the program's connection to the hub."""

    @property
    def has_request(self) -> bool:
        """Whether the main thread has a request to handle."""

    @property
    def has_frames(self) -> bool:
        """Whether frames have arrived that were not received yet."""

    def steady(self) -> int:
        """Return the hub's time (ns)."""

    def deliver_signals(self) -> None:
        """End, or handle a signal, if the hub has requested it. Call this in the main thread."""

    def wait_for_hub(self, until: int | None, in_ros: int) -> None:
        """Wait until a frame or a signal arrives, or until the time `until` (ns); `in_ros` threads wait in ROS."""


class Scheduler:
    """Schedules the threads of one program. The thread that creates it is the main thread."""

    def __init__(self, link: HubTime) -> None:
        self._link = link
        self._main = threads.get_ident()
        self._gates: dict[int, Any] = {self._main: _closed()}
        self._due: dict[int, int | None] = {}
        self._in_ros: set[int] = set()
        self._to_check: set[int] = set()
        self._numbers = {self._main: 1}
        self.waits: Counter[int] = Counter()
        """How often each thread has waited, by its number."""
        self._waits_after_end: Counter[int] | None = None
        """How often each thread wanted to wait after the program's end; None before that."""

    def close(self) -> None:
        """End the other threads where they wait, after the program's end, so that none of their stacks is left."""
        self._waits_after_end = Counter()
        for thread in [thread for thread in self._gates if thread != self._main]:
            self._gates[thread].release()
            self._gates[self._main].acquire()
        threads.use_scheduler(None)
        threads.forget(number for number in self._numbers if number != self._main)

    def schedules(self, thread: int) -> bool:
        """Return whether a thread is one of the program's."""
        return thread in self._gates

    def number(self) -> int:
        """Return the number of the thread whose turn it is, counted from 1."""
        return self._numbers.get(threads.get_ident(), 1)

    def start(self, run: Callable[[], None]) -> int:
        """Start another thread of the program, whose turn comes later."""
        gate = _closed()

        def body() -> None:
            gate.acquire()
            try:
                if self._waits_after_end is None:
                    run()
            finally:
                self._leave()

        number = threads.raw_start(body)
        self._gates[number] = gate
        self._numbers[number] = len(self._numbers) + 1
        self._due[number] = None
        self._to_check.add(number)
        return number

    def changed(self) -> None:
        """Let all waiting threads check again."""
        self._to_check.update(self._due)

    def pause(self, milliseconds: float) -> None:
        """Wait for another thread, at most this long (-1: without a limit)."""
        self.wait(None if milliseconds < 0 else round(milliseconds * 1e6), in_ros=False)

    def wait(self, nanoseconds: int | None, in_ros: bool) -> None:
        """Let other threads run, for this long (None: no limit) or until there is something new to check."""
        mine = threads.get_ident()
        self._end_after_program(mine)
        self.waits[self.number()] += 1
        self._due[mine] = None if nanoseconds is None else self._link.steady() + nanoseconds
        if in_ros:
            self._in_ros.add(mine)
        next_ = self._next(mine)
        if next_ != mine:
            self._gates[next_].release()
            self._gates[mine].acquire()
        del self._due[mine]
        self._in_ros.discard(mine)
        self._to_check.discard(mine)
        if mine == self._main:
            self._link.deliver_signals()
        self._end_after_program(mine)

    def _end_after_program(self, mine: int) -> None:
        """End this thread as `sys.exit` does, if the program has ended. One that continues waits forever."""
        if self._waits_after_end is None or mine == self._main:
            return
        self._waits_after_end[mine] += 1
        if self._waits_after_end[mine] > _WAITS_AFTER_END:
            self._gates[self._main].release()
            self._gates[mine].acquire()
        raise SystemExit

    def _leave(self) -> None:
        """End this thread."""
        mine = threads.get_ident()
        next_ = self._next(mine) if self._waits_after_end is None else self._main
        del self._gates[mine]
        self._gates[next_].release()

    def _next(self, mine: int) -> int:
        """Return whose turn it is after this one; wait for the hub if all wait."""
        while True:
            if self._link.has_request and self._main in self._due:
                return self._main
            known = list(self._gates)
            at = known.index(mine) + 1
            for thread in (*known[at:], *known[:at]):
                if thread in self._due and (thread in self._to_check or self._is_due(thread)):
                    return thread
            self._let_hub_go_on()

    def _is_due(self, thread: int) -> bool:
        due = self._due[thread]
        return due is not None and due <= self._link.steady()

    def _let_hub_go_on(self) -> None:
        dues = [due for due in self._due.values() if due is not None]
        self._link.wait_for_hub(min(dues, default=None), len(self._in_ros))
        if not self._in_ros and self._link.has_frames:
            # No thread waits in ROS, so none would receive them.
            participant.current().pump()
        self.changed()


def _closed() -> Any:
    gate = threads.raw_lock()
    gate.acquire()
    return gate
