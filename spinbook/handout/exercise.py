"""A student's copy of an exercise. What is in it is listed here; nothing else of the author's folders gets there."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

from grader.crew import Crew
from grader.exercise import Exercise, starter
from grader.exercise.writing import to_toml
from grader.grading import Options
from grader.grading.public import public_part, to_json
from grader.sandbox import Isolation, SandboxUnavailable, choose
from spinbook.handout.comments import without_comments


def exercise_files(exercise: Exercise, crew: Crew) -> dict[str, bytes]:
    """The copy's files by name: task, starter, public checks, and what these judge by.

    Spins the author's solution through the public scenarios, unless that was done before. Raises `ExerciseError`.
    """
    solution = exercise.solution_file
    assert solution
    public = public_part(exercise, Options(), _isolation(), crew)
    return {
        "task.md": without_comments(exercise.task).encode(),
        "exercise.toml": to_toml(exercise).encode(),
        "checks.py": (exercise.folder / "checks.py").read_bytes(),
        exercise.public_file.name: to_json(exercise, public).encode(),
        exercise.file_name: starter(solution.read_text(encoding="utf-8")).encode(),
        **{str(name): (exercise.folder / name).read_bytes() for name in _pictures(exercise)},
    }


def _isolation() -> Isolation:
    try:
        return choose()
    except SandboxUnavailable:
        # The solution is the author's own.
        return Isolation.NONE


def _pictures(exercise: Exercise) -> Iterator[Path]:
    """Pictures beside the task that it shows."""
    for file in sorted(exercise.folder.rglob("*")):
        name = file.relative_to(exercise.folder)
        if file.suffix in (".png", ".svg", ".jpg", ".jpeg", ".gif") and f"]({name.as_posix()}" in exercise.task:
            yield name
