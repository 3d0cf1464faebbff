"""A student's copy of an exercise. What is in it is listed here; nothing else of the author's folders gets there."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path

from grader.crew import Crew
from grader.exercise import Exercise, starter
from grader.exercise.interface import Topic
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
        "exercise.toml": _toml(exercise).encode(),
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


def _toml(exercise: Exercise) -> str:
    """exercise.toml again, from what was read of it: without comments, or keys that are not for students."""
    lines = [
        f"title = {_text(exercise.title)}",
        f"points = {exercise.points:g}",
        f"file = {_text(exercise.file_name)}",
        f"class = {_text(exercise.class_name)}",
        f"node = {_text(exercise.node_name)}",
    ]
    for topic in exercise.topics:
        lines += ["", *_topic(topic)]
    return "\n".join(lines) + "\n"


def _topic(topic: Topic) -> list[str]:
    units = ", ".join(f"{_text(field)} = {_text(unit)}" for field, unit in topic.units.items())
    return [
        f"[[{topic.direction}]]",
        f"topic = {_text(topic.name)}",
        f"type = {_text(topic.type)}",
        f"depth = {topic.depth}",
        *([f"units = {{ {units} }}"] if units else []),
    ]


def _text(value: str) -> str:
    """A TOML basic string: JSON's escapes are among TOML's."""
    return json.dumps(value, ensure_ascii=False)
