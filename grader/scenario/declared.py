"""Reads the scenarios that an exercise declares."""

from __future__ import annotations

import contextlib
import importlib
import importlib.util
import sys
import traceback
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from grader.exercise.exercise import Exercise, ExerciseError
from grader.scenario.resolver import resolved
from grader.scenario.scenario import Scenario


def declared(exercise: Exercise, seed: int) -> tuple[Scenario, ...]:
    """Return what `scenarios(seed)` in the exercise's scenarios.py returns, with every value checked.

    Raises `ExerciseError`, with the line, for a mistake in it.
    """
    file = exercise.scenarios_file
    if not file.exists():
        raise ExerciseError(file, "there is no such file", "Declare in scenarios(seed) what the node is run against.")
    found = _returned(exercise, seed)
    if not found or not all(isinstance(scenario, Scenario) for scenario in found):
        raise ExerciseError(file, "scenarios(seed) returns something else", "Return a tuple of Scenario, at least one.")
    names: list[str] = []
    for scenario in found:
        if scenario.name in names or not scenario.name.isidentifier():
            text = "twice" if scenario.name in names else "no Python name"
            fix = "Give each scenario a Python name of its own."
            raise ExerciseError(file, f"a scenario's name is {scenario.name!r}: {text}", fix, scenario.line or None)
        names.append(scenario.name)
    return tuple(resolved(exercise, scenario) for scenario in found)


def _returned(exercise: Exercise, seed: int) -> tuple[Any, ...]:
    file = exercise.scenarios_file
    name = f"scenarios_of_{exercise.name}"
    spec = importlib.util.spec_from_file_location(name, file)
    assert spec
    assert spec.loader
    module = importlib.util.module_from_spec(spec)
    sys.modules[name] = module  # `inspect` looks here for the file of a class
    try:
        with _files_of(exercise.folder):
            spec.loader.exec_module(module)
            return tuple(module.scenarios(seed))
    except Exception as error:
        raise ExerciseError(file, f"{type(error).__name__}: {error}", "It must run.", _line(error, file)) from None
    finally:
        del sys.modules[name]


@contextlib.contextmanager
def _files_of(folder: Path) -> Iterator[None]:
    """Let scenarios.py import other files of its folder; another exercise may have files of the same names."""
    sys.path.insert(0, str(folder))
    known, wrote, sys.dont_write_bytecode = set(sys.modules), sys.dont_write_bytecode, True
    importlib.invalidate_caches()
    try:
        yield
    finally:
        sys.path.remove(str(folder))
        sys.dont_write_bytecode = wrote
        for name in set(sys.modules) - known:
            if Path(getattr(sys.modules[name], "__file__", None) or "/").parent == folder:
                del sys.modules[name]


def _line(error: Exception, file: Path) -> int | None:
    if isinstance(error, SyntaxError):
        return error.lineno
    lines = [frame.lineno for frame in traceback.extract_tb(error.__traceback__) if frame.filename == str(file)]
    return lines[-1] if lines else None
