"""Assembles a program from a notebook's cells, as the kernel would run them."""

from __future__ import annotations

import ast
import shlex
from collections.abc import Collection, Iterable, Sequence
from dataclasses import dataclass

from grader.exercise.exercise import Exercise
from grader.recording.places import mark
from grader.submission import python_code
from grader.submission.notebook import NotebookCell

#: The code that starts the classes of `%%node NAME --class A`; `--main` calls the cell's `main` instead.
_SPIN = """

if __name__ == "__main__":
    import rclpy
    from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor

    rclpy.init()
    _executor = SingleThreadedExecutor()
    _nodes = [{made}]
    for _node in _nodes:
        _executor.add_node(_node)
    try:
        _executor.spin()
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    for _node in _nodes:
        _node.destroy_node()
    rclpy.try_shutdown()
"""
_MAIN = """

if __name__ == "__main__":
    main()
"""


@dataclass(frozen=True)
class AssembledProgram:
    """A program, and the numbers of the cells that it consists of."""

    code: str
    cells: tuple[int, ...]


@dataclass(frozen=True)
class _Options:
    """The options of `%%node NAME …`: what belongs to the program, and how it starts."""

    after: tuple[str, ...] = ()
    usual_imports: bool = False
    main: bool = False
    classes: tuple[str, ...] = ()


def assemble(
    cell: NotebookCell, cells: Sequence[NotebookCell], exercise: Exercise, others: Collection[int] = ()
) -> AssembledProgram:
    """Return the program of this cell, with what it needs from other cells, except those in `others`."""
    options = _options(cell)
    pieces = {cell.number: _split(cell, cells)}
    taken = {cell.number, *range(cell.number + 1, cell.number + len(pieces[cell.number]))}
    text = "".join(pieces[cell.number])
    before, used = _after(text, options, cell, cells)
    code = before + text
    more = _needed(code, cell, [one for one in cells if one.number not in taken | set(others)])
    if more:
        code = before + _in_order(cell, text, more)
    if options.usual_imports or options.after:
        code = _usual_imports(code, exercise) + code
    if code == text and len(taken) > 1:
        code = _marked(cell.number, 1, text)
    elif before and not more:
        code = before + _marked(cell.number, 1, text)
    if not python_code.starts(code):
        code += _start(options)
    return AssembledProgram(code, tuple(sorted({*taken, *used, *(one.number for one in more)})))


def is_complete(code: str) -> bool:
    """Return whether a program is valid Python, binds the names that it uses, and starts something."""
    return python_code.tree_of(code) is not None and python_code.starts(code) and not python_code.missing(code)


def joined(cells: Sequence[NotebookCell]) -> AssembledProgram:
    """Return the program whose parts are these cells, each below its own magic."""
    return AssembledProgram("".join(_marked(one.number, 1, one.code) for one in cells), tuple(c.number for c in cells))


def _options(cell: NotebookCell) -> _Options:
    if cell.magic.name != "node":
        return _Options()
    try:
        words = shlex.split(cell.magic.line)
    except ValueError:
        words = cell.magic.line.split()
    values: dict[str, list[str]] = {}
    option = ""
    for word in words[1:]:
        name, equals, value = word.partition("=") if word.startswith("--") else ("", "", word)
        option = name or option
        values.setdefault(option, []).extend([value] if equals or not name else [])
    return _Options(
        tuple(values.get("--after", ())),
        "--usual-imports" in values,
        "--main" in values,
        tuple(values.get("--class", ())),
    )


def _start(options: _Options) -> str:
    if options.classes:
        return _SPIN.format(made=", ".join(f"{name}()" for name in options.classes))
    return _MAIN if options.main else ""


def _split(cell: NotebookCell, cells: Sequence[NotebookCell]) -> list[str]:
    """Return the cell's code, and the code of the cells below that an editor split from it within a block."""
    parts = [cell.code.rstrip("\n")]  # a kernel drops the last line ends, too
    for one in cells:
        if one.number != cell.number + len(parts) or not one.is_plain or one.magic.name:
            continue
        first = next((line for line in one.source.split("\n") if line.strip()), "")
        whole = "".join([*parts, "\n", one.source])
        if first[:1] in (" ", "\t", ")", "]", "}") or python_code.tree_of("".join(parts)) is None:
            if python_code.tree_of(whole) is None and python_code.tree_of("".join(parts)) is not None:
                break
            parts.append("\n" + one.source.rstrip("\n"))
    if len(parts) > 1 and python_code.tree_of("".join(parts)) is not None:
        return parts
    return [cell.code]


def _after(code: str, options: _Options, cell: NotebookCell, cells: Sequence[NotebookCell]) -> tuple[str, set[int]]:
    """Return the code that `code` uses, even indirectly, from the cells that `--after` names, and their numbers."""
    named = [_named(name, cell, cells) for name in options.after]
    pieces = [one for one in named if one is not None]
    chosen: dict[tuple[int, int], ast.stmt] = {}
    todo = list(python_code.missing(code))
    seen = set(todo)
    while todo:
        name = todo.pop()
        for piece, statement in _binding(name, pieces):
            chosen[pieces.index(piece), statement.lineno] = statement
            new = python_code.missing(_text(piece, statement)) - seen
            seen |= new
            todo += new
    texts = [
        _marked(pieces[number].number, statement.lineno, _text(pieces[number], statement))
        for (number, _), statement in sorted(chosen.items(), key=lambda item: item[0])
    ]
    return "".join(texts), {pieces[number].number for number, _ in chosen}


