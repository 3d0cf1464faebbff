"""What the editor of a page says before code runs: its errors, and the names that can follow."""

from __future__ import annotations

import ast
import re
import warnings
from collections.abc import Iterator
from typing import Any

from spinbook.chapter.interface_fields import InterfaceFields
from spinbook.chapter.node_classes import NODE_CLASSES
from spinbook.chapter.syntax import descendants, last_name, syntax_tree
from spinbook.chapter.variable_types import Function, ProgramTypes
from spinbook.chapter.wrong_fields import wrong_fields

#: Stands where the reader types.
_HERE = "_here_"
#: A line of a plain cell that is for the page, such as `%plot /a/b`.
_MAGIC = re.compile(r"^[%!]{1,2}\w.*$", re.MULTILINE)
_DOTTED = re.compile(r"[\w.\[\]()]*\.\w*$")


def problems(source: str) -> list[dict[str, Any]]:
    """Return a program's syntax error, or the fields that its messages do not have; lines from 1."""
    source = _MAGIC.sub("pass", source)
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            compile(source, "<editor>", "exec")
    except SyntaxError as error:
        return [_syntax_error(error)]
    except (ValueError, RecursionError, MemoryError) as error:
        return [{"line": 1, "text": str(error)}]
    wrong = [{"line": item.line, "text": f"{item.problem} {item.fix}"} for item in wrong_fields(source)]
    # The text changes with each key: its trees would only take memory.
    syntax_tree.cache_clear()
    descendants.cache_clear()
    return wrong


def _syntax_error(error: SyntaxError) -> dict[str, Any]:
    found: dict[str, Any] = {"line": error.lineno or 1, "text": f"{type(error).__name__}: {error.msg}"}
    if error.offset:
        found["from"] = error.offset - 1
        ends_there = error.end_lineno == error.lineno and error.end_offset
        found["to"] = max(error.offset, (error.end_offset or 0) - 1) if ends_there else None
    return found


def completions(source: str, at: int) -> list[dict[str, str]]:
    """Return the names that can be at this place, the innermost first, with what they are; none if unknown."""
    for text in _completed(source, at):
        try:
            tree = ast.parse(text)
        except (SyntaxError, ValueError, RecursionError):
            continue
        return [{"label": label, "detail": detail} for label, detail in _names(tree)]
    return []


def _completed(source: str, at: int) -> Iterator[str]:
    """Yield the program with a name where the reader types; the second time, with nothing else in that line."""
    start, end = source.rfind("\n", 0, at) + 1, (source.find("\n", at) + 1 or len(source) + 1) - 1
    head = re.sub(r"\w*$", "", source[start:at])
    yield source[:start] + head + _HERE + source[at:]
    if dotted := _DOTTED.search(source[start:at]):
        indentation = head[: len(head) - len(head.lstrip())]
        yield source[:start] + indentation + re.sub(r"\w*$", _HERE, dotted[0], count=1) + source[end:]


def _names(tree: ast.Module) -> Iterator[tuple[str, str]]:
    types = ProgramTypes(tree)
    for function in types.functions:
        for item in function.own_nodes:
            if isinstance(item, ast.Attribute) and item.attr == _HERE:
                yield from _after_dot(item.value, function, types, tree)
            elif isinstance(item, ast.Call) and any(last_name(argument) == _HERE for argument in item.args):
                made = types.class_of(item.func, function)
                yield from ((f"{name}=", kind) for name, kind in _fields(made.fields if made else None))


def _after_dot(value: ast.expr, function: Function, types: ProgramTypes, tree: ast.Module) -> Iterator[tuple[str, str]]:
    if message := types.value_of(value, function):
        yield from _fields(message.fields)
    elif made := types.class_of(value, function):
        yield from ((name, "constant") for name in sorted(made.fields.constants if made.fields else ()))
    elif last_name(value) == "self" and function.owner is not None:
        yield from _own_names(function.owner)
        if any(last_name(base) in NODE_CLASSES for base in function.owner.bases):
            from rclpy.node import Node

            yield from ((name, "Node") for name in dir(Node) if not name.startswith("_"))


def _own_names(owner: ast.ClassDef) -> Iterator[tuple[str, str]]:
    """Yield the attributes that a class sets, and its methods."""
    everything = list(ast.walk(owner))
    stored = (item for item in everything if isinstance(item, ast.Attribute) and isinstance(item.ctx, ast.Store))
    attributes = {item.attr for item in stored if last_name(item.value) == "self"}
    methods = {item.name for item in owner.body if isinstance(item, ast.FunctionDef) and not item.name.startswith("__")}
    yield from ((name, owner.name) for name in sorted(attributes | methods) if name != _HERE)


def _fields(known: InterfaceFields | None) -> Iterator[tuple[str, str]]:
    if known is not None:
        yield from ((name, str(kind)) for name, kind in known.fields.items())
