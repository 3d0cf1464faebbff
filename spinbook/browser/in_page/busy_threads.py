"""Detects busy threads: those that poll without waiting, or that always have something to do.

Simulated time advances only when all threads wait, so a busy thread would stop it. Such a thread is treated as
sleeping, as in the grader; the limits are those of rmw_wait.cpp in rmw_lockstep.
"""

from __future__ import annotations

from collections import defaultdict
from dataclasses import dataclass

#: From its third poll on, a polling thread is treated as sleeping this long (ns).
_POLLS, _SLEEP = 2, 10_000_000
#: A thread that takes more turns than this at one moment is treated as sleeping. Each message that is sent or received
#: allows it some turns more.
_TURNS, _TURNS_PER_ACTIVITY = 1_000, 10


@dataclass
class Thread:
    """What one thread has done so far.

    `activity` counts the messages that the program has sent or received, `waits` how often the thread has waited.
    """

    polls: int = 0
    """Polls in a row with no activity and no wait in between."""
    last_poll: tuple[int, int] = (0, 0)
    """`activity` and `waits` at the last poll."""
    turns: int = 0
    """Turns taken at the moment `at` (ns), up to this `activity`."""
    at: int = 0
    activity: int = 0
    sleeps: bool = False
    """Whether it is treated as sleeping because of its many turns."""

    def take_turn(self, activity: int, now: int) -> None:
        """Count a turn in which there was nothing to take."""
        if now != self.at:
            self.at, self.turns = now, 0
        self.turns = max(self.turns - (activity - self.activity) * _TURNS_PER_ACTIVITY, 0) + 1
        self.activity = activity
        self.sleeps = self.turns > _TURNS

    def poll(self, activity: int, waits: int) -> int:
        """Count a fruitless poll. Return how long the thread is to sleep (ns)."""
        self.polls = self.polls + 1 if (activity, waits) == self.last_poll else 0
        sleeps = self.polls >= _POLLS
        self.last_poll = activity, waits + sleeps  # this wait is not the program's own
        return _SLEEP if sleeps else 0


class BusyThreads:
    """All threads of a program, by their numbers."""

    def __init__(self) -> None:
        self._threads: defaultdict[int, Thread] = defaultdict(Thread)

    def sleep_ns(self, number: int, polls: bool, activity: int, waits: int, now: int) -> int:
        """Return how long a thread with nothing to take is to sleep (ns). `polls` says that it does not wait."""
        thread = self._threads[number]
        thread.take_turn(activity, now)
        if thread.sleeps:
            return _SLEEP
        return thread.poll(activity, waits) if polls else 0

    def note_news(self, number: int) -> None:
        """Note that the thread has something to take."""
        self._threads[number].sleeps = False

    def note_wait(self, number: int, now: int) -> None:
        """Note that the thread has waited until `now` (ns). A sleep imposed here does not begin a new moment."""
        thread = self._threads[number]
        if thread.sleeps:
            thread.at = now
