"""What a new course or exercise may be called."""

from __future__ import annotations

import importlib.util
import keyword
import re
import sys
from pathlib import Path

from spinbook.problem import Problem, SpinbookError


def package_name(course: Path) -> str:
    """The ROS package's name for a course in this folder. Raises `SpinbookError` where the folder's name won't do."""
    name = course.name
    if not re.fullmatch(r"[A-Za-z][A-Za-z0-9_-]*", name):
        found = f"`{name or course}` can't be a course's folder."
        # colcon's scripts fall apart at a space in a path.
        mend = "Use letters, digits, - and _, a letter first, such as my-robots."
        raise SpinbookError(Problem(course, None, found, mend))
    package = re.sub(r"_+", "_", name.lower().replace("-", "_")).strip("_")
    _refuse_taken(package, course)
    return package


def exercise_name(name: str, course: Path) -> str:
    """`name`, if an exercise may be called so: it becomes a Python file and a node. Raises `SpinbookError`."""
    file = course / "exercises" / name
    if not re.fullmatch(r"[a-z][a-z0-9]*(_[a-z0-9]+)*", name):
        found = f"`{name}` can't be an exercise's name."
        mend = "Use lower-case letters, digits and single underscores, a letter first, such as gripper_force."
        raise SpinbookError(Problem(file, None, found, mend))
    _refuse_taken(name, file)
    return name


def class_name(exercise: str) -> str:
    """The class that goes with an exercise's name: gripper_force -> GripperForce."""
    return "".join(word.capitalize() for word in exercise.split("_"))


def words(name: str) -> str:
    """A name as words for a title: gripper_force -> Gripper force."""
    return " ".join(re.split(r"[-_]+", name)).strip().capitalize()


def title_of(text: str, file: Path) -> str:
    """`text`, if it can be a title: one line, and nothing that TOML would read as more. Raises `SpinbookError`."""
    if not text.strip() or not text.isprintable() or set(text) & set('"\\'):
        raise SpinbookError(Problem(file, None, f"{text!r} can't be a title.", 'Write one line without " and \\.'))
    return text.strip()


def _refuse_taken(name: str, file: Path) -> None:
    """Refuse a name whose module would hide another, or be hidden by it."""
    if keyword.iskeyword(name) or keyword.issoftkeyword(name):
        found = f"`{name}` is a word of Python's own."
    elif name in sys.stdlib_module_names or _exists(name):
        found = f"there is a Python module `{name}` already, and nodes would import the wrong one."
    else:
        return
    raise SpinbookError(Problem(file, None, found, "Choose another name."))


def _exists(module: str) -> bool:
    # The current folder may hold a module of that name by chance.
    elsewhere = [path for path in sys.path if path and Path(path).resolve() != Path.cwd()]
    return importlib.machinery.PathFinder.find_spec(module, elsewhere) is not None
