"""Finds callbacks of services and actions that can end without the answer that rclpy sends for them."""

from __future__ import annotations

import ast
from collections.abc import Iterator, Sequence

from spinbook.chapter.interface_fields import WrongField
from spinbook.chapter.syntax import last_name, syntax_tree
from spinbook.chapter.variable_types import Function, ProgramTypes, callback_argument, interface_argument

#: What registers a callback -> the part of the interface that the callback must return.
_ANSWERS = {"create_service": "Response", "ActionServer": "Result"}


def unanswered(program: str) -> list[WrongField]:
    """Return the callbacks of a program that can end without their answer; none if it is not Python."""
    try:
        types = ProgramTypes(syntax_tree(program))
    except (SyntaxError, ValueError, RecursionError):
        return []
    calls = ((item, function) for function in types.functions for item in function.own_nodes)
    return [
        wrong
        for call, function in calls
        if isinstance(call, ast.Call)
        for wrong in missing_answers(call, function, types)
    ]


def missing_answers(call: ast.Call, function: Function, types: ProgramTypes) -> Iterator[WrongField]:
    """Yield that a callback that a call registers can end without an answer, or returns something else."""
    part = _ANSWERS.get(last_name(call.func))
    callback = callback_argument(call) if part else None
    target = types.function_of(callback, function) if callback else None
    if part is None or target is None or not isinstance(target.node, ast.FunctionDef | ast.AsyncFunctionDef):
        return
    name, returns = target.node.name, [item for item in target.own_nodes if isinstance(item, ast.Return)]
    if target.node.decorator_list or any(isinstance(item, ast.Yield) for item in target.own_nodes):
        return
    empty = [item for item in returns if item.value is None or ast.unparse(item.value) == "None"]
    if empty or _falls_through(target.node.body):
        line = empty[0].lineno if empty else target.node.lineno
        yield WrongField(line, f"`{name}` can end without returning {_ASKED[part]}.", _fix(part, target, call))
    interface = interface_argument(call)
    of = types.class_of(interface, function) if interface else None
    for item in returns:
        value = types.value_of(item.value, target) if item.value else None
        is_other = value is not None and of is not None and (value.interface, value.part) != (of.interface, part)
        if item not in empty and (isinstance(item.value, ast.Constant) or is_other):
            problem = f"`{name}` returns `{ast.unparse(item)[7:]}`, which is not {_ASKED[part]}."
            yield WrongField(item.lineno, problem, _fix(part, target, call))


_ASKED = {"Response": "the service's response", "Result": "the action's result"}


def _fix(part: str, callback: Function, call: ast.Call) -> str:
    if part == "Result":
        interface = interface_argument(call)
        answer = f"{ast.unparse(interface)}.Result()" if interface else "a Result"
    else:
        answer = callback.arguments[1] if len(callback.arguments) > 1 else "response"
    return f"End each way through it with `return {answer}`: otherwise its caller gets no answer."


def _falls_through(statements: Sequence[ast.stmt]) -> bool:
    """Return whether statements can end at their last line, without `return` or `raise`."""
    last = statements[-1]
    if isinstance(last, ast.If):
        return _falls_through(last.body) or not last.orelse or _falls_through(last.orelse)
    if isinstance(last, ast.With | ast.AsyncWith):
        return _falls_through(last.body)
    if isinstance(last, ast.Try):
        ends = bool(last.finalbody) and not _falls_through(last.finalbody)
        branches = [last.orelse or last.body, *(handler.body for handler in last.handlers)]
        return not ends and any(map(_falls_through, branches))
    if isinstance(last, ast.Match):
        return ast.unparse(last.cases[-1].pattern) != "_" or any(_falls_through(case.body) for case in last.cases)
    is_endless = isinstance(last, ast.While) and isinstance(last.test, ast.Constant) and bool(last.test.value)
    return not (isinstance(last, ast.Return | ast.Raise) or is_endless)
