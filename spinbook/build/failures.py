"""What went wrong when a notebook ran, by the chapter's file and line: cells, and the nodes that they started."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from spinbook.kernel.cell_output import NEVER_APPEARED, in_short
from spinbook.kernel.node_errors import AS_EXPECTED, ERROR

_ANSI = re.compile(r"\x1b\[[0-9;]*m")
#: A traceback's line in a module that a node cell wrote, or in a snippet's cell.
_IN_MODULE = r'File "[^"]*\b{module}\.py", line (\d+)\b(?! above)'
_IN_CELL = re.compile(r"Cell In\[\d+\], line (\d+)|^File <[^>]*>:(\d+)|-+> (\d+) ", re.MULTILINE)
_LOG_LINES = (8, 12)


@dataclass(frozen=True)
class CellFailure:
    """One cell that failed. `line` is the chapter's line, as near to the fault as is known; `log` is the output."""

    chapter: Path
    line: int
    what: str
    log: str

    def __str__(self) -> str:
        text = f"{self.chapter}:{self.line}: {self.what}"
        return text + "".join(f"\n    | {line}" for line in self.log.splitlines())


def find_failures(chapter: Path, ran: dict[str, Any], ended: dict[str, Any]) -> list[CellFailure]:
    """Return the failures of one run. If the run was interrupted in a cell, the outputs of that cell in `ran` say so.
    `ended` is what the run's process reported about its end: {"finished": …}, {"timed_out": INDEX}, {"died": INDEX} or
    {"crashed": words}; `ran` is the notebook with the outputs that were written.
    """
    cells = ran["cells"]
    failures = list(_failed_cells(chapter, cells))
    if "timed_out" in ended or "died" in ended:
        # Prose does not run: the next code cell was the one that did.
        first = min(ended.get("timed_out", ended.get("died", 0)), len(cells) - 1)
        cell = next((cell for cell in cells[first:] if cell["cell_type"] == "code"), cells[first])
        event = (
            "the notebook's time limit passed in this cell" if "timed_out" in ended else "the kernel died in this cell"
        )
        note = f"{event}; it and its nodes were ended, and the cells below did not run."
        failures.append(CellFailure(chapter, _line(cell), note, _printed(cell)))
        if cell["cell_type"] == "code":
            cell["outputs"].append({"output_type": "stream", "name": "stderr", "text": f"{note.capitalize()}\n"})
    elif "crashed" in ended:
        words = in_short(ended["crashed"], *_LOG_LINES)
        failures.append(
            CellFailure(chapter, 1, "the notebook could not be run (this is not the chapter's fault).", words)
        )
    return failures


def find_warnings(chapter: Path, ran: dict[str, Any]) -> list[CellFailure]:
    """Find the cells that waited in vain for a text (`until=`): their outputs do not show what the chapter says."""
    warnings = []
    for cell in _code_cells(ran):
        if never := NEVER_APPEARED.search(_printed(cell)):
            message = f"`until` failed: {never[1]} was not printed within {never[2]} s. Correct it, or raise `seconds`."
            warnings.append(CellFailure(chapter, _line(cell), message, ""))
    return warnings


def find_node_errors(chapter: Path, ran: dict[str, Any]) -> list[CellFailure]:
    """Find what went wrong in nodes, also after their cells, and the cells that expected an error that did not come."""
    cells = _code_cells(ran)
    reported = [(cell, about) for cell in cells for about in node_errors(cell)]
    errors = _each_once(_node_error(chapter, cells, cell, about) for cell, about in reported if not about["meant"])
    meant = [about["node"] for _, about in reported if about["meant"]]
    for cell in cells:
        if _about(cell).get("expects_error") and not _had_error(cell, meant):
            message = "this cell says `expect-error`, but nothing went wrong in what it started. Remove the word."
            errors.append(CellFailure(chapter, _line(cell), message, ""))
    return errors


def _each_once(errors: Iterable[CellFailure]) -> list[CellFailure]:
    """Return the errors; one that a node repeats, such as a line that it logs each second, is there once."""
    first: dict[tuple[int, str], CellFailure] = {}
    for error in errors:
        first.setdefault((error.line, error.what), error)
    return list(first.values())