def _named(name: str, cell: NotebookCell, cells: Sequence[NotebookCell]) -> NotebookCell | None:
    """Return the last cell above with this name, otherwise the last one below."""
    same = [one for one in cells if one.name == name and one.number != cell.number]
    above = [one for one in same if one.number < cell.number]
    return next(reversed(above or same), None)


def _binding(name: str, pieces: Sequence[NotebookCell]) -> list[tuple[NotebookCell, ast.stmt]]:
    for piece in reversed(pieces):
        tree = python_code.tree_of(piece.code)
        found = [one for one in tree.body if name in python_code.bound([one])] if tree else []
        if found:
            definitions = (ast.Import, ast.ImportFrom, ast.FunctionDef, ast.AsyncFunctionDef, ast.ClassDef)
            return [(piece, one) for one in (found[-1:] if isinstance(found[-1], definitions) else found)]
    return []


def _text(piece: NotebookCell, statement: ast.stmt) -> str:
    first = min([statement.lineno, *(item.lineno for item in getattr(statement, "decorator_list", []))])
    return "\n".join(piece.code.split("\n")[first - 1 : statement.end_lineno])


def _can_be_used(one: NotebookCell) -> bool:
    return (
        (one.is_plain or one.magic.name == "part")
        and not python_code.is_empty(one.code)
        and (python_code.tree_of(one.code) is not None)
    )


#: No person writes a notebook with more cells than this.
_MOST_CELLS = 1000


def _needed(code: str, cell: NotebookCell, cells: Sequence[NotebookCell]) -> list[NotebookCell]:
    """Return the ordinary cells that complete the program: those that it uses, and those that start it."""
    chosen: list[NotebookCell] = []
    is_whole = cell.magic.name and python_code.starts(code) and not python_code.missing(code)
    if is_whole or len(cells) > _MOST_CELLS:
        return []
    plain = [one for one in cells if _can_be_used(one)]
    while True:
        whole = "\n".join([code, *(one.code for one in chosen)])
        more = _definers(python_code.missing(whole), cell, [one for one in plain if one not in chosen])
        more = more or _starters(whole, cell, [one for one in plain if one not in chosen])
        if not more:
            return chosen
        chosen += more


def _definers(names: set[str], cell: NotebookCell, plain: Sequence[NotebookCell]) -> list[NotebookCell]:
    found = []
    for name in sorted(names):
        trees = [(one, python_code.tree_of(one.code)) for one in plain]
        binding = [one for one, tree in trees if tree and name in python_code.bound(tree.body)]
        above = [one for one in binding if one.number < cell.number]
        found += above[-1:] or binding[:1]
    return list(dict.fromkeys(found))


def _starters(whole: str, cell: NotebookCell, plain: Sequence[NotebookCell]) -> list[NotebookCell]:
    """Return the cells that use the program's definitions or set up rclpy, unless the program starts by itself."""
    if cell.magic.name and python_code.starts(whole):
        return []
    own = python_code.definitions(whole)
    return [one for one in plain if own & python_code.missing(one.code) or python_code.calls_module(one.code, "rclpy")]


def _in_order(cell: NotebookCell, text: str, more: Iterable[NotebookCell]) -> str:
    """Return all code in the notebook's order, but move up what another cell needs when it runs."""
    pieces = [(cell.number, text), *((one.number, one.code) for one in more)]
    pieces.sort()
    for number, code in list(pieces):
        needs = python_code.missing(code)
        for piece in [one for one in pieces if one[0] > number and needs & python_code.imports(one[1])]:
            pieces.remove(piece)
            pieces.insert(0, piece)
    return "".join(_marked(number, 1, code) for number, code in pieces)


def _marked(number: int, line: int, text: str) -> str:
    lines = text.split("\n")
    blank = next((index for index, one in enumerate(lines) if one.strip()), 0)
    code = "\n".join(lines[blank:]).rstrip("\n")
    return f"{mark(number, line + blank)}\n{code}\n"


def _usual_imports(code: str, exercise: Exercise) -> str:
    """Return usual imports that the code lacks: those that tutorials leave out, and the exercise's own types."""
    known = {"rclpy": "import rclpy", "Node": "from rclpy.node import Node", "np": "import numpy as np"}
    known |= {name: f"import {name}" for name in ("math", "time", "sys", "random", "threading")}
    types = [*(topic.type for topic in exercise.topics), *(endpoint.type for endpoint in exercise.endpoints)]
    for used in types:
        package, kind, name = used.split("/")
        known.setdefault(name, f"from {package}.{kind} import {name}")
    return "".join(f"{known[name]}\n" for name in sorted(python_code.missing(code)) if name in known)
