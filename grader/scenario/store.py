"""Scenarios as plain data, for a student's copy of an exercise, and back."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import fields, is_dataclass
from pathlib import Path
from typing import Any

from grader.exercise.modules import HIDDEN_FILES
from grader.scenario import scenario, servers
from grader.scenario.code import AuthorCode
from grader.scenario.world import World, restored

#: The classes of which scenarios are made, by name.
_CLASSES: dict[str, Any] = {
    name: kind
    for module in (scenario, servers)
    for name, kind in vars(module).items()
    if isinstance(kind, type) and is_dataclass(kind)
}


class NotForStudents(ValueError):
    """Raised for a scenario that uses code from scenarios.py, which a student's copy does not have."""


def code_in(value: Any) -> Iterator[AuthorCode]:
    """Yield the author's code in a scenario, or in a part of one: a world's class, a server's function."""
    if isinstance(value, AuthorCode):
        yield from () if value.is_the_graders else (value,)
    elif isinstance(value, (list, tuple, dict)):
        for one in value.values() if isinstance(value, dict) else value:
            yield from code_in(one)
    elif is_dataclass(value):
        for entry in fields(value):
            yield from code_in(getattr(value, entry.name))


def plain(value: Any) -> Any:
    """Return a scenario, or a part of one, as dictionaries, lists, texts and numbers. Raises `NotForStudents`."""
    return scenario.entries_of(value, _for_students)


def _for_students(value: Any) -> Any:
    if not isinstance(value, AuthorCode):
        return value
    if Path(value.file).name in HIDDEN_FILES:
        raise NotForStudents(value.name)
    return value.for_students()


def from_plain(value: Any, folder: Path) -> Any:
    """Return the scenario that `plain` converted; the author's code is in `folder`. Raises KeyError or TypeError for
    other data, and OSError if a file is missing.
    """
    if isinstance(value, list):
        return tuple(from_plain(one, folder) for one in value)
    if not isinstance(value, dict) or "is" not in value:
        return value
    entries = {key: _entry(key, one, folder) for key, one in value.items() if key != "is"}
    if value["is"] == World.__name__:
        return restored(entries["code"], entries["period"], entries["arguments"], 0)
    if value["is"] == AuthorCode.__name__:
        return AuthorCode(**entries).in_folder(folder)
    return _CLASSES[value["is"]](**entries)


#: Entries with the fields of messages, in which lists stay lists.
_FIELDS = ("fields", "result", "parameters", "arguments", "value", "remappings")


def _entry(key: str, value: Any, folder: Path) -> Any:
    if key == "feedback":
        return tuple((after, fields_) for after, fields_ in value)
    if key == "arguments" and isinstance(value, list):
        return tuple(value)
    if key == "qos" and "is" not in value:
        return {name: from_plain(one, folder) for name, one in value.items()}
    return value if key in _FIELDS else from_plain(value, folder)
