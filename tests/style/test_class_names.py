"""A class name stands for one thing in the whole tree: a reader who knows a name from one package knows it in all."""

from __future__ import annotations

import ast
import functools
from collections import defaultdict

from tree import ROOT

#: Folders whose classes are product code. Course code, templates and tests may use any names.
PRODUCT = ("grader", "spinbook", "packages")
NOT_PRODUCT = {"tests", "kinds", "template"}

#: Names that stand for several things, and why each may.
EXCEPTIONS: dict[str, str] = {
    "ActionServer": "rcl_python has the names of rclpy's C module; a scenario has servers by the names of ROS 2",
    "Context": "rcl_python has the names of rclpy's C module, launch files those of launch",
    "Node": "rcl_python has the names of rclpy's C module, launch files those of launch",
    "Message": "written by authors: a message that a check expects, and one that a scenario publishes",
}


def test_no_class_name_stands_for_two_things() -> None:
    places = _classes()
    twice = {name: files for name, files in places.items() if len(files) > 1 and name not in EXCEPTIONS}
    assert not twice, "rename one of each:\n" + "\n".join(
        f"{name}: {', '.join(files)}" for name, files in twice.items()
    )


def test_each_exception_is_needed() -> None:
    places = _classes()
    assert [name for name in EXCEPTIONS if len(places[name]) < 2] == []


@functools.cache
def _classes() -> dict[str, list[str]]:
    """Return the files in which each class name is defined, at the top of a module."""
    places: dict[str, list[str]] = defaultdict(list)
    for file in sorted(file for folder in PRODUCT for file in (ROOT / folder).rglob("*.py")):
        name = file.relative_to(ROOT)
        if NOT_PRODUCT.isdisjoint(name.parts):
            for node in ast.parse(file.read_text(encoding="utf-8")).body:
                if isinstance(node, ast.ClassDef):
                    places[node.name].append(str(name))
    return places
