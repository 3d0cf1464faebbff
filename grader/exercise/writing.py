"""Writes a student's copy of an exercise.toml: without comments, and without what is for the instructor."""

from __future__ import annotations

import json
from typing import Any

from grader.exercise.exercise import Exercise
from grader.exercise.exercise_toml import DEADLINE, KEYS, read_toml


def to_toml(exercise: Exercise) -> str:
    """Return the text of an exercise.toml that reads as `exercise`; its packages have the versions of this machine."""
    entries = read_toml(exercise.folder / "exercise.toml")
    top = {key: value for key, value in entries.items() if key not in (*KEYS, DEADLINE, "packages")}
    top |= {"packages": list(exercise.packages)} if exercise.packages else {}
    tables = [f"[[{kind}]]\n{_lines(table)}" for kind in entries if kind in KEYS for table in entries[kind]]
    return "\n\n".join([_lines(top), *tables]) + "\n"


def _lines(entries: dict[str, Any]) -> str:
    return "\n".join(f"{key} = {_value(value)}" for key, value in entries.items())


def _value(value: Any) -> str:
    if isinstance(value, dict):
        return f"{{ {', '.join(f'{_key(key)} = {_value(item)}' for key, item in value.items())} }}"
    if isinstance(value, list):
        return f"[{', '.join(map(_value, value))}]"
    if isinstance(value, float):
        return repr(value)
    # JSON writes other values as TOML does: its escapes are among those of a TOML basic string.
    return json.dumps(value, ensure_ascii=False)


def _key(key: str) -> str:
    return key if key.replace("_", "").isalnum() and key.isascii() else json.dumps(key)
