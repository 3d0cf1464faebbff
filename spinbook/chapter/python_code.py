"""What a piece of Python is, read from its syntax tree and never by running it."""

from __future__ import annotations

import ast
import builtins
import re
import symtable
from collections.abc import Mapping
from dataclasses import dataclass, field

#: A line that is IPython's and not Python's: `%plot …`, `!ls`, `%%time`.
_MAGIC = re.compile(r"^(\s*)([%!].*)$")
_SPINS = frozenset({"spin", "spin_once", "spin_until_future_complete"})
_ALWAYS_THERE = frozenset(dir(builtins)) | {
    "__name__",
    "__file__",
    "__doc__",
    "display",
    "get_ipython",
    "In",
    "Out",
    "_",
}


class CodeError(Exception):
    """The code is not Python. `line` and `column` count from 1 within the code."""

    def __init__(self, message: str, line: int, column: int) -> None:
        super().__init__(message)
        self.message = message
        self.line = line
        self.column = column


@dataclass(frozen=True)
class PythonCode:
    """Facts about a piece of Python. Lines count from 1 within the code."""

    imports: Mapping[str, int] = field(default_factory=dict)
    """Dotted module -> line of its first import."""
    interfaces: Mapping[tuple[str, str], int] = field(default_factory=dict)
    """(module, name) of each `from module import name` -> line."""
    node_classes: tuple[str, ...] = ()
    """Classes whose base is rclpy's Node, in order."""
    ros_name: str | None = None
    """The first node name it gives, in `super().__init__('…')`, `Node('…')` or `create_node('…')`."""
    spins: bool = False
    has_main: bool = False
    has_main_guard: bool = False
    is_setup_script: bool = False
    is_launch_file: bool = False
    defines: frozenset[str] = frozenset()
    """Names that exist after it ran."""
    needs: Mapping[str, int] = field(default_factory=dict)
    """Names it uses at its top level, or in what runs from there, that neither it nor Python defines -> line."""
    fragment: str | None = None
    """Why it can't stand alone although each line is Python, if so."""

    @property
    def is_node(self) -> bool:
        """Whether it is a program of its own: it spins, or is a Node that can be spun."""
        return (self.spins or bool(self.node_classes)) and not (self.is_setup_script or self.is_launch_file)


def blank_magics(code: str) -> str:
    """The code with IPython's magic lines replaced by `pass`, each on its own line still."""
    return "\n".join(_MAGIC.sub(r"\1pass", line) for line in code.split("\n"))


def has_magics(code: str) -> bool:
    """Whether a line is one of IPython's (`%plot`, `!ls`)."""
    return any(_MAGIC.match(line) for line in code.split("\n"))


def inspect(code: str) -> PythonCode:
    """Read a piece of Python.

    Code that is indented as a whole, or that only makes sense inside a function, is a fragment.
    Raises CodeError where it isn't Python even so.
    """
    code = blank_magics(code) if has_magics(code) else code
    first = next((line for line in code.split("\n") if line.strip() and not line.lstrip().startswith("#")), "")
    indented = first[:1].isspace()
    # `if True:` keeps line numbers right for an indented fragment, at the cost of one line.
    tree = _parse("if True:\n" + code, shift=1) if indented else _parse(code)
    if indented:
        return PythonCode(fragment="it is indented, as a piece of a class or function is")
    outside = _only_inside_function(code)
    if outside:
        return PythonCode(fragment=outside)
    return _facts(tree, code)


def _parse(code: str, shift: int = 0) -> ast.Module:
    try:
        return ast.parse(code)
    except SyntaxError as error:
        raise CodeError(error.msg, max(1, (error.lineno or 1) - shift), error.offset or 1) from None
    except (ValueError, RecursionError, MemoryError) as error:
        raise CodeError(str(error) or type(error).__name__, 1, 1) from None


def _only_inside_function(code: str) -> str | None:
    try:
        compile(code, "<chapter>", "exec", flags=ast.PyCF_ALLOW_TOP_LEVEL_AWAIT, dont_inherit=True)
    except SyntaxError as error:
        return f"{error.msg} (line {error.lineno} of it)"
    return None


