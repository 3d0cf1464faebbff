"""Decides whose turn it is among the threads of a program that is being checked: one at a time, in a fixed order.

A thread runs until it waits; then it is the turn of the next one that has anything new to look at. When all of them
wait, the program is idle, and the hub is notified.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable
from typing import Any, Protocol

from rcl_python import participant
from spinbook.browser.in_page import threads

#: How many more times a thread that has to end may wait, such as in a `finally`.
_WAITS_AFTER_END = 100


class HubTime(Protocol):
    """What the scheduler needs of the program's connection to the hub."""

    @property
    def is_wanted(self) -> bool:
        """Whether the main thread has a request to handle."""

    @property
    def has_frames(self) -> bool:
        """Whether frames are waiting."""

    def steady(self) -> int:
        """Return the hub's time (ns)."""

    def heed(self) -> None:
        """Do, in the main thread, what the hub wants."""

    def wait_for_hub(self, until: int | None, in_ros: int) -> None:
        """Wait, with `in_ros` threads in ROS, until a frame, the time (ns) or a signal arrives."""


class Scheduler:
    """The threads of one program; the one that makes it is the main thread."""

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
        """The program has ended. Its other threads end where they wait, so that no stack of theirs is left behind."""
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
        """Return the thread whose turn it is, counted from 1."""
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
        """Wait for another thread, for so long at most (-1: without a limit)."""
        self.wait(None if milliseconds < 0 else round(milliseconds * 1e6), in_ros=False)

    def leave_to_main(self) -> None:
        """Wait without end, unless this is the main thread."""
        if threads.get_ident() != self._main:
            self.wait(None, in_ros=False)

    def wait(self, nanoseconds: int | None, in_ros: bool) -> None:
        """Let others have their turns: for so long, or until there is anything new to look at."""
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
            self._link.heed()
        self._end_after_program(mine)

    def _end_after_program(self, mine: int) -> None:
        """After the program's end, end as `sys.exit` does; a thread that continues waits forever."""
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
            if self._link.is_wanted and self._main in self._due:
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
            # No other thread takes them in.
            participant.current().pump()
        self.changed()


def _closed() -> Any:
    gate = threads.raw_lock()
    gate.acquire()
    return gate
