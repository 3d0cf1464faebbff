"""What a program creates, according to its source: publishers, subscriptions, services, actions, parameters.

It reads only literal values: `"/full"`, a name that is assigned once, `QoSProfile(depth=1)`. A computed value is None,
because nothing can be said about it.
"""

from __future__ import annotations

import ast
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, cast

from grader.exercise.exercise import Durability, Qos, Reliability
from grader.exercise.imported_files import tree_of

#: For each call that creates something: what it creates, and the positions and keywords of type, name, and QoS or
#: default.
_CALLS: dict[str, tuple[str, tuple[tuple[int, str] | None, ...]]] = {
    "create_publisher": ("publish", ((0, "msg_type"), (1, "topic"), (2, "qos_profile"))),
    "create_subscription": ("subscribe", ((0, "msg_type"), (1, "topic"), (3, "qos_profile"))),
    "create_service": ("service", ((0, "srv_type"), (1, "srv_name"), None)),
    "create_client": ("client", ((0, "srv_type"), (1, "srv_name"), None)),
    "ActionServer": ("action", ((1, "action_type"), (2, "action_name"), None)),
    "ActionClient": ("action_client", ((1, "action_type"), (2, "action_name"), None)),
    "declare_parameter": ("parameter", (None, (0, "name"), (1, "value"))),
}

_RELIABILITIES = {"RELIABLE": "reliable", "BEST_EFFORT": "best_effort"}
_DURABILITIES = {"VOLATILE": "volatile", "TRANSIENT_LOCAL": "transient_local"}

#: The depth of `qos_profile_sensor_data`.
_SENSOR_DEPTH = 5


@dataclass(frozen=True)
class CreationCall:
    """One call that creates something, with its line, counted from 1.

    `kind` is "publish", "subscribe", "service", "client", "action", "action_client" or "parameter". `name` is the full
    name of a topic, such as `/full`, or the name of a parameter. `type` is written `package/msg/Name`, and for a
    parameter as in exercise.toml. `default` is a parameter's. Anything that the source does not say literally is None.
    """

    kind: str
    line: int
    name: str | None = None
    type: str | None = None
    qos: Qos | None = None
    default: Any = None


def created(source: str, node: str) -> tuple[CreationCall, ...]:
    """Return everything that a program creates, in the order of its lines. `node` is its node's name, for names with ~.

    A source that is not valid Python creates nothing.
    """
    return _Source(tree_of(source), node).created()


def texts(source: str) -> frozenset[str]:
    """Return every string in a program, except docstrings; empty if the program is not valid Python."""
    tree = tree_of(source)
    alone = {id(node.value) for node in ast.walk(tree) if isinstance(node, ast.Expr)}
    constants = [node for node in ast.walk(tree) if isinstance(node, ast.Constant) and id(node) not in alone]
    return frozenset(node.value for node in constants if isinstance(node.value, str))


class _Source:
    """A parsed program, with the meanings of its names."""

    def __init__(self, tree: ast.Module, node: str) -> None:
        self.tree = tree
        self.node = node
        self.imports = dict(_imports(tree))
        self.values = dict(_values(tree))
        keywords = {keyword.arg for keyword in ast.walk(tree) if isinstance(keyword, ast.keyword)}
        self.in_namespace = "namespace" in keywords

    def created(self) -> tuple[CreationCall, ...]:
        made = [self._created(call) for call in ast.walk(self.tree) if isinstance(call, ast.Call)]
        return tuple(sorted(filter(None, made), key=lambda call: call.line))

    def _created(self, call: ast.Call) -> CreationCall | None:
        kind, places = _CALLS.get(_called(call), ("", ()))
        if not kind:
            return None
        type_, name, last = (self._argument(call, place) for place in places)
        if kind == "parameter":
            return self._parameter(call.lineno, name, last)
        return CreationCall(kind, call.lineno, self._full_name(name), self._type(type_), self._qos(last))

    def _argument(self, call: ast.Call, place: tuple[int, str] | None) -> ast.expr | None:
        """Return the argument of a call at this place. A name that is assigned once is replaced by its value."""
        if place is None or any(isinstance(argument, ast.Starred) for argument in call.args):
            return None
        index, keyword = place
        argument = call.args[index] if index < len(call.args) else None
        argument = next((named.value for named in call.keywords if named.arg == keyword), argument)
        return self.values.get(argument.id, argument) if isinstance(argument, ast.Name) else argument

    def _parameter(self, line: int, name: ast.expr | None, default: ast.expr | None) -> CreationCall:
        value = _literal(default)
        type_ = _parameter_type(default, value)
        text = _literal(name)
        return CreationCall("parameter", line, text if isinstance(text, str) else None, type_, default=value)

    def _full_name(self, argument: ast.expr | None) -> str | None:
        """Return a topic's full name; None if it is not known, or if a namespace comes before it."""
        name = _literal(argument)
        if not isinstance(name, str) or name.startswith("/"):
            return name if isinstance(name, str) else None
        if self.in_namespace:
            return None
        return f"/{self.node}/{name[2:]}" if name.startswith("~/") else f"/{name}"

    def _type(self, argument: ast.expr | None) -> str | None:
        parts = _dotted(argument).split(".") if argument is not None else []
        if not parts or parts[0] not in self.imports:
            return None
        full = [*self.imports[parts[0]].split("."), *parts[1:]]
        return "/".join(full) if len(full) == 3 and full[1] in ("msg", "srv", "action") else None

    def _qos(self, argument: ast.expr | None) -> Qos | None:
        depth = _literal(argument)
        if type(depth) is int:
            return Qos(depth=depth)
        if argument is not None and _dotted(argument).endswith("qos_profile_sensor_data"):
            return Qos("best_effort", "volatile", _SENSOR_DEPTH)
        if isinstance(argument, ast.Call) and _called(argument) == "QoSProfile" and not argument.args:
            return _profile({keyword.arg or "": keyword.value for keyword in argument.keywords})
        return None


