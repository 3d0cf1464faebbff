"""Which variables of a program hold messages, services and actions, as far as its text says for sure."""

from __future__ import annotations

import ast
import functools
import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace

from spinbook.chapter.bindings import attributes_of_self, bindings, is_self
from spinbook.chapter.interface_fields import PARTS, InterfaceFields, fields_of
from spinbook.chapter.syntax import descendants, dotted_name, keywords_of, last_name

_MODULE = re.compile(r"(\w+)\.(msg|srv|action)")
#: A package of interfaces, or one of its modules.
_INTERFACES = re.compile(r"_(msgs|srvs|interfaces|actions)\b|\.(msg|srv|action)$")
#: Where the interface is among the arguments of a call.
_PLACES = {"create_subscription": 0, "create_service": 0, "ActionServer": 1, "create_client": 0, "ActionClient": 1}
#: What makes a client -> the role of what it makes.
_CLIENTS = {"create_client": "client", "ActionClient": "action_client"}
_ANSWERS = frozenset({"call", "call_async", "result"})
_FUNCTIONS = (ast.FunctionDef, ast.AsyncFunctionDef, ast.Lambda)


@dataclass(frozen=True)
class TypedValue:
    """What an expression is: a `class`, a `value` of it, a `list` of values, or what rclpy makes of an action.

    `interface` is such as `std_msgs/msg/String`, `part` such as `Request`.
    """

    role: str
    interface: str
    part: str = ""

    @property
    def fields(self) -> InterfaceFields | None:
        """The fields of a message, or of a part of a service or action; None for anything else."""
        is_message = self.role in {"class", "value"} and (bool(self.part) or "/msg/" in self.interface)
        return fields_of(self.interface, self.part) if is_message else None


@dataclass(eq=False)
class Function:
    """A function, a lambda or the module itself, with what its names are bound to: None if that is not known."""

    node: ast.AST
    owner: ast.ClassDef | None = None
    parameters: dict[str, TypedValue | None] = field(default_factory=dict)
    bound: dict[str, list[ast.expr | None]] = field(default_factory=dict)

    @functools.cached_property
    def own_nodes(self) -> tuple[ast.AST, ...]:
        """The nodes of its body, without those of functions inside it."""
        nodes: list[ast.AST] = []
        todo = list(ast.iter_child_nodes(self.node))
        while todo:
            item = todo.pop()
            nodes.append(item)
            if not isinstance(item, _FUNCTIONS):
                todo += ast.iter_child_nodes(item)
        return tuple(nodes)

    @property
    def calls(self) -> list[ast.Call]:
        """The calls in its body."""
        return [item for item in self.own_nodes if isinstance(item, ast.Call)]

    @property
    def arguments(self) -> list[str]:
        """The names of its positional parameters, without `self`."""
        assert isinstance(self.node, _FUNCTIONS)
        names = [argument.arg for argument in self.node.args.args]
        return names[1:] if self.owner is not None and names[:1] == ["self"] else names


