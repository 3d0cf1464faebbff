"""What the modules of an exercise may be: those of its scenarios, checks, worlds and companions."""

from __future__ import annotations

import difflib
import importlib
import inspect
import re
from collections.abc import Iterable
from pathlib import Path

from grader.exercise.exercise import Exercise, ExerciseError
from grader.exercise.imported_files import imports_of, installed, place_of, with_modules
from groundwork.words import did_you_mean

#: Files that no student gets. What a public check or scenario needs must be in another file of the exercise's folder.
HIDDEN_FILES = ("scenarios.py", "hidden_checks.py")


def see_modules(exercise: Exercise) -> None:
    """Raise `ExerciseError` for an import that can't work, or that would take a hidden file to students."""
    public = with_modules([exercise.folder / "checks.py"])
    for file in with_modules([exercise.scenarios_file, *exercise.check_files]):
        for line, name in imports_of(file):
            _see_import(exercise, file, line, name)
    see_that_students_have(public)


def see_that_students_have(files: Iterable[Path]) -> None:
    """Raise `ExerciseError` if one of these files, which students get, imports one that they do not get."""
    for file in files:
        for line, name in imports_of(file):
            if f"{name}.py" in HIDDEN_FILES and (file.parent / f"{name}.py").exists():
                problem = f"it imports {name}.py, which students do not get"
                fix = f"Students run this file. Put what it shares with {name}.py into another file of this folder."
                raise ExerciseError(file, problem, fix, line)


def _see_import(exercise: Exercise, file: Path, line: int, name: str) -> None:
    near = exercise.folder / f"{name}.py"
    submitted = (exercise.file_name, *(program.file for program in exercise.programs))
    if near.name in submitted and near.exists():
        problem = f"{near.name} is the name of the file that students hand in"
        raise ExerciseError(file, problem, "Give the module that this line imports another name.", line)
    if near.exists() and installed(near):
        problem = f"{near.name} has the name of an installed module, which this line imports instead"
        raise ExerciseError(file, problem, "Rename it.", line)
    if (exercise.folder / name).is_dir() and not near.exists() and not installed(near):
        problem = f"{name} is a folder in the exercise's folder"
        raise ExerciseError(file, problem, "Import only files next to this one: put the module there.", line)


#: The grader's modules from which authors import.
_FOR_AUTHORS = (
    *("grader.checking", "grader.checking.cause", "grader.scenario", "grader.scenario.numbers"),
    *("grader.scenario.joint_states", "grader.scenario.times"),
)


def import_of(name: str) -> str:
    """Return the line that imports a name that the grader has for authors; "" if it has none."""
    home = next((one for one in _FOR_AUTHORS if callable(getattr(importlib.import_module(one), name, None))), "")
    return f"from {home} import {name}" if home else ""


def _of_argument(called: str, argument: str) -> str:
    """Return what was probably meant by an argument that a class or a function of the grader's does not have."""
    home = import_of(called).split()
    names = inspect.signature(getattr(importlib.import_module(home[1]), called)).parameters if home else ()
    return did_you_mean(argument, names, f"Its arguments: {', '.join(names)}." if names else "")


def _of_import(error: ImportError) -> str:
    """Return what to do about a name that a module of the grader does not have."""
    match = re.match(r"cannot import name '(\w+)' from '(grader[\w.]*)'", str(error))
    if not match:
        return ""
    near = difflib.get_close_matches(match[1], vars(importlib.import_module(match[2])), n=1)
    line = import_of(match[1]) or (f"from {match[2]} import {near[0]}" if near else "")
    return f"Write: {line}" if line else "docs/check-api.md and docs/scenarios.md have the names."


def _remedy(error: BaseException, folder: Path) -> str:
    """Return what to do about an error that authors often make; "" for any other."""
    if isinstance(error, TypeError) and "'module' object is not callable" in str(error):
        return "This is a module. Import what is in it, such as: from grader.scenario.numbers import numbers"
    if isinstance(error, ModuleNotFoundError) and error.name:
        there = [file.stem for file in folder.glob("*.py")]
        return did_you_mean(error.name, there, f"Put {error.name}.py next to this file, or install it.")
    if isinstance(error, ImportError):
        return _of_import(error)
    if isinstance(error, AttributeError) and error.name:
        return did_you_mean(error.name, dir(error.obj), "")
    if isinstance(error, SyntaxError) and "unicode error" in str(error):
        return "Save the file as UTF-8."
    if isinstance(error, FileNotFoundError):
        return 'Is it there? Write its path from this file: Path(__file__).parent / "…".'
    if match := re.search(r"(\w+)(?:\.__init__)?\(\) got an unexpected keyword argument '(\w+)'", str(error)):
        return _of_argument(*match.groups())
    if isinstance(error, TypeError) and re.search(r"\bcheck\(\) (missing|takes)", str(error)):
        return 'Each check has points and a hint: @check(points=5, hint="…").'
    return ""


def error_in(
    error: BaseException, folder: Path, file: Path, subject: str = "", fix: str = "Fix it.", line: int | None = None
) -> ExerciseError:
    """Return an author's error with its innermost line in the exercise's folder; without one, with `file` and `line`.

    `subject` says what failed, such as "the world Tank fails".
    """
    said = error.msg if isinstance(error, SyntaxError) else str(error)
    text = (said.strip().splitlines() or [""])[0]
    problem = f"{type(error).__name__}: {text}" if text else type(error).__name__
    place, line = place_of(error, folder) or (file, line)
    fix = _remedy(error, folder) or fix
    return ExerciseError(place, f"{subject}: {problem}" if subject else problem, fix, line)
