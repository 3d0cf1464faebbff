"""Makes a course or an exercise from a template, with a name that is valid everywhere."""

from __future__ import annotations

import importlib.util
import keyword
import re
import shutil
import sys
import tempfile
from collections.abc import Mapping
from pathlib import Path

from grader.exercise.exercise import OWN_FILES, Exercise, ExerciseError
from grader.scenario.declared import declared
from grader.scenario.scenario import Scenario
from groundwork.files import write_if_changed
from groundwork.problem import Problem
from spinbook.new.kind import ExerciseKind, kinds
from spinbook.new.skeleton import skeleton, with_relative_names
from spinbook.problem import SpinbookError

#: A whole course, with one exercise.
COURSE = Path(__file__).parent / "template"

KINDS = kinds()

BY_NAME = {kind.name: kind for kind in KINDS}


def default_kind() -> ExerciseKind:
    """Return the kind that `spinbook new --exercise NAME` makes. Raises `SpinbookError` if there are no kinds here."""
    if not KINDS:
        raise _without_templates()
    return BY_NAME["filter"]


def package_name(course: Path) -> str:
    """Return the ROS package's name for a course in this folder. Raises `SpinbookError` if the name is invalid."""
    name = course.name
    if not re.fullmatch(r"[A-Za-z][A-Za-z0-9_-]*", name):
        problem = f"`{name or course}` can't be a course's folder."
        # colcon's scripts fail if there is a space in a path.
        fix = "Use letters, digits, - and _, a letter first, such as my-robots."
        raise SpinbookError(Problem(course, None, problem, fix))
    package = re.sub(r"_+", "_", name.lower().replace("-", "_")).strip("_")
    _refuse_taken(package, course)
    return package


def exercise_name(name: str, course: Path) -> str:
    """Return `name`, if it is valid for an exercise, a Python file and a node. Raises `SpinbookError` otherwise."""
    file = course / "exercises" / name
    if not re.fullmatch(r"[a-z][a-z0-9]*(_[a-z0-9]+)*", name):
        problem = f"`{name}` can't be an exercise's name."
        fix = "Use lower-case letters, digits and single underscores, a letter first, such as gripper_force."
        raise SpinbookError(Problem(file, None, problem, fix))
    _refuse_taken(name, file)
    if f"{name}.py" in OWN_FILES:
        problem = f"each exercise has a {name}.py, and the student's file would have the same name."
        raise SpinbookError(Problem(file, None, problem, "Choose another name."))
    return name


def words(name: str) -> str:
    """Return a name as words for a title: gripper_force -> Gripper force."""
    return " ".join(re.split(r"[-_]+", name)).strip().capitalize()


def title_of(text: str, file: Path) -> str:
    """Return `text`, if it can be a title: one line with no special meaning in TOML. Or raises `SpinbookError`."""
    if not text.strip() or not text.isprintable() or set(text) & set('"\\'):
        raise SpinbookError(Problem(file, None, f"{text!r} can't be a title.", 'Write one line without " and \\.'))
    return text.strip()


def _refuse_taken(name: str, file: Path) -> None:
    """Refuse a name whose module would hide another, or be hidden by it."""
    if keyword.iskeyword(name) or keyword.issoftkeyword(name):
        problem = f"`{name}` is a keyword of Python."
    elif name in sys.stdlib_module_names or _exists(name):
        problem = f"there is a Python module `{name}` already, and nodes would import the wrong one."
    else:
        return
    raise SpinbookError(Problem(file, None, problem, "Choose another name."))


def _exists(module: str) -> bool:
    # The current folder may contain a module of that name by chance.
    elsewhere = [path for path in sys.path if path and Path(path).resolve() != Path.cwd()]
    return importlib.machinery.PathFinder.find_spec(module, elsewhere) is not None


# Nothing is ever overwritten: a temporary folder is filled first, and then renamed.


#: The exercise of a new course.
EXERCISE = "speed_limit"

#: Files whose names begin with a dot in a course, but not here, as packaging tools would leave them out.
_DOTTED = ("_gitignore", "_github")

_CHECKOUT = "Use a checkout of Spinbook: git clone https://github.com/spinbook/spinbook && cd spinbook && make course"


def write_course(folder: Path, title: str, package: str) -> None:
    """Make a course in `folder`, which must not exist. Raises `SpinbookError`."""
    names = {"My first course": title, "my_first_course": package}
    _refuse_existing(folder)
    _put(_filled(COURSE, names), folder)


def write_exercise(course: Path, name: str, title: str, kind: ExerciseKind) -> None:
    """Make an exercise of a kind, and its solutions, in a course. Raises `SpinbookError` if its folder exists."""
    folders = {part: course / part / name for part in ("exercises", "solutions")}
    for folder in folders.values():
        _refuse_existing(folder)
    files = kind.files(name, title)
    for part, folder in folders.items():
        inside = Path(part, name)
        _put({path.relative_to(inside): text for path, text in files.items() if path.is_relative_to(inside)}, folder)


def write_solution(course: Path, exercise: Exercise) -> Path:
    """Make solution.py of an exercise that has none, from its interface. Raises `SpinbookError` if there is one."""
    file = course / "solutions" / exercise.name / "solution.py"
    _refuse_existing(file)
    try:
        file.parent.mkdir(parents=True, exist_ok=True)
        write_if_changed(file, skeleton(with_relative_names(exercise, _scenarios_of(exercise))).encode())
    except OSError as error:
        problem = f"it can't be made: {error.strerror}."
        raise SpinbookError(Problem(file, None, problem, "Choose a place where you may write.")) from None
    return file


def _scenarios_of(exercise: Exercise) -> tuple[Scenario, ...]:
    """Return the exercise's scenarios; none if they are not written yet, or not right."""
    try:
        return declared(exercise, seed=1)
    except ExerciseError:
        return ()


def _refuse_existing(folder: Path) -> None:
    if folder.exists() or folder.is_symlink():
        problem = "something with this name exists already."
        raise SpinbookError(
            Problem(folder, None, problem, "Nothing is overwritten: choose another name, or move it away.")
        )


def _filled(template: Path, names: Mapping[str, str]) -> dict[Path, str]:
    """Return the template's files by their paths in the result, with other names in them. Raises `SpinbookError`."""
    if not template.is_dir():
        raise _without_templates()
    files: dict[Path, str] = {}
    for file in sorted(template.rglob("*")):
        path = file.relative_to(template)
        if not file.is_file() or "__pycache__" in path.parts:
            continue
        first = path.parts[0]
        if first in _DOTTED:
            path = Path(f".{first[1:]}", *path.parts[1:])
        text = file.read_text(encoding="utf-8")
        for old, new in names.items():
            text = text.replace(old, new)
        files[path] = text
    return files


def _without_templates() -> SpinbookError:
    problem = "this installation has no templates of courses and exercises: it came with a handout, for students."
    return SpinbookError(Problem(COURSE, None, problem, _CHECKOUT))


def _put(files: Mapping[Path, str], folder: Path) -> None:
    """Write all the files, or none."""
    try:
        folder.parent.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryDirectory(prefix=f".{folder.name}-", dir=folder.parent) as temporary:
            whole = Path(temporary) / folder.name
            for place, text in files.items():
                write_if_changed(whole / place, text)
            shutil.move(whole, folder)
    except OSError as error:
        problem = f"it can't be made: {error.strerror}."
        raise SpinbookError(Problem(folder, None, problem, "Choose a place where you may write.")) from None
