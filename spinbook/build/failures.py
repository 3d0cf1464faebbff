"""Finds the cells of an executed notebook that failed, and says so by chapter, line, and the node's own words."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from spinbook.runtime.showing import NEVER_CAME, in_short

_ANSI = re.compile(r"\x1b\[[0-9;]*m")
#: A traceback's line in a module that a node cell wrote, or in a snippet's cell.
_IN_MODULE = r'File "[^"]*\b{module}\.py", line (\d+)'
_IN_CELL = re.compile(r"Cell In\[\d+\], line (\d+)|^File <[^>]*>:(\d+)|-+> (\d+) ", re.MULTILINE)
_LOG_LINES = (8, 12)


@dataclass(frozen=True)
class CellFailure:
    """One cell that failed. `line` is the chapter's, as near to the fault as is known; `log` is what was printed."""

    chapter: Path
    line: int
    what: str
    log: str

    def __str__(self) -> str:
        text = f"{self.chapter}:{self.line}: {self.what}"
        return text + "".join(f"\n    | {line}" for line in self.log.splitlines())


def find_failures(chapter: Path, ran: dict[str, Any], ended: dict[str, Any]) -> list[CellFailure]:
    """The failures of one run. A cell in which the run broke off is told so among its outputs in `ran`.

    `ended` is what the run's process said of its end: {"finished": …}, {"timed_out": INDEX}, {"died": INDEX} or
    {"crashed": words}; `ran` the notebook with the outputs that were written.
    """
    cells = ran["cells"]
    failures = list(_failed_cells(chapter, cells))
    if "timed_out" in ended or "died" in ended:
        index = ended.get("timed_out", ended.get("died"))
        cell = cells[index] if index is not None else cells[0]
        what = "the notebook's deadline passed in this cell" if "timed_out" in ended else "the kernel died in this cell"
        note = f"{what}; it and its nodes were ended, and the cells below did not run."
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
    """Find the cells that waited for a text in vain (`until=`): what the chapter says of it can't be seen there."""
    found = []
    for cell in ran["cells"]:
        if cell["cell_type"] == "code" and (never := NEVER_CAME.search(_printed(cell))):
            what = (
                f"`until` never came: {never[1]} was not printed within {never[2]} s. Correct it, or raise `seconds`."
            )
            found.append(CellFailure(chapter, _line(cell), what, ""))
    return found


def _failed_cells(chapter: Path, cells: list[dict[str, Any]]) -> Iterator[CellFailure]:
    for cell in cells:
        if cell["cell_type"] != "code":
            continue
        error = next((o for o in cell["outputs"] if o["output_type"] == "error"), None)
        expected = "raises-exception" in cell["metadata"].get("tags", [])
        if error and not expected:
            yield _failure(chapter, cell, error)
        elif expected and not error and cell["execution_count"]:
            what = "this cell says `raises`, and it did not fail."
            yield CellFailure(chapter, _line(cell), what, in_short(_printed(cell), *_LOG_LINES))


def _failure(chapter: Path, cell: dict[str, Any], error: dict[str, Any]) -> CellFailure:
    traceback = _ANSI.sub("", "\n".join(error["traceback"]))
    printed = _printed(cell)
    line = _line(cell)
    node = cell["metadata"].get("spinbook", {}).get("node")
    if node:
        inside = re.findall(_IN_MODULE.format(module=re.escape(node)), printed)
        above = cell["metadata"]["spinbook"].get("above", 0)
        line += max(int(inside[-1]) - above, 1) - 1 if inside else 0
    elif inside := _IN_CELL.findall(traceback):
        line += next(int(number) for number in inside[0] if number) - 1
    is_ours = error["ename"] == "CellFailed"
    what = error["evalue"] if is_ours else f"{error['ename']}: {error['evalue']}"
    return CellFailure(chapter, line, what, in_short(printed, *_LOG_LINES) if printed else "")


def _line(cell: dict[str, Any]) -> int:
    return int(cell["metadata"].get("spinbook", {}).get("line", 1))


def _printed(cell: dict[str, Any]) -> str:
    return "".join("".join(o["text"]) for o in cell.get("outputs", []) if o["output_type"] == "stream")
