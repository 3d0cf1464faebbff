"""Writes exercise.toml again from an exercise, without comments."""

from __future__ import annotations

import json
from typing import Any

from grader.exercise.exercise import REFERENCE_NODE, Exercise, Parameter, ProgramFile, ServiceOrAction, Topic


def to_toml(exercise: Exercise) -> str:
    """The text of an exercise.toml that reads as `exercise`."""
    top: dict[str, Any] = {"title": exercise.title, "points": _number(exercise.points), "file": exercise.file_name}
    if not exercise.programs:
        top |= {"class": exercise.class_name, "node": exercise.node_name}
    top["reference_node"] = "" if exercise.reference_node == REFERENCE_NODE else exercise.reference_node
    top["advice"] = exercise.advice
    tables = [_lines(top)]
    tables += [_table("program", _program(one)) for one in exercise.programs]
    tables += [_table(one.direction, _topic(one)) for one in exercise.topics]
    tables += [_table(one.role, _endpoint(one)) for one in exercise.endpoints]
    tables += [_table("parameter", _parameter(one)) for one in exercise.parameters]
    return "\n\n".join(tables) + "\n"


def _program(one: ProgramFile) -> dict[str, Any]:
    return {"file": one.file, "node": one.node, "class": one.class_name}


def _topic(one: Topic) -> dict[str, Any]:
    elements = {"called": one.elements.called, "named_by": one.elements.named_by} if one.elements else {}
    # The defaults of a queue depth alone are left out.
    reliability = "" if one.reliability == "reliable" else one.reliability
    durability = "" if one.durability == "volatile" else one.durability
    qos = {"depth": one.depth, "reliability": reliability, "durability": durability}
    return {"topic": one.name, "type": one.type, **qos, "units": one.units, "elements": elements}


def _endpoint(one: ServiceOrAction) -> dict[str, Any]:
    return {"name": one.name, "type": one.type, "units": one.units}


def _parameter(one: Parameter) -> dict[str, Any]:
    limits = list(one.range) if one.range else []
    return {"name": one.name, "type": one.type, "default": one.default, "unit": one.unit, "range": limits}


def _table(kind: str, entries: dict[str, Any]) -> str:
    return f"[[{kind}]]\n{_lines(entries)}"


def _lines(entries: dict[str, Any]) -> str:
    """One line for each entry that has a value; 0 and false are values."""
    kept = {key: value for key, value in entries.items() if value is not None and value not in ({}, [], "")}
    return "\n".join(f"{key} = {_value(value)}" for key, value in kept.items())


def _number(value: float) -> float | int:
    return int(value) if value.is_integer() else value


def _value(value: Any) -> str:
    if isinstance(value, dict):
        return f"{{ {', '.join(f'{_key(key)} = {_value(one)}' for key, one in value.items())} }}"
    if isinstance(value, list):
        return f"[{', '.join(_value(one) for one in value)}]"
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, float):
        return repr(value)
    # A TOML basic string: JSON's escapes are among TOML's.
    return json.dumps(value, ensure_ascii=False)


def _key(key: str) -> str:
    return key if key.replace("_", "").isalnum() and key.isascii() else json.dumps(key)
