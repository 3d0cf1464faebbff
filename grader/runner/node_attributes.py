"""Recognizes a program that replaces an attribute of rclpy's Node by one of its own with the same name."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator, Mapping
from typing import Any

from grader.runner.tracebacks import LastError

#: The attributes of a Node that a program can't replace, and what each one is (rclpy 7.1, `rclpy.node.Node`).
PUBLIC = {
    "handle": "the node's object in ROS's C library",
    "publishers": "the list of its publishers",
    "subscriptions": "the list of its subscriptions",
    "clients": "the list of its service clients",
    "services": "the list of its services",
    "timers": "the list of its timers",
    "guards": "the list of its guard conditions",
    "waitables": "the list of everything else that it waits for, such as action servers",
    "executor": "the executor that runs its callbacks",
    "context": "the context in which rclpy.init() was called",
    "default_callback_group": "the callback group of its callbacks",
}

#: Attributes that it can replace, and then the node stops working without any error.
PRIVATE = {
    **{f"_{name}": PUBLIC[name] for name in ("publishers", "subscriptions", "clients", "services", "timers")},
    "_parameters": "its parameters",
    "_context": "its context",
    "_clock": "its clock",
    "_logger": "its logger",
}

_CHOOSE = "Choose another name, such as `my_{name}`."


def advice_on_node_attribute(last: LastError, sources: Mapping[str, str]) -> str:
    """Return which attribute of Node the program replaces, if that is the cause of its last error; "" otherwise."""
    undeclared = "ParameterNotDeclared" in last.error
    if not undeclared and not last.error.startswith(("AttributeError", "TypeError")):
        return ""
    told = "_parameters" if undeclared else f"{last.error}\n{last.text}\n" + "\n".join(last.traceback.splitlines()[-3:])
    for name, meaning in {**PUBLIC, **PRIVATE}.items():
        if re.search(rf"\b{name}\b", told) and _is_replaced(name, sources):
            return f"Every Node already has an attribute `{name}`: {meaning}. {_CHOOSE.format(name=name.lstrip('_'))}"
    return ""


def silently_replaced(sources: Mapping[str, str]) -> str:
    """Return which attribute of Node a program replaces without any error, in two sentences; "" if none."""
    for name, meaning in PRIVATE.items():
        if name not in ("_clock", "_logger") and _is_replaced(name, sources):
            text = f"Your class sets self.{name}, in which rclpy's Node keeps {meaning}: the node loses them."
            return f"{text} {_CHOOSE.format(name=name.lstrip('_'))}"
    return ""


def _is_replaced(name: str, sources: Mapping[str, str]) -> bool:
    # Hardly any program has the name in it, and going through its syntax tree takes milliseconds.
    return any(name in source and name in _replaced(source) for source in sources.values())


def _replaced(source: str) -> Iterator[str]:
    """Yield the names that classes of a program define as methods or attributes, or set as `self.NAME`."""
    from grader.submission.python_code import tree_of  # it takes long, and few programs need it

    tree = tree_of(source)
    if tree is None:
        return
    for node in ast.walk(tree):
        if isinstance(node, ast.ClassDef):
            yield from (item.name for item in node.body if isinstance(item, (ast.FunctionDef, ast.AsyncFunctionDef)))
            yield from (target.id for item in node.body for target in _targets(item) if isinstance(target, ast.Name))
        for target in _targets(node):
            if isinstance(target, ast.Attribute) and isinstance(target.value, ast.Name) and target.value.id == "self":
                yield target.attr


def _targets(node: ast.AST) -> list[Any]:
    return node.targets if isinstance(node, ast.Assign) else [getattr(node, "target", None)]
