"""How a student's program ends: by itself, or because it is asked to."""

from __future__ import annotations

from grader.recording import Ending
from grader.rig.patience import Patience
from grader.rig.story import TRACEBACK, is_rclpys_own, last_words, of_exit
from grader.rig.student import Student
from grader.rig.watch import Watch

#: How long a node may take to end after Ctrl-C, in CPU time and blocked time together.
MAY_TAKE_S = 2.0


def cut_short(student: Student, file_name: str, source: str, met: bool, sent: int) -> Ending:
    """The ending of a program that ended by itself, after `sent` messages; `met` is whether it had got so far."""
    exit_ = student.poll() or student.kill()
    log = student.output().text
    why, line = of_exit(exit_, log, file_name, source)
    if exit_.limit:
        return Ending("over-limit", f"Your program was ended: {why}", line)
    if not met:
        if exit_.code == 0 and not line:
            why = "it came to its end and created no node that spins. Is main() called, and does it call rclpy.spin()?"
        return Ending("did-not-start", f"Your program did not start: {why}", line)
    return Ending("crashed", f"Your program ended at message {sent}: {why}", line)


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
