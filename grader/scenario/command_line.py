"""The programs of a scenario, and their arguments."""

from __future__ import annotations

import json
from typing import Any

from grader.exercise.exercise import Exercise
from grader.recording.events import ProgramStart
from grader.scenario.scenario import Program, Scenario

#: The arguments of every program.
ARGUMENTS = ("--ros-args", "-p", "use_sim_time:=true")


def programs_of(exercise: Exercise, scenario: Scenario) -> tuple[Program, ...]:
    """Return each program that a scenario starts, in the order of exercise.toml; () for the only one, started once."""
    files = [part.file for part in exercise.programs] or ([exercise.file_name] if scenario.programs else [])
    starts = [[one for one in scenario.programs if one.file == file] or [Program(file)] for file in files]
    return tuple(program for each in starts for program in each)


def starts(exercise: Exercise, scenario: Scenario) -> tuple[ProgramStart, ...]:
    """Return the programs of a scenario, if any has a namespace or remappings."""
    nodes = {part.file: part.node for part in exercise.programs} or {exercise.file_name: exercise.node_name}
    programs = programs_of(exercise, scenario) or (Program(exercise.file_name),)
    found = []
    for one in programs:
        space = (one.namespace or scenario.namespace).rstrip("/")
        names = {**scenario.remappings, **one.remappings}.items()
        remappings = {_full(name, space): _full(to, space) for name, to in names}
        found.append(ProgramStart(one.id, nodes[one.file], space, remappings))
    return tuple(found) if any(start.namespace or start.remappings for start in found) else ()


def _full(name: str, namespace: str) -> str:
    return name if name.startswith("/") else f"{namespace}/{name}"


def arguments(
    scenario: Scenario, program: Program | None = None, always: tuple[str, ...] = ARGUMENTS
) -> tuple[str, ...]:
    """Return the arguments that follow a program's name on its command line in a scenario: its own, and `always`."""
    one = program or Program("")
    found = [*one.arguments, *scenario.arguments, *always]
    for name, value in {**scenario.parameters, **one.parameters}.items():
        found += ["-p", f"{name}:={_yaml(value)}"]
    for name, to in {**scenario.remappings, **one.remappings}.items():
        found += ["-r", f"{name}:={to}"]
    if namespace := one.namespace or scenario.namespace:
        found += ["-r", f"__ns:={namespace}"]
    return tuple(found)


def _yaml(value: Any) -> str:
    """Return a parameter's value for the command line, such as `2.0`, `true` or `["a", "b"]`."""
    if isinstance(value, (list, tuple)):
        return f"[{', '.join(_yaml(one) for one in value)}]"
    if isinstance(value, float):
        text = repr(value)
        special = {"nan": ".nan", "inf": ".inf", "-inf": "-.inf"}
        # In YAML 1.1, a number with an exponent also needs a decimal point.
        return special.get(text, text if "." in text or "e" not in text else text.replace("e", ".0e"))
    return json.dumps(value)
