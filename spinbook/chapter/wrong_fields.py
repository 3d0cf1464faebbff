"""Finds fields that messages do not have, values that fields can't hold, and callbacks without their answer, without
running a program.

It only judges what it is sure of: variables that always hold the same type, parameters with annotations, and parameters
of callbacks.
"""

from __future__ import annotations

import ast
from collections.abc import Iterator, Mapping

from groundwork.words import similar
from spinbook.chapter.callback_answers import missing_answers
from spinbook.chapter.interface_fields import FieldType, InterfaceFields, WrongField
from spinbook.chapter.syntax import descendants, parsed
from spinbook.chapter.variable_types import Function, ProgramTypes, TypedValue

#: What every message has besides its fields.
_ALWAYS = frozenset(dir(object)) | {"get_fields_and_field_types", "SLOT_TYPES"}
_IN_WORDS = {bool: "a bool", int: "an integer", float: "a float", str: "a string", bytes: "bytes"}
_IN_WORDS |= {list: "a list", tuple: "a tuple"}
#: No message lists more names than this.
_MANY = 20
_WHOLE = ("int8", "uint8", "int16", "uint16", "int32", "uint32", "int64", "uint64")


def wrong_fields(program: str) -> list[WrongField]:
    """Return what is wrong with the messages that a program makes, reads and answers; none if it is not Python."""
    tree = parsed(program)
    if tree is None or not any(mark in program for mark in ("_msgs", "_srvs", "_interfaces", ".msg")):
        return []
    try:
        if any(isinstance(i, ast.ExceptHandler) and "AttributeError" in ast.dump(i) for i in descendants(tree)):
            return []
        types = ProgramTypes(tree)
        wrong = {item for function in types.functions for item in _in_function(function, types)}
    except RecursionError:  # hundreds of attributes, calls or indices in a row, which nobody writes
        return []
    return sorted(wrong, key=lambda item: (item.line, item.problem))


def _in_function(function: Function, types: ProgramTypes) -> Iterator[WrongField]:
    for item in function.own_nodes:
        if isinstance(item, ast.Attribute):
            yield from _attribute(item, types.value_of(item.value, function))
            yield from _constant(item, types.class_of(item.value, function))
        elif isinstance(item, ast.Call):
            yield from _constructor(item, types.class_of(item.func, function))
            yield from missing_answers(item, function, types)
        elif isinstance(item, ast.Assign):
            for target in (target for target in item.targets if isinstance(target, ast.Attribute)):
                yield from _assignment(target, item.value, types.value_of(target.value, function))


def _attribute(item: ast.Attribute, value: TypedValue | None) -> Iterator[WrongField]:
    known = value.fields if value else None
    if known is None or item.attr in _ALWAYS or item.attr.startswith("_"):
        return
    if item.attr not in known.fields and item.attr not in known.constants:
        yield missing_field(item.attr, known, item.end_lineno or item.lineno)


def _constant(item: ast.Attribute, of: TypedValue | None) -> Iterator[WrongField]:
    known = of.fields if of else None
    if known is not None and item.attr.isupper() and item.attr not in known.constants:
        yield missing_field(item.attr, known, item.end_lineno or item.lineno)


def _constructor(call: ast.Call, made: TypedValue | None) -> Iterator[WrongField]:
    known = made.fields if made else None
    if known is None or any(keyword.arg == "check_fields" for keyword in call.keywords):
        return
    if call.args and not isinstance(call.args[0], ast.Starred):
        first = next(iter(known.fields), "field")
        fix = f"Name the field: {known.name.split('.')[-1]}({first}={ast.unparse(call.args[0])})"
        yield WrongField(call.lineno, f"`{known.name}` takes its fields by name only.", fix)
    for keyword in call.keywords:
        line = keyword.value.lineno
        if keyword.arg is not None and keyword.arg not in known.fields:
            yield missing_field(keyword.arg, known, line)
        elif keyword.arg is not None:
            yield from _value(keyword.arg, known.fields[keyword.arg], keyword.value, known.name, line)