def _facts(tree: ast.Module, code: str) -> PythonCode:
    imports: dict[str, int] = {}
    interfaces: dict[tuple[str, str], int] = {}
    node_classes: list[str] = []
    ros_name: str | None = None
    spins = setup = launch = guard = False
    for item in ast.walk(tree):
        if isinstance(item, ast.Import):
            for alias in item.names:
                imports.setdefault(alias.name, item.lineno)
        elif isinstance(item, ast.ImportFrom) and item.module and not item.level:
            imports.setdefault(item.module, item.lineno)
            for alias in item.names:
                interfaces.setdefault((item.module, alias.name), item.lineno)
        elif isinstance(item, ast.ClassDef):
            if any(_last_name(base) in {"Node", "LifecycleNode"} for base in item.bases):
                node_classes.append(item.name)
        elif isinstance(item, ast.Call):
            name = _last_name(item.func)
            spins = spins or name in _SPINS
            setup = setup or (name == "setup" and _imports_setuptools(tree))
            ros_name = ros_name or _node_name(item, name)
        elif isinstance(item, ast.FunctionDef) and item.name == "generate_launch_description":
            launch = True
    for statement in tree.body:
        if isinstance(statement, ast.If) and "__main__" in ast.dump(statement.test):
            guard = True
    defines, needs = _names(tree, code)
    return PythonCode(
        imports=imports,
        interfaces=interfaces,
        node_classes=tuple(node_classes),
        ros_name=ros_name,
        spins=spins,
        has_main=any(isinstance(s, ast.FunctionDef) and s.name == "main" for s in tree.body),
        has_main_guard=guard,
        is_setup_script=setup,
        is_launch_file=launch,
        defines=defines,
        needs=needs,
    )


def _last_name(expression: ast.expr) -> str:
    if isinstance(expression, ast.Attribute):
        return expression.attr
    return expression.id if isinstance(expression, ast.Name) else ""


def _imports_setuptools(tree: ast.Module) -> bool:
    return any(
        (isinstance(s, ast.ImportFrom) and s.module in {"setuptools", "distutils.core"})
        or (isinstance(s, ast.Import) and any(a.name == "setuptools" for a in s.names))
        for s in tree.body
    )


def _node_name(call: ast.Call, function: str) -> str | None:
    is_super_init = (
        function == "__init__"
        and isinstance(call.func, ast.Attribute)
        and isinstance(call.func.value, ast.Call)
        and _last_name(call.func.value.func) == "super"
    )
    if not (is_super_init or function in {"Node", "create_node"}):
        return None
    given = [*call.args[:1], *(k.value for k in call.keywords if k.arg == "node_name")]
    first = given[0] if given else None
    return first.value if isinstance(first, ast.Constant) and isinstance(first.value, str) else None


def _names(tree: ast.Module, code: str) -> tuple[frozenset[str], dict[str, int]]:
    """The names that the code defines, and those it uses and does not define, by Python's own symbol table."""
    table = symtable.symtable(code, "<chapter>", "exec")
    defined = {s.get_name() for s in table.get_symbols() if s.is_assigned() or s.is_imported() or s.is_namespace()}
    used: set[str] = set()

    def collect(scope: symtable.SymbolTable) -> None:
        for symbol in scope.get_symbols():
            name = symbol.get_name()
            if scope is table:
                if symbol.is_referenced() and name not in defined:
                    used.add(name)
            elif symbol.is_global():
                if symbol.is_assigned():
                    defined.add(name)
                elif name not in defined:
                    used.add(name)
        for child in scope.get_children():
            collect(child)

    collect(table)
    missing = used - defined - _ALWAYS_THERE
    lines: dict[str, int] = {}
    for item in ast.walk(tree):
        if isinstance(item, ast.Name) and item.id in missing:
            lines[item.id] = min(item.lineno, lines.get(item.id, item.lineno))
    return frozenset(defined), {name: lines.get(name, 1) for name in sorted(missing)}