class ProgramTypes:
    """The types in one program."""

    def __init__(self, tree: ast.Module) -> None:
        self.functions: list[Function] = []
        self._busy: set[tuple[int, str]] = set()
        everything = descendants(tree)
        self._called = {last_name(item.func) for item in everything if isinstance(item, ast.Call)}
        self._module = self._add(tree, None)
        self._imported = _imported(everything)
        self._is_dotted = any("." in name for name in self._imported)
        self._attributes = attributes_of_self(everything)
        self._callbacks()

    def value_of(self, expression: ast.expr, function: Function) -> TypedValue | None:
        """Return the message that an expression is; None if it is something else, or not known."""
        return self._of_role("value", expression, function)

    def class_of(self, expression: ast.expr, function: Function) -> TypedValue | None:
        """Return the class that an expression is; None if it is something else, or not known."""
        return self._of_role("class", expression, function)

    def _of_role(self, role: str, expression: ast.expr, function: Function) -> TypedValue | None:
        kind = self._type(expression, function)
        return kind if kind is not None and kind.role == role else None

    def _add(self, node: ast.AST, owner: ast.ClassDef | None) -> Function:
        function = Function(node, owner)
        function.bound = bindings(function.own_nodes)
        self.functions.append(function)
        for inner in function.own_nodes:
            if isinstance(inner, ast.ClassDef):
                for method in inner.body:
                    if isinstance(method, _FUNCTIONS):
                        self._add(method, inner)
            elif isinstance(inner, _FUNCTIONS) and self._function_at(inner) is None:
                self._add(inner, owner)
        return function

    def _type(self, expression: ast.expr, function: Function) -> TypedValue | None:
        if isinstance(expression, ast.Name):
            return self._name(expression.id, function)
        if isinstance(expression, ast.Attribute):
            return self._attribute(expression, function)
        if isinstance(expression, ast.Call):
            return self._call(expression, function)
        if isinstance(expression, ast.Await):
            return _answer(self._type(expression.value, function), "result")
        if isinstance(expression, ast.Subscript) and not isinstance(expression.slice, ast.Slice):
            of = self._type(expression.value, function)
            return replace(of, role="value") if of is not None and of.role == "list" else None
        return None

    def _name(self, name: str, function: Function) -> TypedValue | None:
        if name in function.parameters and name not in function.bound:
            return function.parameters[name]
        if name in function.parameters or (function is not self._module and _is_parameter(name, function)):
            return None
        if name in function.bound:
            return self._same(function.bound[name], function, (id(function), name))
        if isinstance(function.node, ast.Lambda) or function is self._module or not self._is_local_elsewhere(name):
            known = self._module.bound.get(name)
            return self._imported.get(name) if known is None else None
        return None

    def _is_local_elsewhere(self, name: str) -> bool:
        """Return whether another function binds the name: the one meant may be around this one."""
        return any(name in item.bound or _is_parameter(name, item) for item in self.functions)

    def _same(self, values: Sequence[ast.expr | None], function: Function, key: tuple[int, str]) -> TypedValue | None:
        """Return the type that all these values have; None if they differ or are not known."""
        if key in self._busy:
            return None
        self._busy.add(key)
        kinds = {self._type(value, function) if value is not None else None for value in values}
        self._busy.discard(key)
        return kinds.pop() if len(kinds) == 1 else None

    def _attribute(self, item: ast.Attribute, function: Function) -> TypedValue | None:
        if self._is_dotted and (known := self._imported.get(dotted_name(item))) is not None:
            return known
        if is_self(item.value) and function.owner is not None:
            places = self._attributes.get((function.owner.name, item.attr))
            makers = [(value, self._function_at(node)) for value, node in places or ()]
            kinds = {self._type(value, maker) if value and maker else None for value, maker in makers}
            return kinds.pop() if len(kinds) == 1 else None
        base = self._type(item.value, function)
        return _part_of(base, item.attr) if base else None

    def _function_at(self, node: ast.AST) -> Function | None:
        return next((function for function in self.functions if function.node is node), None)

    def _call(self, call: ast.Call, function: Function) -> TypedValue | None:
        name = last_name(call.func)
        if name in _CLIENTS and (interface := interface_argument(call)) is not None:
            of = self.class_of(interface, function)
            return replace(of, role=_CLIENTS[name]) if of else None
        if name in _ANSWERS and isinstance(call.func, ast.Attribute):
            return _answer(self._type(call.func.value, function), name)
        return _instance(self.class_of(call.func, function))

    # --- callbacks

    def _callbacks(self) -> None:
        """Give the parameters of functions their annotations' types, or those that rclpy calls them with."""
        types_of: dict[int, list[list[TypedValue | None]]] = {}
        for function in list(self.functions):
            for call in function.calls:
                for callback, types in _registered(call, functools.partial(self._type, function=function)):
                    if isinstance(callback, ast.Call) and last_name(callback.func) == "partial" and callback.args:
                        types = [*([None] * (len(callback.args) - 1)), *types]
                        callback = callback.args[0]
                    target = self.function_of(callback, function)
                    if target is not None:
                        types_of.setdefault(id(target), []).append(types)
        for function in self.functions:
            if isinstance(function.node, _FUNCTIONS):
                self._annotate(function, types_of.get(id(function), []))

    def _annotate(self, function: Function, calls: list[list[TypedValue | None]]) -> None:
        assert isinstance(function.node, _FUNCTIONS)
        decorated = bool(getattr(function.node, "decorator_list", []))
        # A program that calls its callback itself may do so with something else.
        is_called = getattr(function.node, "name", "") in self._called
        same = len({tuple(types) for types in calls}) == 1 and not decorated and not is_called
        types = dict(zip(function.arguments, calls[0], strict=False)) if same else {}
        for argument in function.node.args.args:
            annotation = argument.annotation
            of = self.class_of(annotation, function) if isinstance(annotation, ast.Name | ast.Attribute) else None
            function.parameters[argument.arg] = _instance(of) or types.get(argument.arg)

    def function_of(self, callback: ast.expr, function: Function) -> Function | None:
        """Return the function that an expression names: `self.on_message`, `on_message`, or a lambda."""
        for item in self.functions:
            if item.node is callback:
                return item
            name = getattr(item.node, "name", "")
            if isinstance(callback, ast.Name) and item.owner is None and name == callback.id:
                return item
            is_own = isinstance(callback, ast.Attribute) and is_self(callback.value)
            if is_own and item.owner is not None and item.owner is function.owner and name == last_name(callback):
                return item
        return None


def _instance(of: TypedValue | None) -> TypedValue | None:
    """Return what calling a class makes; None if it is not the class of a message, or of a part."""
    return replace(of, role="value") if of and (of.part or "/msg/" in of.interface) else None


def _is_parameter(name: str, function: Function) -> bool:
    node = function.node
    if not isinstance(node, _FUNCTIONS):
        return False
    arguments = [*node.args.posonlyargs, *node.args.args, *node.args.kwonlyargs, node.args.vararg, node.args.kwarg]
    return any(argument is not None and argument.arg == name for argument in arguments)