def _profile(settings: dict[str, ast.expr]) -> Qos | None:
    """Return the QoS of a profile with a depth and only settings that a task can ask for."""
    depth = _literal(settings.get("depth"))
    reliability = _policy(settings.get("reliability"), "RELIABLE", _RELIABILITIES)
    durability = _policy(settings.get("durability"), "VOLATILE", _DURABILITIES)
    if set(settings) - {"depth", "reliability", "durability"} or type(depth) is not int:
        return None
    if reliability is None or durability is None:
        return None
    return Qos(cast(Reliability, reliability), cast(Durability, durability), depth)


def _policy(argument: ast.expr | None, usual: str, words: dict[str, str]) -> str | None:
    """Return the policy in the words of exercise.toml; None if it has no word for it."""
    return words.get(_dotted(argument).rpartition(".")[2] if argument is not None else usual)


def _called(call: ast.Call) -> str:
    """Return the last name of a call's function: `create_publisher` for `self.create_publisher(…)`."""
    return _dotted(call.func).rpartition(".")[2]


def _dotted(node: ast.expr) -> str:
    """Return `a.b.c` as text; if it does not begin with a name, only the part after a dot."""
    if isinstance(node, ast.Attribute):
        return f"{_dotted(node.value)}.{node.attr}"
    return node.id if isinstance(node, ast.Name) else ""


def _literal(node: ast.expr | None) -> Any:
    """Return the value of a literal; None for everything else."""
    try:
        return ast.literal_eval(node) if node is not None else None
    except (ValueError, TypeError):
        return None


def _parameter_type(default: ast.expr | None, value: Any) -> str | None:
    """Return a parameter's type as exercise.toml writes it, from its default or from `Parameter.Type.DOUBLE`."""
    if isinstance(value, list) and value:
        kinds = {_parameter_type(None, element) for element in value}
        only = kinds.pop()
        return f"{only}_array" if only and not kinds else None
    if default is not None and "Type." in _dotted(default):
        return _dotted(default).rpartition(".")[2].lower()
    return {bool: "bool", int: "integer", float: "double", str: "string"}.get(type(value))


def _imports(tree: ast.Module) -> Iterator[tuple[str, str]]:
    """Yield each imported name with its dotted meaning: Bool -> std_msgs.msg.Bool."""
    for node in ast.walk(tree):
        if isinstance(node, ast.ImportFrom):
            yield from ((alias.asname or alias.name, f"{node.module}.{alias.name}") for alias in node.names)
        elif isinstance(node, ast.Import):
            for alias in node.names:
                root = alias.name.partition(".")[0]
                yield (alias.asname, alias.name) if alias.asname else (root, root)


def _values(tree: ast.Module) -> Iterator[tuple[str, ast.expr]]:
    """Yield the value of each name that is bound once in the whole program, and never changed in part."""
    bound = Counter(node.id for node in ast.walk(tree) if isinstance(node, ast.Name) and not _is_read(node))
    bound.update(node.arg for node in ast.walk(tree) if isinstance(node, ast.arg))
    changed = {_dotted(node.value) for node in ast.walk(tree) if isinstance(node, ast.Attribute) and not _is_read(node)}
    for node in ast.walk(tree):
        target = node.targets[0] if isinstance(node, ast.Assign) else None
        if isinstance(node, ast.Assign) and isinstance(target, ast.Name) and target.id not in changed:
            yield from [(target.id, node.value)] if bound[target.id] == 1 else []


def _is_read(node: ast.Name | ast.Attribute) -> bool:
    return isinstance(node.ctx, ast.Load)
