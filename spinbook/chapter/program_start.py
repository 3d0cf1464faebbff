"""How a program starts and runs, which other programs it starts, and what it needs: read from its syntax tree."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator, Sequence

from spinbook.chapter.node_classes import is_node, methods_of
from spinbook.chapter.syntax import calls_in, descendants, dotted_name, last_name

#: Functions that start a program, under whatever name they are imported.
_STARTING = frozenset(
    [
        *("system", "popen", "Popen", "check_call", "check_output", "getoutput", "getstatusoutput", "startfile"),
        *("create_subprocess_exec", "create_subprocess_shell"),
    ]
)
_STARTING_FAMILIES = ("exec", "spawn", "posix_spawn")
#: Functions of `subprocess` with names that other modules use, too.
_OF_SUBPROCESS = frozenset({"run", "call"})


#: Calls that fail before `rclpy.init`.
_NEEDS_INIT = frozenset({"Node", "rclpy.node.Node", "rclpy.create_node", "rclpy.spin", "rclpy.spin_once"})
_NEEDS_INIT |= {"rclpy.spin_until_future_complete", "rclpy.shutdown"}
_EXECUTORS = frozenset({"SingleThreadedExecutor", "MultiThreadedExecutor"})
_SPINS = frozenset({"spin", "spin_once", "spin_until_future_complete"})
_ENDS = frozenset({"exit", "quit", "sys.exit", "os._exit"})
_READS_COMMAND_LINE = frozenset({"parse_args", "parse_known_args"})


def programs_started(everything: Sequence[ast.AST]) -> dict[str, int]:
    """Return the words of the commands that code runs -> line. Variables are followed to their values."""
    words: dict[str, int] = {}
    calls = [item for item in everything if isinstance(item, ast.Call)]
    of_subprocess = _names_of("subprocess", everything)
    for call in calls:
        if dotted_name(call.func) in {"shutil.rmtree", "rmtree"}:
            words.setdefault("rm", call.lineno)
        if _starts_a_program(call, of_subprocess):
            for word in _command_words(call, everything):
                words.setdefault(word.rsplit("/", 1)[-1], call.lineno)
    return words


def counts_words(item: ast.AST) -> bool:
    """Return whether code counts its command-line arguments, or catches that there are too few."""
    if isinstance(item, ast.Call):
        return last_name(item.func) == "len" and bool(item.args) and _is_argv(item.args[0])
    return isinstance(item, ast.ExceptHandler) and "IndexError" in (ast.unparse(item.type) if item.type else "")


def words_read(everything: Sequence[ast.AST]) -> int:
    """Return how many command-line arguments a program reads without checking that they exist."""
    if any(counts_words(item) for item in everything):
        return 0
    indexes = (item.slice for item in everything if isinstance(item, ast.Subscript) and _is_argv(item.value))
    indices = [index.value for index in indexes if isinstance(index, ast.Constant) and isinstance(index.value, int)]
    return max(indices, default=0)


def calls_main(statement: ast.stmt) -> bool:
    """Return whether a statement calls `main()`."""
    value = statement.value if isinstance(statement, ast.Expr) else None
    return isinstance(value, ast.Call) and isinstance(value.func, ast.Name) and value.func.id == "main"


def starts_ros(call: ast.Call) -> bool:
    """Return whether a call is one of `rclpy.init` or `rclpy.create_node`."""
    return dotted_name(call.func) in {"rclpy.init", "rclpy.create_node"}


def at_top(tree: ast.Module) -> list[ast.stmt]:
    """Return the statements that run when the code does, with those in `try`, `with` and `if`."""
    statements: list[ast.stmt] = []
    todo = list(tree.body)
    while todo:
        statement = todo.pop(0)
        statements.append(statement)
        if isinstance(statement, ast.Try | ast.With | ast.If):
            todo += statement.body
    return statements


def loops_forever(statement: ast.stmt) -> bool:
    """Return whether a statement is `while True`, `while rclpy.ok()`, or a server that never returns."""
    if isinstance(statement, ast.While):
        test = statement.test
        endless = isinstance(test, ast.Constant) and bool(test.value)
        leaves = any(isinstance(item, ast.Break | ast.Return) for item in descendants(statement))
        return (endless and not leaves) or ast.unparse(test).endswith("rclpy.ok()")
    value = statement.value if isinstance(statement, ast.Expr) else None
    return isinstance(value, ast.Call) and last_name(value.func) in {"serve_forever", "run_forever", "mainloop"}


def with_init(everything: Sequence[ast.AST]) -> int:
    """Return the line of `with rclpy.init():`, which ROS 2 has since Kilted; 0 if there is none."""
    items = (item.context_expr for with_ in everything if isinstance(with_, ast.With) for item in with_.items)
    calls = (item for item in items if isinstance(item, ast.Call))
    return next((call.lineno for call in calls if dotted_name(call.func) == "rclpy.init"), 0)


def only_defines(statement: ast.stmt) -> bool:
    """Return whether a statement is an import, a definition, a constant or a text, so that running it shows nothing."""
    if isinstance(statement, ast.Expr | ast.Assign | ast.AnnAssign):
        return not any(isinstance(item, ast.Call) for item in descendants(statement))
    kinds = ast.Import | ast.ImportFrom | ast.FunctionDef | ast.AsyncFunctionDef | ast.ClassDef | ast.Pass
    return isinstance(statement, kinds)


def wants_ros(tree: ast.Module) -> int:
    """Return the first line on which code outside classes makes a node, spins one or shuts ROS down, and so needs
    `rclpy.init` before it; 0 if there is none."""
    names = _NEEDS_INIT
    if spins(tree):
        names |= _EXECUTORS | {item.name for item in tree.body if isinstance(item, ast.ClassDef) and is_node(item)}
    calls = [call for item in tree.body if not isinstance(item, ast.ClassDef) for call in calls_in(item)]
    return min((call.lineno for call in calls if dotted_name(call.func) in names), default=0)


def spins(tree: ast.Module) -> bool:
    """Return whether a program spins by itself: outside classes, or in a method of a class that it uses."""
    outside = [item for item in tree.body if not isinstance(item, ast.ClassDef)]
    if any(map(_calls_spin, outside)):
        return True
    for own in (item for item in tree.body if isinstance(item, ast.ClassDef)):
        others = (item for statement in tree.body if statement is not own for item in descendants(statement))
        if _calls_spin(own) and any(isinstance(item, ast.Name) and item.id == own.name for item in others):
            return True
    return False


def spinning_methods(own: ast.ClassDef) -> list[ast.FunctionDef]:
    """Return the public methods of a class that spin or loop without end, also in others that they call, and that the
    class itself does not use.
    """
    methods = methods_of(own)
    uses = {
        name: {i.attr for i in descendants(method) if isinstance(i, ast.Attribute)} for name, method in methods.items()
    }
    spin = {name for name, method in methods.items() if _calls_spin(method) or _loops_inside(method)}
    for _ in methods:
        spin |= {name for name in methods if uses[name] & spin}
    used = set().union(*uses.values())
    return [method for name, method in methods.items() if name in spin - used and not name.startswith("_")]


def _loops_inside(method: ast.FunctionDef) -> bool:
    return any(isinstance(item, ast.While) and loops_forever(item) for item in descendants(method))


def _calls_spin(statement: ast.stmt) -> bool:
    return any(last_name(call.func) in _SPINS for call in calls_in(statement))


def leaves(tree: ast.Module) -> str:
    """Return how the code's top level would end a notebook's kernel or read its command line; "" if it would not."""
    for statement in tree.body:
        if isinstance(statement, ast.FunctionDef | ast.AsyncFunctionDef | ast.ClassDef | ast.If):
            continue
        for call in calls_in(statement):
            if dotted_name(call.func) in _ENDS:
                return "it ends its program"
            own_words = [a for a in call.args if "argv" not in ast.unparse(a)]
            if last_name(call.func) in _READS_COMMAND_LINE and not own_words:
                return "it reads its command line"
    return ""


def _starts_a_program(call: ast.Call, of_subprocess: frozenset[str]) -> bool:
    name, dotted = last_name(call.func), dotted_name(call.func)
    owner = dotted.rpartition(".")[0]
    if name in _STARTING or (name.startswith(_STARTING_FAMILIES) and owner in {"os", "pty"}):
        return True
    return dotted in of_subprocess or (name in _OF_SUBPROCESS and owner in of_subprocess)


def _names_of(module: str, everything: Sequence[ast.AST]) -> frozenset[str]:
    """Return the names that code uses for a module, and those that it imports from it."""
    names = {module}
    for item in everything:
        if isinstance(item, ast.Import):
            names |= {alias.asname or alias.name for alias in item.names if alias.name == module}
        elif isinstance(item, ast.ImportFrom) and item.module == module:
            names |= {alias.asname or alias.name for alias in item.names}
    return frozenset(names)


def _command_words(call: ast.Call, everything: Sequence[ast.AST]) -> Iterator[str]:
    """Yield the words in a call's arguments, and in the values of the variables among them."""
    inside = [item for value in [*call.args, *(k.value for k in call.keywords)] for item in descendants(value)]
    names = {item.id for item in inside if isinstance(item, ast.Name)}
    for item in everything:
        if isinstance(item, ast.Assign | ast.AnnAssign | ast.AugAssign) and item.value is not None:
            targets = item.targets if isinstance(item, ast.Assign) else [item.target]
            if any(isinstance(target, ast.Name) and target.id in names for target in targets):
                inside += descendants(item.value)
    texts = [item.value for item in inside if isinstance(item, ast.Constant) and isinstance(item.value, str)]
    before = ""
    for word in (part for text in texts for part in re.split(r"[\s;&|`()]+", text)):
        # The word in `ros2 service` is not the program `service`.
        if before != "ros2":
            yield word
        before = word


def _is_argv(value: ast.expr) -> bool:
    return dotted_name(value) in {"sys.argv", "argv"}
