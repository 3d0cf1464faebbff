"""Reads the scenarios that an exercise declares."""

from __future__ import annotations

import inspect
import reprlib
from collections.abc import Iterable
from pathlib import Path
from types import FunctionType
from typing import Any

from grader.exercise.computing_limit import computing_limit
from grader.exercise.exercise import Exercise, ExerciseError
from grader.exercise.imported_files import importable, imported
from grader.exercise.modules import error_in, see_modules
from grader.scenario.resolver import resolved
from grader.scenario.scenario import Scenario


def declared(exercise: Exercise, seed: int) -> tuple[Scenario, ...]:
    """Return what `scenarios(seed)` in the exercise's scenarios.py returns, with every value checked.

    Raises `ExerciseError`, with the line, for a mistake in it.
    """
    file = exercise.scenarios_file
    if not file.exists():
        raise ExerciseError(file, "there is no such file", "Declare in scenarios(seed) what the node is run against.")
    see_modules(exercise)
    found = _returned(exercise, seed)
    names: list[str] = []
    for scenario in found:
        if scenario.name in names or not scenario.name.isidentifier():
            text = "twice" if scenario.name in names else "no Python name"
            fix = "Give each scenario a Python name of its own."
            raise ExerciseError(file, f"a scenario's name is {scenario.name!r}: {text}", fix, scenario.line or None)
        names.append(scenario.name)
    return tuple(resolved(exercise, scenario) for scenario in found)


def _returned(exercise: Exercise, seed: int) -> tuple[Scenario, ...]:
    file, folder = exercise.scenarios_file, exercise.folder
    try:
        with importable(folder), computing_limit():
            module = imported(file, f"scenarios_of_{exercise.name}")
            _see_signature(module, file)
            found = module.scenarios(seed) if hasattr(module, "scenarios") else ()
            # A generator computes only now.
            found = tuple(found) if isinstance(found, Iterable) else found
    except ExerciseError:
        raise
    except Exception as error:
        raise error_in(error, folder, file, fix="Fix it: this file runs before anything is graded.") from None
    several = found if isinstance(found, tuple) else ()
    if not several or not all(isinstance(scenario, Scenario) for scenario in several):
        line = module.scenarios.__code__.co_firstlineno if hasattr(module, "scenarios") else None
        other = next((one for one in several if not isinstance(one, Scenario)), found)
        what = "one Scenario" if isinstance(other, Scenario) else reprlib.repr(other)
        returned = f"{what}, which is no Scenario" if several else f"{what}, and not several"
        problem = f"scenarios(seed) returns {returned}" if line else "there is no scenarios(seed)"
        raise ExerciseError(file, problem, "Return a tuple of at least one: return (Scenario(…),)", line)
    return several


def _see_signature(module: Any, file: Path) -> None:
    function = getattr(module, "scenarios", None)
    if not isinstance(function, FunctionType):
        return
    try:
        inspect.signature(function).bind(0)
    except TypeError:
        problem = f"scenarios{inspect.signature(function)} does not take the seed"
        line = function.__code__.co_firstlineno
        raise ExerciseError(file, problem, "Write def scenarios(seed):", line) from None
