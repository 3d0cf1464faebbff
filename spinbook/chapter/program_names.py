"""Finds the node of a chapter that `ros2 run PACKAGE EXECUTABLE` means."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass

from groundwork.words import similar
from spinbook.chapter.classify import ClassifiedFence
from spinbook.chapter.node_classes import snake_case
from spinbook.chapter.own_packages import OwnPackages

#: Words that say nothing about which node it is.
_EMPTY_WORDS = frozenset({"", "node", "py", "ros2", "ros"})


@dataclass(frozen=True)
class ProgramNames:
    """The nodes of a chapter above a command, by their number among the fences, and the chapter's packages."""

    nodes: Mapping[int, ClassifiedFence]
    own: OwnPackages

    def started(self, package: str, executable: str) -> int | None:
        """Return the node that has exactly this name: by setup.py, its file, its ROS name or its class."""
        stem = executable.removesuffix(".py")
        module = self.own.executables.get((package, executable))
        for name in (module, stem):
            for number, item in reversed(list(self.nodes.items())):
                if name is not None and name == item.name:
                    return number
        for number, item in reversed(list(self.nodes.items())):
            if any(_words(name) == _words(stem) for name in _names(item)):
                return number
        unnamed = [number for number, item in self.nodes.items() if not item.named]
        is_own = package in self.own.names and module is not None
        return unnamed[-1] if is_own and len(unnamed) == 1 else None

    def similar(self, package: str, executable: str) -> int | None:
        """Return the only node whose name has one word more, or one word less, than the executable or its module."""
        called = {executable.removesuffix(".py"), self.own.executables.get((package, executable), executable)}
        is_own = package in self.own.names
        near = [
            number
            for number, item in self.nodes.items()
            if any(_differ_by_a_word(mine, name, is_own) for mine in called for name in _names(item))
        ]
        return near[0] if len(near) == 1 else None

    def close(self, executable: str) -> str:
        """Return the name that may have been meant: one spelled alike, or with half of its words; "" if none."""
        names = {name: item.name or name for item in self.nodes.values() for name in _names(item)}
        known = {name.lower(): name for name in names}
        mine = _words(executable)
        shared = [name for name in names if 2 * len(mine & _words(name)) >= max(len(mine), len(_words(name)))]
        best = known.get(similar(executable.lower(), known, 0.7)) or next(iter(shared), "")
        return names.get(best, "")


def _names(item: ClassifiedFence) -> list[str]:
    """Return what a node is called: its file, its ROS name, its classes in words."""
    code = item.code
    classes = map(snake_case, code.node_classes if code else ())
    return [name for name in (item.name, code.ros_name if code else "", *classes) if name]


def _words(name: str) -> frozenset[str]:
    words = frozenset(re.split(r"[\W_]+", name.lower())) - _EMPTY_WORDS
    return words or frozenset({name})


def _differ_by_a_word(first: str, second: str, is_own: bool) -> bool:
    """Return whether one name has one word more; in a package that the chapter does not make, two must be equal."""
    differing, common = _words(first) ^ _words(second), _words(first) & _words(second)
    return len(differing) == 1 and len(common) >= (1 if is_own else 2)
