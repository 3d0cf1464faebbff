"""Facts about a piece of Python, read from its syntax tree, never by running it."""

from __future__ import annotations

import ast
import builtins
import functools
import re
import symtable
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from spinbook.chapter.class_pieces import methods_alone, names_begun, uses_super_outside
from spinbook.chapter.imported_names import imported, imports_launch, modules_imported
from spinbook.chapter.node_classes import (
    attributes_lacking,
    can_stand_alone,
    gives_no_name,
    is_node,
    never_initialized,
    ros_name,
    serves,
    takes_arguments,
    used_by_init,
)
from spinbook.chapter.program_start import (
    at_top,
    calls_main,
    counts_words,
    leaves,
    loops_forever,
    only_defines,
    programs_started,
    spinning_methods,
    spins,
    starts_ros,
    wants_ros,
    with_init,
    words_read,
)
from spinbook.chapter.syntax import calls_in, descendants, last_name, parsed, syntax_tree

#: A line of IPython's own syntax: `%plot …`, `!ls`, `%%time`, `files = !ls`, `Node?`.
_MAGIC = re.compile(
    r"^(?P<indent>\s*)(?P<names>[\w, ]+= *)?(?P<command>(?:%%?[A-Za-z]|!).*|\?{1,2}[\w.]+|[\w.]+\?{1,2})$"
)
#: What a setup.py imports, and what it writes under console_scripts.
_SETUP = frozenset({"setuptools", "distutils.core"})
_ENTRY_POINT = re.compile(r"[\w.-]+\s*=\s*[\w.]+:\w+")
_ALWAYS_THERE = frozenset(dir(builtins)) | {"__name__", "__file__", "__doc__"}
_ALWAYS_THERE |= {"display", "get_ipython", "In", "Out", "_"}


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
    """The first node name it gives, as a text, a constant or a constructor's argument."""
    spins: bool = False
    """Whether it spins a node by itself, not only in methods of a class that it does not use."""
    has_main: bool = False
    has_main_guard: bool = False
    is_setup_script: bool = False
    is_launch_file: bool = False
    defines: frozenset[str] = frozenset()
    """Names that exist after it ran."""
    needs: Mapping[str, int] = field(default_factory=dict)
    """Names it uses but neither it nor Python defines -> line."""
    fragment: str | None = None
    """Why it can't run alone although each line is valid Python, if so."""
    relative_imports: Mapping[str, int] = field(default_factory=dict)
    """`.module` of each `from .module import name` -> line."""
    calls_main: bool = False
    """Whether its top level calls `main()` outside a guard."""
    starts_ros: bool = False
    """Whether it calls rclpy.init or makes a node."""
    loops: bool = False
    """Whether its top level loops without end."""
    programs: Mapping[str, int] = field(default_factory=dict)
    """Programs that it starts through os.system, subprocess or `!…` -> line."""
    asks: int = 0
    """The line on which it waits for keyboard input; 0 if it does not."""
    alone: tuple[str, ...] = ()
    """The Node classes that nothing in the code makes or derives from, and that need no arguments."""
    called: str = ""
    """`Class.method` of a lone class whose method spins, needs no arguments, and is called by nothing."""
    uncalled: str = ""
    """The same of a method that needs arguments, or of several; the class by itself does nothing."""
    nameless: tuple[str, ...] = ()
    """Those of `alone` that can't be created: without an `__init__` they give the node no name."""
    lacking: Mapping[str, int] = field(default_factory=dict)
    """Attributes of `self` that a Node class uses but nothing sets -> line."""
    fails_at_once: str = ""
    """The first of those that `__init__` uses itself."""
    never_initialized: Mapping[str, int] = field(default_factory=dict)
    """Node classes whose `__init__` does not call Node's -> line."""
    wants_ros: int = 0
    """The first line that needs `rclpy.init` to be called before it; 0 if there is none."""
    initializes: bool = False
    """Whether it calls `rclpy.init`, however it is imported."""
    leaves: str = ""
    """How it would end a notebook's kernel, or read the kernel's command line."""
    with_init: int = 0
    """The line of `with rclpy.init():`; 0 if there is none."""
    only_defines: bool = False
    """Whether its top level only imports and defines."""
    counts_words: bool = False
    """Whether it counts its command-line arguments, or catches that there are too few."""
    words_read: int = 0
    """How many command-line arguments it reads without checking that they exist."""

    @property
    def is_node(self) -> bool:
        """Whether it is a complete program: it calls `rclpy.spin`, or defines a Node that can be run."""
        starts = self.starts_ros and self.wants_ros > 0
        is_program = self.spins or starts or self.loops or bool(self.node_classes)
        return is_program and not (self.is_setup_script or self.is_launch_file)

    @property
    def does_nothing(self) -> bool:
        """Whether running it only defines functions and classes, none of which ROS or Spinbook would run."""
        return self.only_defines and not (self.has_main or self.node_classes)

    @property
    def own_classes(self) -> list[str]:
        """The names of its classes, those of nodes first."""
        imported = {name for _, name in self.interfaces}
        others = sorted(name for name in self.defines - imported if name[:1].isupper() and not name.isupper())
        return list(dict.fromkeys([*self.node_classes, *others]))

    @property
    def runs_main(self) -> bool:
        """Whether it has a `main` that its own code does not call, as for `ros2 run`."""
        return self.has_main and not self.has_main_guard and not self.calls_main

    @property
    def is_complete(self) -> bool:
        """Whether it is a program that starts by itself or by its `main`."""
        return self.has_main or self.has_main_guard or self.spins or self.loops


