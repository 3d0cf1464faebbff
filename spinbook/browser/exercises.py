"""The public parts of the exercises, by which a page checks a reader's code."""

from __future__ import annotations

from collections.abc import Iterable

from grader.crew import Crew
from grader.exercise import Exercise
from spinbook.handout.exercise import exercise_files

#: What of a student's copy the checks need.
_NEEDED = ("exercise.toml", "checks.py", "public.json", "task.md")


def public_parts(exercises: Iterable[Exercise]) -> dict[str, bytes]:
    """What a student's copy of each exercise holds, by its path in the archive of checks: nothing that is hidden.

    Runs the solutions through their public scenarios, unless that was done before. Raises `ExerciseError`.
    """
    files: dict[str, bytes] = {}
    with Crew() as crew:
        for exercise in exercises:
            copy = exercise_files(exercise, crew)
            files |= {f"exercises/{exercise.name}/{name}": copy[name] for name in _NEEDED if name in copy}
    return files
