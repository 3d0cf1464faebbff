"""Finds callbacks of services, actions and parameters that can end without the answer that rclpy needs of them."""

from __future__ import annotations

import ast
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from spinbook.chapter.interface_fields import WrongField
from spinbook.chapter.syntax import keywords_of, last_name, parsed
from spinbook.chapter.variable_types import Function, ProgramTypes, TypedValue, callback_argument, interface_argument

#: Calls that register a callback whose answer rclpy needs.
_REGISTERING = frozenset({"create_service", "ActionServer", "add_on_set_parameters_callback"})


def unanswered(program: str) -> list[WrongField]:
    """Return the callbacks of a program that can end without their answer; none if it is not Python."""
    tree = parsed(program)
    if tree is None:
        return []
    types = ProgramTypes(tree)
    calls = ((call, function) for function in types.functions for call in function.calls)
    return [wrong for call, function in calls for wrong in missing_answers(call, function, types)]


def missing_answers(call: ast.Call, function: Function, types: ProgramTypes) -> Iterator[WrongField]:
    """Yield that a callback that a call registers can end without an answer, or returns something else."""
    for needed in _needed_answers(call):
        target = types.function_of(needed.callback, function)
        if target is not None and isinstance(target.node, ast.FunctionDef | ast.AsyncFunctionDef):
            yield from _without_answer(target, target.node, needed, types.class_of(needed.interface, function), types)


@dataclass(frozen=True)
class _NeededAnswer:
    """What rclpy wants from a callback: `words` and `answer` say it; `part` is that of the interface, "" if none."""

    callback: ast.expr
    words: str
    answer: str
    interface: ast.expr
    part: str = ""


def _needed_answers(call: ast.Call) -> Iterator[_NeededAnswer]:
    """Yield the callbacks in a call whose answer rclpy needs."""
    name = last_name(call.func)
    if name not in _REGISTERING:
        return
    interface = interface_argument(call) or call.func
    named = keywords_of(call)
    callback = callback_argument(call) if name in {"create_service", "ActionServer"} else None
    if callback and name == "create_service":
        yield _NeededAnswer(callback, "the service's response", "response", interface, "Response")
    elif callback:
        yield _NeededAnswer(callback, "the action's result", f"{ast.unparse(interface)}.Result()", interface, "Result")
    for key, kind in (("goal_callback", "GoalResponse"), ("cancel_callback", "CancelResponse")):
        if name == "ActionServer" and key in named:
            yield _NeededAnswer(named[key], f"a {kind}", f"{kind}.ACCEPT", interface)
    if name == "add_on_set_parameters_callback" and (first := [*call.args, *named.values()]):
        yield _NeededAnswer(first[0], "a SetParametersResult", "SetParametersResult(successful=True)", interface)


def _without_answer(
    callback: Function,
    node: ast.FunctionDef | ast.AsyncFunctionDef,
    needed: _NeededAnswer,
    of: TypedValue | None,
    types: ProgramTypes,
) -> Iterator[WrongField]:
    returns = [item for item in callback.own_nodes if isinstance(item, ast.Return)]
    if node.decorator_list or any(isinstance(item, ast.Yield) for item in callback.own_nodes):
        return
    answer = callback.arguments[1] if needed.part == "Response" and len(callback.arguments) > 1 else needed.answer
    fix = f"End each way through it with `return {answer}`: otherwise its caller gets no answer."
    empty = [item for item in returns if item.value is None or ast.unparse(item.value) == "None"]
    if empty or _falls_through(node.body):
        line = empty[0].lineno if empty else node.lineno
        yield WrongField(line, f"`{node.name}` can end without returning {needed.words}.", fix)
    for item in returns:
        value = types.value_of(item.value, callback) if item.value and needed.part else None
        is_other = value is not None and of is not None and (value.interface, value.part) != (of.interface, needed.part)
        if item not in empty and (isinstance(item.value, ast.Constant) or is_other):
            problem = f"`{node.name}` returns `{ast.unparse(item)[7:]}`, which is not {needed.words}."
            yield WrongField(item.lineno, problem, fix)


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
