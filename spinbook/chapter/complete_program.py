"""Completes a piece of a program with imports that tutorials leave out and with what earlier pieces define. The same
code is used when a chapter is read (is the piece then complete?) and when its cell runs (with the current code of the
cells above).
"""

from __future__ import annotations

import ast
import functools
import textwrap
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

from interface_compiler import prefixes
from spinbook.chapter.class_pieces import assembled
from spinbook.chapter.python_code import PythonCode, facts_of, inspect, is_main_guard
from spinbook.chapter.syntax import calls_in, descendants, parsed, syntax_tree

#: Module -> the names that ROS 2's own tutorials import from it.
_USUAL = {
    "rclpy.node": ("Node",),
    "rclpy.qos": [
        *("QoSProfile", "QoSReliabilityPolicy", "QoSDurabilityPolicy", "QoSHistoryPolicy", "ReliabilityPolicy"),
        *("DurabilityPolicy", "HistoryPolicy", "LivelinessPolicy"),
        *("qos_profile_sensor_data", "qos_profile_system_default", "QoSPresetProfiles"),
    ],
    "rclpy.executors": ("MultiThreadedExecutor", "SingleThreadedExecutor", "Executor", "ExternalShutdownException"),
    "rclpy.callback_groups": ("ReentrantCallbackGroup", "MutuallyExclusiveCallbackGroup"),
    "rclpy.action": ("ActionServer", "ActionClient", "GoalResponse", "CancelResponse"),
    "rclpy.action.server": ("ServerGoalHandle",),
    "rclpy.action.client": ("ClientGoalHandle",),
    "rclpy.clock": ("Clock", "ClockType", "ROSClock"),
    "rclpy.parameter": ("Parameter",),
    "rclpy.task": ("Future",),
    "rclpy.duration": ("Duration",),
    "rclpy.lifecycle": ("LifecycleNode", "TransitionCallbackReturn", "State"),
    "action_msgs.msg": ("GoalStatus",),
    "rcl_interfaces.msg": [
        *("ParameterDescriptor", "ParameterType", "ParameterValue", "ParameterEvent", "SetParametersResult"),
        *("FloatingPointRange", "IntegerRange"),
    ],
    "abc": ("ABC", "abstractmethod"),
    "typing": ("List", "Dict", "Optional", "Any", "Tuple", "Callable", "Union", "Set", "Type"),
    "dataclasses": ("dataclass", "field"),
    "enum": ("Enum", "IntEnum", "auto"),
    "functools": ("partial",),
    "threading": ("Thread", "Lock", "Event"),
    "datetime": ("datetime", "timedelta"),
    "collections": ("deque", "defaultdict"),
    "pathlib": ("Path",),
}
_MODULES = frozenset(
    {"rclpy", "math", "time", "sys", "os", "random", "json", "threading", "re", "queue", "asyncio", "subprocess"}
    | {"logging", "numpy", "inspect", "copy", "functools", "itertools", "traceback", "struct", "uuid", "csv"}
)
_ALIASES = {"np": "numpy", "plt": "matplotlib.pyplot"}
#: If several packages have a message of the same name, the first of these is meant.
_PREFERRED = ("std_msgs", "geometry_msgs", "sensor_msgs", "nav_msgs", "example_interfaces", "std_srvs", "turtlesim")


@dataclass(frozen=True)
class CompleteProgram:
    """A complete program. `before` is what was put above its code, `used` which pieces it needs, by number.

    `missing` are the names that nothing binds -> line of the code.
    """

    code: str
    before: str = ""
    used: tuple[int, ...] = ()
    missing: Mapping[str, int] | None = None
    amends: str = ""
    """The class of an earlier piece to which the code only adds methods."""
    has_main_above: bool = False
    """Whether `before` has the `main` of an earlier version, which the code goes without."""

    @property
    def whole(self) -> str:
        """The program as it runs."""
        return self.before + self.code


@dataclass(frozen=True)
class _CodePiece:
    """What a piece of Python binds at its top level: name -> the numbers of the statements that bind it."""

    source: str
    statements: tuple[ast.stmt, ...]
    bound: Mapping[str, tuple[int, ...]]
    blocks: bool

    def text(self, number: int) -> str:
        """Return the lines of a statement."""
        statement = self.statements[number]
        decorators = getattr(statement, "decorator_list", [])
        first = min([statement.lineno, *(item.lineno for item in decorators)])
        return "\n".join(self.source.split("\n")[first - 1 : statement.end_lineno])