def _assignment(target: ast.Attribute, value: ast.expr, of: TypedValue | None) -> Iterator[WrongField]:
    known = of.fields if of else None
    if known is not None and target.attr in known.fields:
        yield from _value(target.attr, known.fields[target.attr], value, known.name, target.lineno)


def missing_field(name: str, known: InterfaceFields, line: int) -> WrongField:
    """Return that a field or a constant does not exist, with the one that is probably meant."""
    is_constant = name.isupper() and bool(known.constants)
    kind, there = ("constant", sorted(known.constants)) if is_constant else ("field", list(known.fields))
    names = {each.lower(): each for each in (*known.constants, *known.fields)}
    # The only name that there is was meant, however it is spelled.
    close = similar(name.lower(), names, 0.5) or "".join(list(names) * (len(names) == 1))
    listed = ", ".join(f"`{each}`" for each in there[:_MANY]) + " …" * (len(there) > _MANY) or "none"
    fix = f"Did you mean `{names[close]}`? " if close else ""
    return WrongField(line, f"`{known.name}` has no {kind} `{name}`.", f"{fix}Its {kind}s: {listed}.")


def _value(name: str, kind: FieldType, value: ast.expr, owner: str, line: int) -> Iterator[WrongField]:
    """Check a literal value: rclpy does not, and sends another number for an integer in a float field.

    A time that is no message ends the program when it is published, without a traceback.
    """
    if kind.base == "builtin_interfaces/msg/Time" and ast.unparse(value).endswith("get_clock().now()"):
        problem = f"`{name}` of `{owner}` is a message, and `now()` is a time of rclpy, which can't be sent."
        yield WrongField(line, problem, f"Write `{ast.unparse(value)}.to_msg()`.")
    try:
        literal = ast.literal_eval(value)
    except (ValueError, TypeError, SyntaxError, MemoryError, RecursionError):
        return
    yield from wrong_literal(name, kind, literal, owner, line)


def wrong_literal(name: str, kind: FieldType, value: object, owner: str, line: int) -> Iterator[WrongField]:
    """Yield that a field can't hold a value, if so."""
    if type(value) not in _IN_WORDS:
        return
    if kind.is_list or kind.is_message:
        yield from _whole(name, kind, value, owner, line)
        return
    if type(value) in _allowed(kind.base):
        return
    problem = f"`{name}` of `{owner}` is {_article(kind.base)}, and this is {_IN_WORDS[type(value)]}, `{value!r}`."
    is_whole = type(value) is int and kind.base.startswith("float")
    fix = f"Write `{value}.0`: a whole number arrives as another one." if is_whole else f"Write {_article(kind.base)}."
    yield WrongField(line, problem, fix)


def _whole(name: str, kind: FieldType, value: object, owner: str, line: int) -> Iterator[WrongField]:
    """Yield that a list or a message field can't hold a value, if so."""
    if kind.is_list and type(value) in {list, tuple, bytes}:
        return
    class_name = kind.base.rpartition("/")[2]
    what = "a list" if kind.is_list else f"a {class_name}"
    shown = _IN_WORDS[type(value)]
    fix = f"Write `[{value!r}]`." if kind.is_list else f"Write `{class_name}(…)`, with the values in its fields."
    yield WrongField(line, f"`{name}` of `{owner}` is {what}, and this is {shown}, `{value!r}`.", fix)


def _allowed(base: str) -> tuple[type, ...]:
    kinds: Mapping[str, tuple[type, ...]] = {"string": (str,), "wstring": (str,), "bool": (bool,)}
    if base in _WHOLE:
        return (int, bool)
    return kinds.get(base, (float,) if base.startswith("float") else (int, bool, bytes, str, float))


def _article(base: str) -> str:
    return f"an {base}" if base.startswith("int") else f"a {base}"
