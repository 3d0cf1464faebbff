"""Writes the exercise.toml of an exercise, without comments."""

from __future__ import annotations

import json
from typing import Any

from grader.exercise.exercise import REFERENCE_NODE, Exercise, Parameter, ProgramFile, ServiceOrAction, Topic


def to_toml(exercise: Exercise) -> str:
    """Return the text of an exercise.toml that reads as `exercise`."""
    top: dict[str, Any] = {"title": exercise.title, "points": _number(exercise.points), "file": exercise.file_name}
    if not exercise.programs and not exercise.nodes:
        top |= {"class": exercise.class_name, "node": exercise.node_name}
    top["nodes"] = list(exercise.nodes)
    top["reference_node"] = "" if exercise.reference_node == REFERENCE_NODE else exercise.reference_node
    top["advice"] = exercise.advice
    top |= {"count_hints": True} if exercise.count_hints else {}
    top |= {"many_answers": True} if exercise.many_answers else {}
    top["packages"] = list(exercise.packages)
    tables = [_lines(top)]
    tables += [_table("program", _program(program)) for program in exercise.programs]
    tables += [_table(topic.direction, _topic(topic)) for topic in exercise.topics]
    tables += [_table(endpoint.role, _endpoint(endpoint)) for endpoint in exercise.endpoints]
    tables += [_table("parameter", _parameter(parameter)) for parameter in exercise.parameters]
    return "\n\n".join(tables) + "\n"


def _program(program: ProgramFile) -> dict[str, Any]:
    return {"file": program.file, "node": program.node, "class": program.class_name}


def _topic(topic: Topic) -> dict[str, Any]:
    elements = {"called": topic.elements.called, "named_by": topic.elements.named_by} if topic.elements else {}
    # The defaults of a queue depth alone are left out.
    reliability = "" if topic.reliability == "reliable" else topic.reliability
    durability = "" if topic.durability == "volatile" else topic.durability
    qos = {"depth": topic.depth, "reliability": reliability, "durability": durability}
    return {"topic": topic.name, "type": topic.type, **qos, "units": topic.units, "elements": elements}


def _endpoint(endpoint: ServiceOrAction) -> dict[str, Any]:
    return {"name": endpoint.name, "type": endpoint.type, "units": endpoint.units}


def _parameter(parameter: Parameter) -> dict[str, Any]:
    limits = list(parameter.range) if parameter.range else []
    return {
        "name": parameter.name,
        "type": parameter.type,
        "default": parameter.default,
        "unit": parameter.unit,
        "range": limits,
    }


def _table(kind: str, entries: dict[str, Any]) -> str:
    return f"[[{kind}]]\n{_lines(entries)}"


def _lines(entries: dict[str, Any]) -> str:
    """Return one line for each entry that has a value; 0 and false are values."""
    kept = {key: value for key, value in entries.items() if value is not None and value not in ({}, [], "")}
    return "\n".join(f"{key} = {_value(value)}" for key, value in kept.items())


def _number(value: float) -> float | int:
    return int(value) if value.is_integer() else value


def _value(value: Any) -> str:
    if isinstance(value, dict):
        return f"{{ {', '.join(f'{_key(key)} = {_value(item)}' for key, item in value.items())} }}"
    if isinstance(value, list):
        return f"[{', '.join(_value(item) for item in value)}]"
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, float):
        return repr(value)
    # A TOML basic string: JSON's escapes are among TOML's.
    return json.dumps(value, ensure_ascii=False)


def _key(key: str) -> str:
    return key if key.replace("_", "").isalnum() and key.isascii() else json.dumps(key)
