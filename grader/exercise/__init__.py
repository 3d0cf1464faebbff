"""An exercise: the task, the node's name and interface, and the checks that judge it."""

from grader.exercise.exercise import Exercise, ExerciseError
from grader.exercise.loading import load
from grader.exercise.starter import starter

__all__ = ["Exercise", "ExerciseError", "load", "starter"]
