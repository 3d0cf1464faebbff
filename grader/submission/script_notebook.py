"""Reads the cells of a notebook that was saved as Python: by nbconvert, jupytext, Colab, or as marimo's own format.

Sources: nbconvert's PythonExporter, the formats `percent` and `light` of jupytext, what Colab downloads as .py, and
marimo's file format. Nothing of a submission is run.
"""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from itertools import takewhile

#: What only such a file has. A script with `# %%` alone is a script: Python runs it as it is.
SAVED_AS_PYTHON = re.compile(
    rb"^(?:[\w, \t]*=)?[ \t]*get_ipython\(\)\.|^# ?%%(?:node|part)[ \t]|^#%% md[ \t]*$"
    rb"|^import marimo\b(?s:.*)^app = marimo\.App\("
    rb"|^%%(?:node|part)[ \t](?s:.*)^%%(?:node|part)[ \t]",  # several cells in one file
    re.MULTILINE,
)

_BEGINS = re.compile(
    r"# In ?\[[\d ]*\]:\s*|# ?%%(?:[ \t].*)?|# ?\+(?: .*)?|# -|# Commented out IPython magic to ensure .*"
)
_IS_TEXT = re.compile(r"# ?%%(?: md\s*$|.*\[(?:markdown|md|raw)\])")
_IS_CODE = re.compile(r"(?:import|from|class|def) +\w")
_MAGIC = re.compile(r"(?:# ?)?%%\w")
_TEXT = r"""('(?:[^'\\]|\\.)*'|"(?:[^"\\]|\\.)*")"""
_CELL_CALL = re.compile(rf"get_ipython\(\)\.run_cell_magic\({_TEXT}, *{_TEXT}, *{_TEXT}\)\s*")
#: Longer lines (characters) are not searched for a command: the pattern would take too long.
_LONGEST = 500
_CALL = re.compile(r"(?P<before>[ \t]*(?:[\w, \t]+=)?)[ \t]*get_ipython\(\)\..*")


def cells_in(source: str) -> list[str]:
    """Return the code cells of a notebook that was saved as Python. Raises `Unreadable`."""
    if re.search(r"^app = marimo\.App\(", source, re.MULTILINE):
        return list(_of_marimo(source))
    return [_restored(lines) for lines in _pieces(source.split("\n")) if any(map(str.strip, lines))]


def _pieces(lines: list[str]) -> Iterator[list[str]]:
    """Yield the lines of each cell. A cell whose magic is a comment may be commented as a whole, without an end."""
    piece: list[str] = []
    skipped = False
    number = 0
    while number < len(lines):
        line = lines[number]
        number += 1
        if cell := _cell_call(line):
            yield from (piece, cell.split("\n"))
            piece = []
        elif _MAGIC.match(line):
            yield piece
            commented = list(takewhile(_continues, (lines[below] for below in range(number, len(lines)))))
            body = [re.sub(r"^# ?", "", one) for one in commented]
            skipped, piece = False, [line]
            if any(map(_IS_CODE.match, body)):
                yield [line, *body]
                number += len(commented)
                piece = []
        elif _BEGINS.fullmatch(line):
            yield piece
            skipped, piece = bool(_IS_TEXT.match(line)), []
        elif not skipped:
            piece.append(line)
    yield piece


def _continues(line: str) -> bool:
    """Return whether a line may belong to a cell that is commented as a whole."""
    return line.startswith("#") and not (_BEGINS.fullmatch(line) or _MAGIC.match(line))


def _cell_call(line: str) -> str:
    """Return the cell of `get_ipython().run_cell_magic('node', 'heartbeat', '…')`; "" for another line."""
    if not (match := _CELL_CALL.fullmatch(line)):
        return ""
    try:
        name, rest, body = map(ast.literal_eval, match.groups())
    except (ValueError, SyntaxError):  # a broken escape
        return ""
    return f"%%{name} {rest}\n{body}"


def _restored(lines: list[str]) -> str:
    """Return a cell as it was in the notebook; other commands of the notebook are left out."""
    if _MAGIC.match(lines[0]):
        lines = [lines[0].lstrip("# "), *lines[1:]]
    return "\n".join(_without_call(line) for line in lines)


def _without_call(line: str) -> str:
    if len(line) > _LONGEST or not (match := _CALL.fullmatch(line)):
        return line
    return f"{match['before']} None" if "=" in match["before"] else f"{match['before']}pass"


def _of_marimo(source: str) -> Iterator[str]:
    """Yield the bodies of marimo's cells, and the functions and classes that it keeps at the top."""
    from grader.submission.problems import Unreadable
    from grader.submission.unreadable import not_python

    try:
        if problem := not_python(source.encode(errors="replace")):
            raise Unreadable(problem)
        tree = ast.parse(source)
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        advice = "Open it in marimo, and save it again."
        raise Unreadable(f"It is a marimo notebook that can't be read as Python. {advice}") from None
    lines = source.split("\n")
    for one in tree.body:
        if isinstance(one, ast.FunctionDef | ast.AsyncFunctionDef | ast.ClassDef):
            if not any(_of_app(decorator) for decorator in one.decorator_list):
                continue
            is_cell = any(_of_app(decorator) == "cell" for decorator in one.decorator_list)
            body = [item for item in one.body if not isinstance(item, ast.Return)] if is_cell else [one]
        elif isinstance(one, ast.With) and any(_of_app(item.context_expr) == "setup" for item in one.items):
            body = one.body
        else:
            continue
        if body:
            text = "\n".join(lines[body[0].lineno - 1 : body[-1].end_lineno])
            yield text if body == [one] else re.sub(r"^ {1,4}", "", text, flags=re.MULTILINE)


def _of_app(node: ast.expr) -> str:
    """Return NAME of marimo's `app.NAME` or `app.NAME(…)`, otherwise ""."""
    node = node.func if isinstance(node, ast.Call) else node
    is_of_app = isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name) and node.value.id == "app"
    return node.attr if is_of_app and isinstance(node, ast.Attribute) else ""
