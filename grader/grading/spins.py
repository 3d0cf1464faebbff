"""The spins of one submission, done by whoever grades it and by whoever has time to help."""

from __future__ import annotations

import threading
from collections import deque
from collections.abc import Sequence
from concurrent.futures import Future
from dataclasses import replace

from grader.crew import Crew
from grader.crew.jobs import SpinJob
from grader.recording import Recording


class Spins:
    """Some spins that may be done in any order and at the same time. Any thread may call anything here."""

    def __init__(self, jobs: Sequence[SpinJob], crew: Crew) -> None:
        """The first of `jobs` is the first to be begun."""
        self._crew = crew
        self._waiting = deque(jobs)
        self._recordings: dict[str, Future[Recording]] = {job.scenario.name: Future() for job in jobs}
        self._given_up = threading.Event()

    @property
    def left(self) -> int:
        """How many nobody has begun yet."""
        return len(self._waiting)

    def work(self, core: int | None = None) -> None:
        """Do one spin after another, in one process, until nobody has to begin any more.

        `core` is the CPU to keep the program on, None for the one that each job names. What goes wrong with a spin is
        raised where its recording is asked for.
        """
        with self._crew.hand() as hand:
            while job := self._next():
                recording = self._recordings[job.scenario.name]
                try:
                    recording.set_result(hand.do(job if core is None else replace(job, core=core), self._given_up))
                except BaseException as fault:
                    recording.set_exception(fault)

    def _next(self) -> SpinJob | None:
        try:
            return self._waiting.popleft()
        except IndexError:
            return None

    def recording(self, scenario: str) -> Recording:
        """The recording of a scenario, which is waited for. Raises `HostFault` when it can't be had."""
        return self._recordings[scenario].result()

    def give_up(self) -> None:
        """Begin no more, and end those under way."""
        self._waiting.clear()
        self._given_up.set()
