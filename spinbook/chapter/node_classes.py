"""Facts about a Node class from its code: whether it can be created, and which attributes of `self` are never set."""

from __future__ import annotations

import ast
import contextlib
import functools
import importlib.util
import re
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

from spinbook.chapter.syntax import calls_in, descendants, dotted_name, last_name, syntax_tree

#: rclpy's classes of nodes.
NODE_CLASSES = frozenset({"Node", "LifecycleNode"})


def is_node(own: ast.ClassDef) -> bool:
    """Return whether a class derives from one of rclpy's nodes."""
    return any(last_name(base) in NODE_CLASSES for base in own.bases)


def methods_of(own: ast.ClassDef) -> dict[str, ast.FunctionDef]:
    """Return the methods of a class by their names."""
    return {item.name: item for item in own.body if isinstance(item, ast.FunctionDef)}


def ros_name(everything: Sequence[ast.AST], classes: Mapping[str, ast.ClassDef]) -> str | None:
    """Return the first name that code gives a node; None if it gives none.

    It is in `super().__init__('…')`, `Node('…')` or `create_node('…')`, as a text or a constant, or it is the argument
    of a constructor that passes it on: `Talker('…')`.
    """
    calls = [item for item in everything if isinstance(item, ast.Call)]
    texts = {
        target.id: item.value
        for item in everything
        if isinstance(item, ast.Assign) and isinstance(item.value, ast.Constant)
        for target in item.targets
        if isinstance(target, ast.Name)
    }
    names = (_text(name, texts) for name in map(_name_given, calls))
    return next(filter(None, names), None) or _name_passed_on(calls, classes, texts)


def _text(value: ast.expr | None, texts: Mapping[str, ast.expr]) -> str | None:
    value = texts.get(value.id) if isinstance(value, ast.Name) else value
    return value.value if isinstance(value, ast.Constant) and isinstance(value.value, str) else None


def _name_given(call: ast.Call) -> ast.expr | None:
    """Return what a call of Node's constructor, or of `create_node`, gives as the name."""
    function, owner = last_name(call.func), getattr(call.func, "value", None)
    arguments = call.args
    if function == "__init__" and isinstance(owner, ast.Name | ast.Attribute) and last_name(owner) in NODE_CLASSES:
        arguments = arguments[1:]
    elif not (function in {"Node", "create_node"} or (function == "__init__" and isinstance(owner, ast.Call))):
        return None
    return next(iter([*arguments[:1], *(k.value for k in call.keywords if k.arg == "node_name")]), None)


def _name_passed_on(
    calls: Sequence[ast.Call], classes: Mapping[str, ast.ClassDef], texts: Mapping[str, ast.expr]
) -> str | None:
    """Return the name that is an argument, or its default, of a constructor that passes it to Node's."""
    for name, own in classes.items():
        init = methods_of(own).get("__init__")
        names = map(_name_given, calls_in(init) if init else [])
        passed = next((value.id for value in names if isinstance(value, ast.Name)), "")
        if init is None or not passed:
            continue
        parameters = [parameter.arg for parameter in init.args.args]
        place = parameters.index(passed) - 1 if passed in parameters else -1
        values = [value for call in calls if last_name(call.func) == name for value in _argument(call, passed, place)]
        defaults = dict(zip(reversed(parameters), reversed(init.args.defaults), strict=False))
        if text := next(filter(None, (_text(value, texts) for value in [*values, defaults.get(passed)])), None):
            return text
    return None


def _argument(call: ast.Call, name: str, place: int) -> list[ast.expr]:
    named = [keyword.value for keyword in call.keywords if keyword.arg == name]
    return named or (call.args[place : place + 1] if place >= 0 else [])


def snake_case(name: str) -> str:
    """Return a class's name as a file's.

    >>> snake_case("LeftElbow")
    'left_elbow'
    """
    return re.sub(r"(?<!^)(?<![A-Z_])(?=[A-Z])", "_", name).lower()


def can_stand_alone(name: str, classes: Mapping[str, ast.ClassDef], everything: Sequence[ast.AST]) -> bool:
    """Return whether a Node class can be created without a main: nothing else creates it, and it needs no arguments."""
    own = classes[name]
    inside = set(descendants(own))
    used = any(isinstance(i, ast.Name) and i.id == name and i not in inside for i in everything)
    return not used and not needs_arguments(own)


def needs_arguments(own: ast.ClassDef) -> bool:
    """Return whether a class can't be created without arguments."""
    init = methods_of(own).get("__init__")
    return init is not None and takes_arguments(init)


def serves(own: ast.ClassDef) -> bool:
    """Return whether a class does something while it only spins: it has timers, subscriptions or servers."""
    return any(last_name(call.func) in _SERVING for call in calls_in(own))


_SERVING = frozenset({"create_timer", "create_subscription", "create_service", "ActionServer", "TransformListener"})


def takes_arguments(init: ast.FunctionDef) -> bool:
    """Return whether a method can't be called without arguments."""
    positional = len(init.args.args) - 1 - len(init.args.defaults)
    required = [a for a, d in zip(init.args.kwonlyargs, init.args.kw_defaults, strict=True) if d is None]
    return positional > 0 or bool(required)