def _part_of(base: TypedValue, name: str) -> TypedValue | None:
    """Return what an attribute of a known thing is."""
    if base.role == "class" and name in PARTS[base.interface.split("/")[1]] and not base.part:
        return replace(base, part=name)
    if (base.role, name) in {("goal_handle", "request"), ("feedback", "feedback")}:
        return TypedValue("value", base.interface, "Goal" if name == "request" else "Feedback")
    known = base.fields if base.role == "value" else None
    kind = known.fields.get(name) if known else None
    if kind is None or not kind.is_message:
        return None
    return TypedValue("list" if kind.is_list else "value", kind.base)


def _registered(
    call: ast.Call, type_of: Callable[[ast.expr], TypedValue | None]
) -> Iterator[tuple[ast.expr, list[TypedValue | None]]]:
    """Yield each callback that a call hands over, with the types of its parameters."""
    named, name = keywords_of(call), last_name(call.func)
    place = _PLACES.get(name) if name not in _CLIENTS else None
    if name == "send_goal_async" and isinstance(call.func, ast.Attribute):
        client = type_of(call.func.value)
        callback = named.get("feedback_callback", call.args[1] if len(call.args) > 1 else None)
        if client and client.role == "action_client" and callback:
            yield callback, [TypedValue("feedback", client.interface)]
    future = type_of(call.func.value) if isinstance(call.func, ast.Attribute) and call.args else None
    if name == "add_done_callback" and future and future.role == "future":
        yield call.args[0], [future]
    interface = interface_argument(call)
    if place is None or interface is None:
        return
    of = type_of(interface)
    callback = callback_argument(call)
    if of is None or of.role != "class":
        # A callback of this and of a known type gets neither.
        yield from [(callback, [])] if callback is not None else []
        return
    handle = TypedValue("goal_handle", of.interface)
    types: list[TypedValue | None] = [handle] if place else [replace(of, role="value")]
    if name == "create_service":
        types = [replace(of, role="value", part=part) for part in ("Request", "Response")]
    if callback is not None:
        yield callback, types
    others = {"goal_callback": replace(of, role="value", part="Goal"), "cancel_callback": handle}
    for key, kind in {**others, "handle_accepted_callback": handle}.items():
        if place and key in named:
            yield named[key], [kind]


def callback_argument(call: ast.Call) -> ast.expr | None:
    """Return the callback that a call registers for messages, requests or goals; None if it names none."""
    named = keywords_of(call)
    place = _PLACES[last_name(call.func)] + 2
    callback = named.get("callback", named.get("execute_callback"))
    return callback or (call.args[place] if len(call.args) > place else None)


def interface_argument(call: ast.Call) -> ast.expr | None:
    """Return the argument that says which message, service or action a call is about."""
    named = (k.value for k in call.keywords if k.arg in {"msg_type", "srv_type", "action_type"})
    place = _PLACES[last_name(call.func)] if last_name(call.func) in _PLACES else len(call.args)
    return call.args[place] if len(call.args) > place else next(named, None)


def _answer(of: TypedValue | None, method: str) -> TypedValue | None:
    """Return what a service's client answers: `call` a response, `call_async` its future, `result` of that the same."""
    if of is None or (of.role, method) not in {("client", "call"), ("client", "call_async"), ("future", "result")}:
        return None
    return replace(of, role="future" if method == "call_async" else "value", part="Response")


def _imported(everything: Sequence[ast.AST]) -> Mapping[str, TypedValue]:
    """Map names, also dotted ones, to the interfaces that a program imports; not those that it binds otherwise."""
    known: dict[str, TypedValue] = {}
    for item in everything:
        if isinstance(item, ast.ImportFrom) and item.module and (module := _MODULE.fullmatch(item.module)):
            for alias in item.names:
                interface = f"{module[1]}/{module[2]}/{alias.name}"
                known[alias.asname or alias.name] = TypedValue("class", interface)
    imports = [alias for item in everything if isinstance(item, ast.Import) for alias in item.names]
    modules = {alias.name for alias in imports}
    called = {alias.asname: alias.name for alias in imports if alias.asname}
    called |= {
        alias.asname or alias.name: f"{item.module}.{alias.name}"
        for item in everything
        if isinstance(item, ast.ImportFrom) and item.module
        for alias in item.names
        if alias.name in PARTS
    }
    modules |= set(called.values())
    for item in everything if any(map(_INTERFACES.search, modules)) else ():
        written = dotted_name(item) if isinstance(item, ast.Attribute) else ""
        first, _, rest = written.partition(".")
        dotted = f"{called.get(first, first)}.{rest}"
        package, _, rest = dotted.partition(".")
        kind, _, name = rest.partition(".")
        if {package, f"{package}.{kind}"} & modules and kind in PARTS and name.isidentifier():
            known[written] = TypedValue("class", f"{package}/{kind}/{name}")
    defined = {i.name for i in everything if isinstance(i, ast.ClassDef | ast.FunctionDef | ast.AsyncFunctionDef)}
    return {name: kind for name, kind in known.items() if name not in defined}
