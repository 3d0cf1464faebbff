"""Finds out who handed in what: in a folder, a learning platform's download, or as a CSV file tells."""

from grader.intake.handed_in import HandedIn, Intake, IntakeError, Question
from grader.intake.intake import take_in

__all__ = ["HandedIn", "Intake", "IntakeError", "Question", "take_in"]