def blank_magics(code: str) -> str:
    """Return the code with IPython's magic lines replaced by `pass` or None, each on its own line still."""
    return "\n".join(_MAGIC.sub(_blank, line) for line in code.split("\n"))


def _blank(magic: re.Match[str]) -> str:
    names = magic["names"]
    blank = f"{names}{', '.join(['None'] * (names.count(',') + 1))}" if names else "pass"
    return f"{magic['indent']}{blank}"


def has_magics(code: str) -> bool:
    """Return whether a line is one of IPython's (`%plot`, `!ls`), and not of a text or an expression of Python's."""
    return any(_MAGIC.match(line) for line in code.split("\n")) and parsed(code) is None


def programs_in_magics(code: str) -> dict[str, int]:
    """Return the programs that a snippet starts with `!program` or `%program` -> line."""
    programs: dict[str, int] = {}
    for number, line in enumerate(code.split("\n"), start=1):
        if match := _MAGIC.match(line):
            for word in re.split(r"[\s;&|!%]+", match["command"]):
                programs.setdefault(word.rsplit("/", 1)[-1], number)
    return programs


def facts_of(code: str) -> PythonCode:
    """Return the facts about a piece of Python; those about nothing if it isn't Python."""
    try:
        return inspect(code)
    except CodeError as error:
        return PythonCode(fragment=f"it is not Python: {error.message}")


@functools.lru_cache(maxsize=4096)
def inspect(code: str) -> PythonCode:
    """Read a piece of Python.

    Code that is indented as a whole, or that only makes sense inside a function, is a fragment.
    Raises CodeError if it isn't Python even so.
    """
    code = blank_magics(code) if has_magics(code) else code
    first = next((line for line in code.split("\n") if line.strip() and not line.lstrip().startswith("#")), "")
    indented = first[:1].isspace()
    # `if True:` keeps line numbers right for an indented fragment, at the cost of one line.
    try:
        tree = _parse("if True:\n" + code, shift=1) if indented else _parse(code)
    except CodeError:
        if names := names_begun(code):
            return PythonCode(fragment="it ends where a block begins", defines=names)
        raise
    if indented:
        return PythonCode(fragment="it is indented, as a piece of a class or function is")
    if methods := methods_alone(tree):
        return PythonCode(fragment="it is a piece of a class", defines=methods)
    if uses_super_outside(tree):
        return PythonCode(fragment="`super()` is used outside a class")
    if outside := _only_inside_function(tree):
        return PythonCode(fragment=outside)
    return _facts(tree, code)


def _parse(code: str, shift: int = 0) -> ast.Module:
    try:
        return syntax_tree(code)
    except SyntaxError as error:
        raise CodeError(error.msg, max(1, (error.lineno or 1) - shift), error.offset or 1) from None
    except (ValueError, RecursionError, MemoryError) as error:
        raise CodeError(str(error) or type(error).__name__, 1, 1) from None