def node_errors(cell: Mapping[str, Any]) -> list[dict[str, Any]]:
    """Return the errors of nodes that a cell's outputs report (see kernel/node_errors.py), each with its words."""
    shown = [output for output in cell.get("outputs", []) if ERROR in output.get("metadata", {})]
    return [{**output["metadata"][ERROR], "words": "".join(output["data"]["text/plain"])} for output in shown]


def _node_error(
    chapter: Path, cells: list[dict[str, Any]], shown_in: dict[str, Any], about: dict[str, Any]
) -> CellFailure:
    before = cells[: cells.index(shown_in) + 1]
    module, node = about["file"].removesuffix(".py"), about["node"]
    made = next((cell for cell in reversed(before) if _is_of(cell, module, node)), shown_in)
    # A node's cell begins with its magic, a snippet's perhaps with imports that the chapter does not show.
    above = 1 if _about(made).get("node") else _about(made).get("above", 0)
    line = _line(made) + max(about["line"] - 1 - above, 0)
    quoted = "\n".join(row.removeprefix("    | ") for row in about["words"].split("\n")[1:])
    return CellFailure(chapter, line, f"{about['node']} went wrong: {about['what']}", quoted)


def _is_of(cell: dict[str, Any], module: str, node: str) -> bool:
    """Return whether a cell is where an error happened: in its module, in the cell itself, or in a node it starts."""
    return (
        module in {_about(cell).get("node"), f"Cell In[{cell.get('execution_count')}]"}
        if module
        else _starts(cell, node)
    )


def _starts(cell: dict[str, Any], node: str) -> bool:
    """Return whether a cell starts a node of this name: by its code, by `ros2 run`, or by `ros2 launch`."""
    commands = re.findall(r"^%ros2 .*\b(?:run|launch) .*", cell["source"], re.MULTILINE)
    return _about(cell).get("node") == node or any(re.search(rf"\b{re.escape(node)}\b", line) for line in commands)


def _had_error(cell: dict[str, Any], meant: list[str]) -> bool:
    """Return whether a cell that expects an error had one: in the cell itself, or in its node at any time."""
    if AS_EXPECTED in _printed(cell) or any(about["meant"] for about in node_errors(cell)):
        return True
    return any(_starts(cell, name) for name in meant)


def _code_cells(ran: dict[str, Any]) -> list[dict[str, Any]]:
    return [cell for cell in ran["cells"] if cell["cell_type"] == "code"]


def _failed_cells(chapter: Path, cells: list[dict[str, Any]]) -> Iterator[CellFailure]:
    for cell in cells:
        if cell["cell_type"] != "code":
            continue
        error = next((o for o in cell["outputs"] if o["output_type"] == "error"), None)
        expected = "raises-exception" in cell["metadata"].get("tags", [])
        if error and not expected:
            yield _failure(chapter, cell, error)
        elif expected and not error and cell["execution_count"]:
            message = "this cell says `raises`, but it did not fail."
            yield CellFailure(chapter, _line(cell), message, in_short(_printed(cell), *_LOG_LINES))


def _failure(chapter: Path, cell: dict[str, Any], error: dict[str, Any]) -> CellFailure:
    traceback = _ANSI.sub("", "\n".join(error["traceback"]))
    printed = _printed(cell)
    line = _line(cell)
    node = _about(cell).get("node")
    # A node's lines are counted from its cell's magic, those of a snippet from what completes it.
    above = 1 if node else _about(cell).get("above", 0)
    if node:
        inside = re.findall(_IN_MODULE.format(module=re.escape(node)), printed)
        line += max(int(inside[-1]) - above, 1) - 1 if inside else 0
    elif inside := _IN_CELL.findall(traceback):
        line += max(next(int(number) for number in inside[0] if number) - above, 1) - 1
    is_ours = error["ename"] == "CellFailed"
    message = error["evalue"] if is_ours else f"{error['ename']}: {error['evalue']}"
    return CellFailure(chapter, line, message, in_short(printed, *_LOG_LINES) if printed else "")


def _about(cell: dict[str, Any]) -> dict[str, Any]:
    about: dict[str, Any] = cell["metadata"].get("spinbook", {})
    return about


def _line(cell: dict[str, Any]) -> int:
    return int(_about(cell).get("line", 1))


def _printed(cell: dict[str, Any]) -> str:
    return "".join("".join(o["text"]) for o in cell.get("outputs", []) if o["output_type"] == "stream")
