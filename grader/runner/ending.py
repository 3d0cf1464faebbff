"""How a student's program ends by itself."""

from __future__ import annotations

from grader.recording.recording import Ending
from grader.runner.story import of_exit
from grader.runner.student import Student

#: How long a node may take to end after Ctrl-C: CPU time and blocked time together.
MAY_TAKE_S = 2.0


def cut_short(student: Student, file_name: str, source: str, met: bool, when: str) -> Ending:
    """Return the ending of a program that ended by itself, `when`; `met` is whether it had become ready."""
    exit_ = student.poll() or student.kill()
    log = student.output().text
    why, line = of_exit(exit_, log, file_name, source)
    if exit_.limit:
        return Ending("over-limit", f"Your program was ended: {why}", line)
    if not met:
        if exit_.code == 0 and not line:
            why = "it came to its end and created no node that spins. Is main() called, and does it call rclpy.spin()?"
        return Ending("did-not-start", f"Your program did not start: {why}", line)
    return Ending("crashed", f"Your program ended {when}: {why}", line)
