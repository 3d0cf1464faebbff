"""Asks a program to end, as Ctrl-C does, and sees how it ends."""

from __future__ import annotations

import contextlib
import time

from grader.recording.recording import Ending
from grader.runner.budget import Allowance, Budget, Gone
from grader.runner.ending import MAY_TAKE_S
from grader.runner.stopped import Stopped
from grader.runner.story import TRACEBACK, is_rclpys_own, last_words
from grader.runner.student import Student
from grader.scenario.scenario import SECOND
from rmw_lockstep.hub import TICK_S, Hub

_ALLOWANCE = Allowance("", "", MAY_TAKE_S, MAY_TAKE_S)


def interrupted(hub: Hub, budget: Budget, student: Student, file_name: str, source: str) -> Ending:
    """Return how the program ends. It has 2 s, of CPU time and blocked time together.

    There is no way to know when the signal has reached the program. So from here on the computer's clock runs as fast
    as a real one, and a program that waits for a time waits as long as it would in real life.
    """
    before = student.output().text.count(TRACEBACK)
    student.interrupt()
    budget.begin(_ALLOWANCE)
    if not _ends(hub, budget):
        return Ending("completed", interrupted=True, ended_in_time=False)
    log = student.output().text
    broke = log.count(TRACEBACK) > before and not is_rclpys_own(log, file_name, source)
    words = last_words(log, "") if broke else None
    return Ending("completed", interrupted=True, traceback=words.error if words else "")


def _ends(hub: Hub, budget: Budget) -> bool:
    granted = time.monotonic()
    with contextlib.suppress(Gone):
        with contextlib.suppress(Stopped):
            while budget.used < MAY_TAKE_S:
                hub.pause()
                if time.monotonic() - granted >= TICK_S and hub.is_idle():
                    granted = time.monotonic()
                    hub.advance(hub.now + round(TICK_S * SECOND))
        return False
    return True
