"""What each outcome means to a student, and what to do about it."""

from __future__ import annotations

from dataclasses import dataclass

from grader.exercise import Exercise
from grader.grading import Grade
from grader.grading.grade import Outcome


@dataclass(frozen=True)
class Advice:
    """A headline, what it means in a sentence, and steps to take."""

    headline: str
    meaning: str
    steps: tuple[str, ...]


HEADLINES: dict[Outcome, tuple[str, str]] = {
    "graded": ("", ""),
    "did-not-start": (
        "Your program did not start",
        "It ended before there was a node, so no check could be passed.",
    ),
    "crashed": (
        "Your program crashed",
        "It started well and ended by itself in the very first scenario, so no check could be passed.",
    ),
    "timed-out": (
        "Your node stopped answering",
        "It was started, but hung in the very first scenario, so no check could be passed. A busy machine is not the "
        "reason: only your node's own time counts.",
    ),
    "over-limit": (
        "Your program used more than it may",
        "It was ended in the very first scenario, so no check could be passed.",
    ),
    "host-error": (
        "This could not be graded, and that is not your fault",
        "The machine or the grader was at fault. This is no score, and it costs you nothing.",
    ),
}


def advice(grade: Grade, exercise: Exercise) -> Advice | None:
    """What to tell about an outcome that is no plain grade; None for that."""
    headline, meaning = HEADLINES[grade.outcome]
    if not headline:
        return None
    line = f" Look at line {grade.line} first." if grade.line else ""
    printed = " What your program printed stands below." if grade.log.strip() else ""
    again = f"Run it yourself: python3 {exercise.file_name}"
    steps: dict[Outcome, tuple[str, ...]] = {
        "did-not-start": (f"Read the message above.{line}{printed}", f"{again}. It must start without an error."),
        "crashed": (f"Read the message above.{line}{printed}", f"{again}, with the chapter's publisher beside it."),
        "timed-out": (
            "Look for a loop without an end, for a sleep in a callback, and for a missing rclpy.spin(node).",
            f"{again}, with the chapter's publisher beside it. It must answer each message at once.",
        ),
        "over-limit": (
            "Look for what is made over and over: messages, lists that grow, files, threads, processes.",
            f"{again}, and watch it with top.",
        ),
        "host-error": ("There is nothing for you to do: it will be graded again.",),
    }
    return Advice(headline, meaning, steps[grade.outcome])