def gives_no_name(own: ast.ClassDef) -> bool:
    """Return whether a class uses the constructor of rclpy's Node, which needs a name."""
    return "__init__" not in methods_of(own) and _is_only_node(own)


def _is_only_node(own: ast.ClassDef) -> bool:
    return len(own.bases) == 1 and is_node(own)


def attributes_lacking(
    everything: Sequence[ast.AST], names: list[str], classes: Mapping[str, ast.ClassDef]
) -> dict[str, int]:
    """Return the attributes of `self` that these classes read but neither the code nor rclpy's Node defines -> line."""
    known = node_attributes() if names else frozenset()
    if not known:
        return {}
    stored = {i.attr for i in everything if isinstance(i, ast.Attribute) and not isinstance(i.ctx, ast.Load)}
    if any(isinstance(i, ast.Call) and last_name(i.func) == "setattr" for i in everything):
        return {}
    lacking: dict[str, int] = {}
    for name in names:
        if all(last_name(base) in {*NODE_CLASSES, "object", "ABC"} for base in classes[name].bases):
            defined = known | stored | _bound(classes[name])
            for attribute, line in _read_of_self(classes[name]):
                if attribute not in defined:
                    lacking.setdefault(attribute, line)
    return lacking


def _bound(own: ast.ClassDef) -> set[str]:
    """Return the names of a class's methods and inner classes, and of all variables in it."""
    bound = {item.name for item in own.body if isinstance(item, ast.FunctionDef | ast.AsyncFunctionDef | ast.ClassDef)}
    for item in descendants(own):
        if isinstance(item, ast.Assign | ast.AnnAssign):
            targets = item.targets if isinstance(item, ast.Assign) else [item.target]
            bound |= {target.id for target in targets if isinstance(target, ast.Name)}
    return bound


def _read_of_self(own: ast.ClassDef) -> Iterator[tuple[str, int]]:
    for item in descendants(own):
        if isinstance(item, ast.Attribute) and isinstance(item.value, ast.Name) and item.value.id == "self":
            yield item.attr, item.lineno


def used_by_init(lacking: Mapping[str, int], names: list[str], classes: Mapping[str, ast.ClassDef]) -> str:
    """Return the first missing attribute that a class uses in `__init__` or in a method called there; "" if none."""
    for name in names:
        methods = methods_of(classes[name])
        used: set[str] = set()
        for method in _called_from("__init__", methods):
            used |= {i.attr for i in descendants(methods[method]) if isinstance(i, ast.Attribute)}
        if first := next((attribute for attribute in lacking if attribute in used), ""):
            return first
    return ""


def _called_from(start: str, methods: Mapping[str, ast.FunctionDef]) -> list[str]:
    """Return a method and the class's methods that its top-level statements call, directly or indirectly."""
    called = [start] if start in methods else []
    for name in called:
        for item in methods[name].body:
            call = getattr(item, "value", None)
            dotted = dotted_name(call.func) if isinstance(call, ast.Call) else ""
            owner, _, method = dotted.rpartition(".")
            if owner == "self" and method in methods and method not in called:
                called.append(method)
    return called


def never_initialized(names: Sequence[str], classes: Mapping[str, ast.ClassDef]) -> dict[str, int]:
    """Return the Node classes whose `__init__` does not call Node's, so that nothing in them works -> line."""
    inits = {name: methods_of(classes[name]).get("__init__") for name in names if _is_only_node(classes[name])}
    return {
        name: init.lineno
        for name, init in inits.items()
        if init and not any(isinstance(i, ast.Attribute) and i.attr == "__init__" for i in descendants(init))
    }


@functools.cache
def init_returns_nothing() -> bool:
    """Return whether rclpy is from before Kilted, whose `rclpy.init` can't be used with `with`; False without rclpy."""
    spec = importlib.util.find_spec("rclpy")
    text = Path(spec.origin).read_text(encoding="utf-8") if spec and spec.origin else "InitContextManager"
    return "InitContextManager" not in text


@functools.cache
def node_attributes() -> frozenset[str]:
    """Return the attributes of every rclpy Node, read from rclpy's source; empty if there is no rclpy."""
    try:
        spec = importlib.util.find_spec("rclpy")
    except (ImportError, ValueError):
        return frozenset()
    names: set[str] = set(dir(object))
    for folder in (spec.submodule_search_locations or []) if spec else []:
        for file in ("node.py", "lifecycle/node.py", "lifecycle/managed_entity.py"):
            with contextlib.suppress(OSError, SyntaxError):
                for item in descendants(syntax_tree(Path(folder, file).read_text(encoding="utf-8"))):
                    if isinstance(item, ast.FunctionDef | ast.AsyncFunctionDef):
                        names.add(item.name)
                    elif isinstance(item, ast.Attribute) and not isinstance(item.ctx, ast.Load):
                        names.add(item.attr)
    return frozenset(names) if len(names) > 60 else frozenset()