def _only_inside_function(tree: ast.Module) -> str | None:
    try:
        compile(tree, "<chapter>", "exec", flags=ast.PyCF_ALLOW_TOP_LEVEL_AWAIT, dont_inherit=True)
    except SyntaxError as error:
        return f"{error.msg} (line {error.lineno} of it)"
    return None


def _facts(tree: ast.Module, code: str) -> PythonCode:
    everything = descendants(tree)
    calls = calls_in(tree)
    called = {last_name(call.func) for call in calls}
    defines, needs = _names(everything, code)
    classes = {item.name: item for item in everything if isinstance(item, ast.ClassDef)}
    functions = {item.name for item in everything if isinstance(item, ast.FunctionDef)}
    node_classes = [item.name for item in everything if isinstance(item, ast.ClassDef) and is_node(item)]
    lacking = attributes_lacking(everything, node_classes, classes)
    alone = tuple(name for name in node_classes if can_stand_alone(name, classes, everything))
    method, uncalled = _methods_to_call(alone, classes)
    return PythonCode(
        **imported(everything),
        node_classes=tuple(node_classes),
        ros_name=ros_name(everything, classes),
        spins=spins(tree),
        has_main="main" in {item.name for item in tree.body if isinstance(item, ast.FunctionDef)},
        has_main_guard=any(map(is_main_guard, tree.body)),
        is_setup_script=("setup" in called and bool(_SETUP & modules_imported(tree)))
        or any(map(_is_entry_point, everything)),
        is_launch_file="generate_launch_description" in functions or imports_launch(tree),
        defines=defines,
        needs=needs,
        calls_main=any(map(calls_main, tree.body)),
        starts_ros=any(map(starts_ros, calls)),
        loops=any(map(loops_forever, at_top(tree))),
        programs=programs_started(everything),
        with_init=with_init(everything),
        only_defines=all(map(only_defines, tree.body)),
        counts_words=any(map(counts_words, everything)),
        words_read=words_read(everything),
        wants_ros=wants_ros(tree),
        initializes="init" in called,
        leaves=leaves(tree),
        asks=next((call.lineno for call in calls if isinstance(call.func, ast.Name) and call.func.id == "input"), 0),
        alone=alone,
        called=method,
        uncalled=uncalled,
        nameless=tuple(name for name in alone if gives_no_name(classes[name])),
        lacking=lacking,
        fails_at_once=used_by_init(lacking, node_classes, classes),
        never_initialized=never_initialized(node_classes, classes),
    )


def _methods_to_call(alone: Sequence[str], classes: Mapping[str, ast.ClassDef]) -> tuple[str, str]:
    """Return (`called`, `uncalled`) of code with these classes."""
    name = alone[0] if len(alone) == 1 else ""
    spinning = spinning_methods(classes[name]) if name else []
    free = [method for method in spinning if not takes_arguments(method)]
    if len(free) == 1:
        return f"{name}.{free[0].name}", ""
    return "", f"{name}.{spinning[0].name}" if spinning and not serves(classes[name]) else ""


def is_main_guard(statement: ast.stmt) -> bool:
    """Return whether a statement is `if __name__ == "__main__":`."""
    return isinstance(statement, ast.If) and "__main__" in ast.dump(statement.test)


def _is_entry_point(item: ast.AST) -> bool:
    text = item.value if isinstance(item, ast.Constant) else None
    return isinstance(text, str) and bool(_ENTRY_POINT.fullmatch(text.strip()))


def _names(everything: Sequence[ast.AST], code: str) -> tuple[frozenset[str], dict[str, int]]:
    """Return the names that the code defines, and those it uses and does not define, by Python's own symbol table."""
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
    if any(isinstance(i, ast.ImportFrom) and any(a.name == "*" for a in i.names) for i in everything):
        missing = set()
    lines: dict[str, int] = {}
    for item in everything:
        if isinstance(item, ast.Name) and item.id in missing:
            lines[item.id] = min(item.lineno, lines.get(item.id, item.lineno))
    return frozenset(defined), {name: lines.get(name, 1) for name in sorted(missing)}
