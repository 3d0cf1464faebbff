"""Finds the folder of an exercise by its name."""

from __future__ import annotations

from pathlib import Path


class NoExercise(Exception):
    """Raised when nothing is called so; says what there is."""


def find(name: str, start: Path) -> Path:
    """The folder that `name` means: a path, or a name in the exercises/ of `start` or of a folder above it.

    Raises `NoExercise`.
    """
    if Path(name, "exercise.toml").exists():
        return Path(name)
    known: list[str] = []
    for course in (start, *start.parents):
        exercises = course / "exercises"
        if (exercises / name / "exercise.toml").exists():
            return exercises / name
        known += sorted(file.parent.name for file in exercises.glob("*/exercise.toml"))
    told = f"There are: {', '.join(known)}." if known else "Start in a course's folder, the one with exercises/ in it."
    raise NoExercise(f"There is no exercise {name!r} here. {told}")
