"""An exercise: what is asked, what the node must be called, which checks judge it."""

from grader.exercise.error import ExerciseError
from grader.exercise.exercise import Exercise
from grader.exercise.loading import load
from grader.exercise.starter import starter

__all__ = ["Exercise", "ExerciseError", "load", "starter"]
