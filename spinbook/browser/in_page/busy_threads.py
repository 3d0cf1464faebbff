"""Finds threads that would never get past one moment, because they look for something again and again, or always have
something to do. They are taken to wait, as the grader takes them to. The figures are those of its rmw_wait.cpp.
"""

from __future__ import annotations

from collections import defaultdict
from dataclasses import dataclass

#: A thread that looks again and again without waiting is taken to wait so long (ns) from its third look on.
_LOOKS, _REST = 2, 10_000_000
#: One that always has something to do, from this turn on at one moment. What is sent or received earns it more.
_TURNS, _TURNS_PER_ACTIVITY = 1_000, 10


@dataclass
class Thread:
    """What one thread has done so far. `activity` counts what was sent or received, `waits` how often it waited."""

    looks: int = 0
    """In a row, without anything happening in between."""
    last_look: tuple[int, int] = (0, 0)
    """`activity` and `waits` then."""
    turns: int = 0
    """At the moment `at` (ns), up to this `activity`."""
    at: int = 0
    activity: int = 0
    rests: bool = False
    """Whether it waits because of its many turns."""

    def take_turn(self, activity: int, now: int) -> None:
        """Count a turn in which nothing was there to take."""
        if now != self.at:
            self.at, self.turns = now, 0
        self.turns = max(self.turns - (activity - self.activity) * _TURNS_PER_ACTIVITY, 0) + 1
        self.activity = activity
        self.rests = self.turns > _TURNS

    def look(self, activity: int, waits: int) -> int:
        """Count a look in vain. Return how long the thread is to rest (ns)."""
        self.looks = self.looks + 1 if (activity, waits) == self.last_look else 0
        rests = self.looks >= _LOOKS
        self.last_look = activity, waits + rests  # this wait is not the program's own
        return _REST if rests else 0


class BusyThreads:
    """All threads of a program, by their numbers."""

    def __init__(self) -> None:
        self._threads: defaultdict[int, Thread] = defaultdict(Thread)

    def rest(self, number: int, looks: bool, activity: int, waits: int, now: int) -> int:
        """Return how long a thread that finds nothing to take is to rest (ns); `looks` if it would not wait at all."""
        thread = self._threads[number]
        thread.take_turn(activity, now)
        if thread.rests:
            return _REST
        return thread.look(activity, waits) if looks else 0

    def found(self, number: int) -> None:
        """The thread finds something to take."""
        self._threads[number].rests = False

    def waited(self, number: int, now: int) -> None:
        """The thread has waited until `now` (ns). Only other waits than its rests get it past the moment."""
        thread = self._threads[number]
        if thread.rests:
            thread.at = now
