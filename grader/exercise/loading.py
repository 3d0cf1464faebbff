"""Finds and reads an exercise's folder."""

from __future__ import annotations

import re
from pathlib import Path

import click

from grader.exercise.exercise import OWN_FILES, REFERENCE_NODE, Exercise, ExerciseError, ProgramFile
from grader.exercise.exercise_toml import TomlTable, endpoints, nodes, packages, parameters, programs, read_toml, topics
from interface_compiler.near import use_near

#: The file in a course's folder.
COURSE = "course.toml"


def load(folder: Path | str) -> Exercise:
    """Return the exercise in `folder`, which is in a course's `exercises/`.

    From then on, the course's own message types, as compiled last, can be imported here and in the sandbox. Raises
    `ExerciseError` if a file is missing, can't be read or lacks an entry.
    """
    folder = Path(folder).resolve()
    use_near(folder, COURSE)
    file = folder / "exercise.toml"
    entries = read_toml(file)
    task = folder / "task.md"
    if not task.exists():
        raise ExerciseError(task, "the exercise has no task text", "Write what the student is asked to do here.")
    top = TomlTable(file, "", 0, entries)
    top.see_keys()
    parts = programs(entries, file)
    launched = nodes(top, bool(parts))
    file_name, class_name, node_name = _main_program(top, parts, launched)
    solutions = folder.parent.parent / "solutions" / folder.name
    exercise = Exercise(
        name=folder.name,
        folder=folder,
        title=_text(top, "title"),
        points=_points(top),
        file_name=file_name,
        class_name=class_name,
        node_name=node_name,
        task=task.read_text(encoding="utf-8-sig"),
        topics=topics(entries, file),
        solution_folder=solutions if solutions.is_dir() else None,
        endpoints=endpoints(entries, file),
        parameters=parameters(entries, file),
        programs=parts,
        reference_node=top.text("reference_node", REFERENCE_NODE),
        advice=top.texts("advice", '{ KeyError = "What if a key is missing?" }'),
        count_hints=top.flag("count_hints"),
        packages=packages(top),
        many_answers=top.flag("many_answers"),
        nodes=launched,
    )
    if not exercise.topics and not exercise.endpoints and not exercise.parameters:
        fix = "Declare each topic under [[subscribe]] or [[publish]], and services, actions and parameters likewise."
        raise ExerciseError(file, "no topics, services, actions or parameters", fix)
    return exercise


def _main_program(top: TomlTable, parts: tuple[ProgramFile, ...], launched: tuple[str, ...]) -> tuple[str, str, str]:
    """Return the name of the submitted file, and class and node of the only program, or of the first of several."""
    if parts and "file" not in top.entries:
        fix = 'Give the name of a submission that is one file with all programs, such as file = "line.py", at the top.'
        top.fault("", "file is missing", fix)
    file_name = _text(top, "file")
    if not re.fullmatch(r"[a-z_][a-z0-9_]*\.py", file_name):
        top.fault("file", f"file = {file_name!r}", "Give a Python file name, such as 'my_node.py'.")
    if taken := [name for name in (file_name, *(part.file for part in parts)) if name in OWN_FILES]:
        fix = "A student's copy has both. Choose another name, such as 'my_node.py'."
        top.fault("file", f"{taken[0]} is a file of the exercise itself", fix)
    if launched:
        if not file_name.endswith("launch.py"):
            fix = "With `nodes`, the submission is a launch file: call it NAME_launch.py."
            top.fault("file", f"file = {file_name!r}", fix)
        return file_name, "", launched[0]
    if not parts:
        if not re.fullmatch(r"/?[A-Za-z_]\w*(/[A-Za-z_]\w*)*", _text(top, "node"), re.ASCII):
            top.fault("node", f"node = {top.entries['node']!r}", "Give a node's name, in letters, digits and _.")
        return file_name, top.text("class"), _text(top, "node")
    for key in ("class", "node"):
        if key in top.entries:
            top.fault(
                key, f"{key} is given next to [[program]]", f"With several programs, write {key} in each [[program]]."
            )
    return file_name, parts[0].class_name, parts[0].node


def _text(top: TomlTable, key: str) -> str:
    if key not in top.entries:
        top.fault("", f"{key} is missing", f'Add a line such as {key} = "…" at the top.')
    value = top.entries[key]
    if not isinstance(value, str) or not value:
        top.fault(key, f"{key} = {value!r}", f'Give {key} as a text, such as {key} = "…".')
    return value


def _points(top: TomlTable) -> float:
    value = top.entries.get("points")
    if isinstance(value, bool) or not isinstance(value, (int, float)) or value <= 0:
        top.fault("points", f"points = {value!r}", "Give the sum of all checks' points, such as points = 100.")
    return float(value)


class NoExercise(click.UsageError):
    """Raised when there is no exercise of the name that was given; lists those that exist."""


def find(name: str, start: Path) -> Path:
    """Return the folder that `name` means: a path, or a name in the exercises/ of `start` or of a folder above it.

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
    text = f"There are: {', '.join(known)}." if known else "Start in a course's folder, the one with exercises/ in it."
    raise NoExercise(f"There is no exercise {name!r} here. {text}")
