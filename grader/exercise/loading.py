"""Reads an exercise's folder."""

from __future__ import annotations

import re
import sys
from pathlib import Path
from typing import Any

from grader.exercise.error import ExerciseError
from grader.exercise.exercise import Exercise
from grader.exercise.interface import Topic
from interface_compiler import prefixes
from interface_compiler.near import use_near

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

TYPE = re.compile(r"[a-z][a-z0-9_]*/msg/[A-Z][A-Za-z0-9]*")


def load(folder: Path | str) -> Exercise:
    """The exercise in `folder`, which lies in a course's `exercises/`.

    The course's own message types, as they were compiled last, can be imported from then on, here and in the sandbox.

    Raises `ExerciseError` when a file is missing, can't be read or lacks an entry.
    """
    folder = Path(folder).resolve()
    use_near(folder)
    file = folder / "exercise.toml"
    entries = _read(file)
    task = folder / "task.md"
    if not task.exists():
        raise ExerciseError(task, "the exercise has no task text", "Write what the student is asked to do here.")
    file_name = _text(entries, "file", file)
    if not re.fullmatch(r"[a-z_][a-z0-9_]*\.py", file_name):
        raise ExerciseError(file, f"file = {file_name!r}", "Give a Python file name, such as 'my_node.py'.")
    solutions = folder.parent.parent / "solutions" / folder.name
    return Exercise(
        name=folder.name,
        folder=folder,
        title=_text(entries, "title", file),
        points=_points(entries, file),
        file_name=file_name,
        class_name=_text(entries, "class", file),
        node_name=_text(entries, "node", file),
        task=task.read_text(encoding="utf-8"),
        topics=_topics(entries, file),
        solution_folder=solutions if solutions.is_dir() else None,
    )


def _read(file: Path) -> dict[str, Any]:
    try:
        entries: dict[str, Any] = tomllib.loads(file.read_text(encoding="utf-8"))
        return entries
    except FileNotFoundError:
        raise ExerciseError(file, "there is no such file", "An exercise is a folder with an exercise.toml.") from None
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise ExerciseError(file, f"it can't be read: {error}", "Write it as TOML, in UTF-8.") from None


def _text(entries: dict[str, Any], key: str, file: Path) -> str:
    value = entries.get(key)
    if not isinstance(value, str) or not value:
        raise ExerciseError(file, f"{key} = {value!r}", f'Give {key} as a text, such as {key} = "…".')
    return value


def _points(entries: dict[str, Any], file: Path) -> float:
    value = entries.get("points")
    if isinstance(value, bool) or not isinstance(value, (int, float)) or value <= 0:
        raise ExerciseError(file, f"points = {value!r}", "Give the sum of all checks' points, such as points = 100.")
    return float(value)


def _must_be_known(kind: str, file: Path) -> None:
    package, _, name = kind.partition("/")
    known = prefixes.interfaces(prefixes.installed())
    if package not in known:
        mend = f"If the course defines it: spinbook build. If Spinbook brings it: spinbook interfaces add {package}."
        raise ExerciseError(file, f"type = {kind!r}: the package {package} is not installed here", mend)
    if name not in known[package]:
        mend = "Look at its name. If the course has just defined it: spinbook build."
        raise ExerciseError(file, f"type = {kind!r}: the package {package} has no {name}", mend)


def _topics(entries: dict[str, Any], file: Path) -> tuple[Topic, ...]:
    topics = []
    for direction in ("subscribe", "publish"):
        for entry in entries.get(direction, []):
            name, kind = entry.get("topic", ""), entry.get("type", "")
            if not name.startswith("/"):
                raise ExerciseError(file, f"topic = {name!r}", "Write a topic's full name, beginning with '/'.")
            if not TYPE.fullmatch(kind):
                raise ExerciseError(file, f"type = {kind!r}", "Write a type as 'sensor_msgs/msg/JointState'.")
            _must_be_known(kind, file)
            topics.append(Topic(name, kind, direction, entry.get("depth", 10), entry.get("units", {})))
    if not topics:
        raise ExerciseError(file, "no topics", "Declare each topic of the node under [[subscribe]] or [[publish]].")
    return tuple(topics)
