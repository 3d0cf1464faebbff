"""Reads the scenarios that an exercise declares."""

from __future__ import annotations

import importlib.util
import traceback
from pathlib import Path

from grader.exercise import Exercise, ExerciseError
from grader.scenario.scenario import Scenario


def declared(exercise: Exercise, seed: int) -> tuple[Scenario, ...]:
    """What `scenarios(seed)` in the exercise's scenarios.py returns. Raises `ExerciseError` where it is unusable."""
    file = exercise.scenarios_file
    if not file.exists():
        raise ExerciseError(file, "there is no such file", "Declare what the node is spun against in scenarios(seed).")
    spec = importlib.util.spec_from_file_location(f"scenarios_of_{exercise.name}", file)
    assert spec
    assert spec.loader
    module = importlib.util.module_from_spec(spec)
    try:
        spec.loader.exec_module(module)
        found = tuple(module.scenarios(seed))
    except Exception as error:
        raise ExerciseError(file, f"{type(error).__name__}: {error}", "It must run.", _line(error, file)) from None
    if not found or not all(isinstance(scenario, Scenario) for scenario in found):
        raise ExerciseError(file, "scenarios(seed) returns something else", "Return a tuple of Scenario, at least one.")
    names = [scenario.name for scenario in found]
    for name in names:
        if names.count(name) > 1 or not name.isidentifier():
            raise ExerciseError(file, f"a scenario's name is {name!r}", "Give each a Python name of its own.")
    for scenario in found:
        if not scenario.messages:
            raise ExerciseError(file, f"the scenario {scenario.name} has no messages", "Let something happen in it.")
    return found


def _line(error: Exception, file: Path) -> int | None:
    if isinstance(error, SyntaxError):
        return error.lineno
    lines = [frame.lineno for frame in traceback.extract_tb(error.__traceback__) if frame.filename == str(file)]
    return lines[-1] if lines else None