def join(code: str, pieces: Sequence[str]) -> CompleteProgram:
    """Complete `code` with what it needs of earlier `pieces`, in their order, and with the usual imports.

    Raises CodeError if `code` is not Python.
    """
    groups = assembled(tuple(pieces))
    pieces = [text for _, text in groups]
    facts = inspect(code)
    needs = dict(facts.needs)
    amended, base = _amended(code, pieces)
    version, main = earlier_main(facts, pieces)
    needs |= dict.fromkeys((name for name in facts_of(main).needs if name not in facts.defines), 1)
    missing: dict[str, int] = {}
    taken: dict[int, set[int]] = {}
    imports: dict[str, None] = {}
    todo, seen = [*needs, *filter(None, [amended])], set(needs)
    while todo:
        name = todo.pop(0)
        binding = _binding(name, pieces)
        usual = usual_import(name)
        if binding is None or (usual and _is_import(binding, pieces, name)):
            if usual:
                imports[usual] = None
            else:
                missing[name] = needs.get(name, 1)
            continue
        number, statements = binding
        new = statements - taken.get(number, set())
        taken.setdefault(number, set()).update(new)
        text = "\n".join(_piece(pieces[number]).text(i) for i in sorted(new))
        more = [n for n in facts_of(text).needs if n not in seen]
        seen.update(more)
        todo += more
    before = _above(imports, taken, pieces) + (f"{main}\n\n\n" if main else "")
    if main:
        taken.setdefault(version, set())
    if amended:
        # The class below then extends the one above.
        before += f"{base} = {amended}\n\n\n"
    if code.lstrip().startswith("from __future__") and before:
        return CompleteProgram(code, missing=needs)
    used = sorted(number for group in taken for number in groups[group][0])
    return CompleteProgram(code, before, tuple(used), missing, amended, bool(main))


def _amended(code: str, pieces: Sequence[str]) -> tuple[str, str]:
    """Return (class, its base) of a class in `code` that only adds methods to an earlier one; otherwise ("", "")."""
    facts = inspect(code)
    for item in syntax_tree(code).body if facts.lacking or facts.nameless else ():
        if not isinstance(item, ast.ClassDef) or item.name not in facts.node_classes:
            continue
        binding = _binding(item.name, pieces)
        methods = {inner.name for inner in item.body if isinstance(inner, ast.FunctionDef)}
        if binding and "__init__" not in methods and isinstance(item.bases[0], ast.Name):
            text = "\n".join(_piece(pieces[binding[0]]).text(i) for i in binding[1])
            if all(name in text for name in facts.lacking):
                return item.name, item.bases[0].id
    return "", ""


def earlier_main(facts: PythonCode, pieces: Sequence[str]) -> tuple[int, str]:
    """Return (number of the piece, `main`) of the last whole program with a class that this code shows anew.

    The statements of a program without a `main` become one. "" if the code needs none, or there is none.
    """
    classes = set(facts.node_classes)
    if not classes or facts.is_complete or facts.calls_main:
        return 0, ""
    for number in range(len(pieces) - 1, -1, -1):
        piece = _piece(pieces[number])
        if classes & piece.bound.keys() and (main := _main_of(piece, classes)):
            return number, main
    return 0, ""


def _main_of(piece: _CodePiece, classes: set[str]) -> str:
    """Return a program's `main`, or the statements that it runs as one; "" if they do not use these classes."""
    if "main" in piece.bound:
        main = piece.statements[piece.bound["main"][-1]]
        return piece.text(piece.bound["main"][-1]) if _uses(main, classes) else ""
    for statement in piece.statements:
        if isinstance(statement, ast.If) and is_main_guard(statement) and _uses(statement, classes):
            first, last = statement.body[0].lineno, statement.body[-1].end_lineno
            body = textwrap.dedent("\n".join(piece.source.split("\n")[first - 1 : last]))
            return _as_main(body, statement.body)
        if _uses(statement, classes) and not isinstance(statement, _DEFINITIONS):
            rest = [i for i, item in enumerate(piece.statements) if not isinstance(item, _DEFINITIONS)]
            return _as_main("\n".join(piece.text(i) for i in rest), [piece.statements[i] for i in rest])
    return ""


_IMPORTS = (ast.Import, ast.ImportFrom)
_NAMED = (ast.ClassDef, ast.FunctionDef, ast.AsyncFunctionDef)
_DEFINITIONS = (*_NAMED, *_IMPORTS)


def _as_main(body: str, statements: Iterable[ast.stmt]) -> str:
    """Return statements of a module as a function; the names that they bind stay the module's."""
    names = sorted({name for statement in statements for name in _bound_by(statement)})
    body = f"global {', '.join(names)}\n{body}" if names else body
    return "def main():\n" + textwrap.indent(body, "    ")


