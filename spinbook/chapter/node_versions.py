"""Tells which nodes of a chapter are newer versions of earlier ones, and names those without a file name."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from dataclasses import dataclass, field

from spinbook.chapter.node_classes import snake_case
from spinbook.chapter.python_code import PythonCode, inspect
from spinbook.chapter.syntax import calls_in, last_name, syntax_tree

#: Calls that make an end of a topic, service or action -> where they have its name, and what fits the end.
_ENDS = {
    "create_publisher": (1, "create_subscription"),
    "create_subscription": (1, "create_publisher"),
    "create_service": (1, "create_client"),
    "create_client": (1, "create_service"),
    "ActionServer": (2, "ActionClient"),
    "ActionClient": (2, "ActionServer"),
}


@dataclass(frozen=True)
class _Version:
    name: str
    ros_name: str
    classes: frozenset[str]
    program: str


@dataclass
class NodeVersions:
    """The nodes of a chapter so far."""

    _shown: list[_Version] = field(default_factory=list)

    def add(self, name: str, code: PythonCode, program: str) -> None:
        """Add a node; `program` is its whole code."""
        self._shown.append(_Version(name, _ros_name(code, program), frozenset(code.node_classes), program))

    def of(self, code: PythonCode, program: str) -> str:
        """Return the name of the earlier node of which this is a newer version; "" if there is none.

        It has the same ROS name or, without one, a class of the same name, and does not talk to the earlier one.
        """
        for earlier in reversed(self._shown):
            if _is_same(earlier, code, _ros_name(code, program)) and not _talk(earlier.program, program):
                return earlier.name
        return ""

    def free_name(self, name: str, code: PythonCode) -> str:
        """Return a name that no other node has: this one, its class's, or one with a number."""
        taken = {item.name for item in self._shown}
        classes = [snake_case(item) for item in code.node_classes]
        names = [name, *classes, *(f"{(classes or [name])[0]}_{count}" for count in range(2, len(taken) + 3))]
        return next(item for item in names if item not in taken)


def _ros_name(code: PythonCode, program: str) -> str:
    """Return the ROS name that a node's code gives it, or the `main` above it."""
    return code.ros_name or inspect(program).ros_name or ""


def _is_same(earlier: _Version, code: PythonCode, ros_name: str) -> bool:
    if ros_name or earlier.ros_name:
        return ros_name == earlier.ros_name
    return bool(earlier.classes & set(code.node_classes))


def _talk(earlier: str, later: str) -> bool:
    """Return whether two programs have ends that fit: they are meant to run side by side."""
    ends = set(_ends_of(later))
    return any((_ENDS[kind][1], name) in ends for kind, name in _ends_of(earlier))


def _ends_of(program: str) -> Iterator[tuple[str, str]]:
    """Yield (call, name) for each topic, service and action that a program names literally."""
    for call in calls_in(syntax_tree(program)):
        place, _ = _ENDS.get(last_name(call.func), (0, ""))
        name = call.args[place] if place and len(call.args) > place else None
        if isinstance(name, ast.Constant) and isinstance(name.value, str):
            yield last_name(call.func), name.value.lstrip("/")
