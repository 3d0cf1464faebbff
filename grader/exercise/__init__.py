"""An exercise: what is asked, what the node must be called, which checks judge it."""

from grader.exercise.exercise import Exercise, ExerciseError
from grader.exercise.loading import load
from grader.exercise.starter import starter

__all__ = ["Exercise", "ExerciseError", "load", "starter"]