def _uses(statement: ast.stmt, names: set[str]) -> bool:
    return any(isinstance(item, ast.Name) and item.id in names for item in descendants(statement))


def _above(imports: Iterable[str], taken: Mapping[int, set[int]], pieces: Sequence[str]) -> str:
    """Return the imports and statements that come above the code, imports first."""
    first, then = list(imports), list[str]()
    for number in sorted(taken):
        piece = _piece(pieces[number])
        for i in sorted(taken[number]):
            (first if isinstance(piece.statements[i], _IMPORTS) else then).append(piece.text(i))
    lines = [*dict.fromkeys(first), *(["", ""] if first and then else []), *then]
    return "\n".join(lines) + "\n\n\n" if lines else ""


def _binding(name: str, pieces: Sequence[str]) -> tuple[int, set[int]] | None:
    """Return the last piece that binds a name, and which of its statements are needed."""
    for number in range(len(pieces) - 1, -1, -1):
        piece = _piece(pieces[number])
        if name not in piece.bound:
            continue
        statements = piece.bound[name]
        if all(isinstance(piece.statements[i], _DEFINITIONS) for i in statements):
            return number, {statements[-1]}
        if all(_is_plain(piece.statements[i]) for i in statements):
            return number, set(statements)
        if piece.blocks:
            continue
        # A script that continues: all that it did so far.
        return number, {i for i, s in enumerate(piece.statements) if not is_main_guard(s)}
    return None


def _is_import(binding: tuple[int, set[int]], pieces: Sequence[str], name: str) -> bool:
    piece, statements = _piece(pieces[binding[0]]), binding[1]
    are_imports = all(isinstance(piece.statements[i], _IMPORTS) for i in statements)
    return are_imports and usual_import(name) in [piece.text(i) for i in statements]


def _is_plain(statement: ast.stmt) -> bool:
    """Return whether a statement only gives a name to a value, and calls nothing that has an effect."""
    if not isinstance(statement, ast.Assign | ast.AnnAssign) or statement.value is None:
        return False
    return all(ast.unparse(call.func)[:1].isupper() for call in calls_in(statement.value))


@functools.lru_cache(maxsize=512)
def _piece(source: str) -> _CodePiece:
    """Return what a piece binds; nothing, if it is not valid Python by itself."""
    facts, tree = facts_of(source), parsed(source)
    if facts.fragment or tree is None:
        return _CodePiece(source, (), {}, blocks=True)
    statements = tuple(tree.body)
    bound: dict[str, list[int]] = {}
    for number, statement in enumerate(statements):
        for name in _bound_by(statement):
            bound.setdefault(name, []).append(number)
    blocks = facts.loops or (facts.spins and any(_spins(s) for s in statements)) or facts.calls_main
    return _CodePiece(source, statements, {name: tuple(at) for name, at in bound.items()}, blocks)


def _spins(statement: ast.stmt) -> bool:
    calls = [] if isinstance(statement, _NAMED) else calls_in(statement)
    return any(isinstance(call.func, ast.Attribute) and call.func.attr == "spin" for call in calls)


def _bound_by(statement: ast.stmt) -> Iterable[str]:
    if is_main_guard(statement):
        return ()
    if isinstance(statement, _NAMED):
        return (statement.name,)
    if isinstance(statement, _IMPORTS):
        return tuple(alias.asname or alias.name.partition(".")[0] for alias in statement.names)
    return tuple(
        item.id for item in descendants(statement) if isinstance(item, ast.Name) and isinstance(item.ctx, ast.Store)
    )


@functools.cache
def usual_import(name: str) -> str:
    """Return the import of a name that ROS 2's tutorials use without importing it; "" for any other name."""
    if name in _MODULES:
        return f"import {name}"
    if name in _ALIASES:
        return f"import {_ALIASES[name]} as {name}"
    for module, names in _USUAL.items():
        if name in names:
            return f"from {module} import {name}"
    module = _interfaces().get(name, "")
    return f"from {module} import {name}" if module else ""


@functools.cache
def _interfaces() -> Mapping[str, str]:
    """Return a mapping of each message, service and action to the module that has it, for the packages that are
    installed.
    """
    modules: dict[str, str] = {}
    there = prefixes.packages(prefixes.installed())
    for package in sorted(set(_PREFERRED) & set(there), key=_PREFERRED.index):
        for interface in sorted(prefixes.interfaces_of(package, prefixes.installed())):
            kind, _, name = interface.partition("/")
            modules.setdefault(name, f"{package}.{kind}")
    return modules
