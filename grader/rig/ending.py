"""How a student's program ends when it is asked to."""

from __future__ import annotations

from grader.recording import Ending
from grader.rig.patience import Patience
from grader.rig.watch import Watch
from grader.runner.ending import MAY_TAKE_S
from grader.runner.story import TRACEBACK, is_rclpys_own, last_words


def interrupted(watch: Watch, file_name: str, source: str) -> Ending:
    """Ask the program to end, as Ctrl-C does, and see how it takes it."""
    student = watch.student
    before = student.output().text.count(TRACEBACK)
    student.interrupt()
    patience = Patience(watch, cpu_s=MAY_TAKE_S, blocked_s=MAY_TAKE_S)
    while student.wait(0.02) is None:
        patience.look()
        if patience.blocked + patience.cpu >= MAY_TAKE_S:
            return Ending("completed", interrupted=True, ended_in_time=False)
    log = student.output().text
    broke = log.count(TRACEBACK) > before and not is_rclpys_own(log, file_name, source)
    words = last_words(log, "") if broke else None
    return Ending("completed", interrupted=True, traceback=words.error if words else "")
