"""Makes a chapter's notebook. The same chapter always gives the same bytes."""

from __future__ import annotations

import json
import re
import shlex
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import nbformat

from grader.exercise import load, starter
from spinbook.build.portable import portable
from spinbook.chapter.chapter import Cell, CellKind, Chapter
from spinbook.chapter.terminal import Command, CommandKind
from spinbook.course.course import Course

_SETUP = """\
# Run this cell first: it gives the notebook its commands, such as %%node, %ros2, %plot and %stop.
%load_ext spinbook
%chapter {name} --package {package} --workspace {workspace}"""


def notebook_json(chapter: Chapter, course: Course) -> str:
    """The notebook as text: valid nbformat 4.5, keys sorted, newline at the end. Raises nbformat's ValidationError."""
    notebook = nbformat.from_dict(_notebook(chapter, course))
    nbformat.validate(notebook)
    return json.dumps(notebook, ensure_ascii=False, indent=1, sort_keys=True) + "\n"


def _notebook(chapter: Chapter, course: Course) -> dict[str, Any]:
    return {
        "nbformat": 4,
        "nbformat_minor": 5,
        "metadata": {
            "kernelspec": {"display_name": "Python 3 (ipykernel)", "language": "python", "name": "python3"},
            "language_info": {"name": "python", "file_extension": ".py", "mimetype": "text/x-python"},
            "title": chapter.title,
            "spinbook": {"chapter": chapter.file.as_posix()},
        },
        "cells": list(_cells(chapter, course)),
    }


def _cells(chapter: Chapter, course: Course) -> Iterator[dict[str, Any]]:
    setup = _SETUP.format(name=chapter.name, package=course.package.name, workspace=course.package.workspace)
    setup_cell = _code("spinbook-setup", setup, {"kind": "setup", "line": 1})
    folder = chapter.file.parent.as_posix()
    waiting = True
    for cell in chapter.cells:
        # The chapter's heading comes first, then what makes its cells work.
        if waiting and cell.kind is not CellKind.PROSE:
            waiting = False
            yield setup_cell
        if cell.kind is CellKind.PROSE:
            yield _prose(cell.id, portable(cell.source, folder, course.repository), cell.line)
        elif cell.kind is CellKind.EXERCISE:
            yield from _exercise(cell, course)
        else:
            yield _runnable(cell)
        if waiting:
            waiting = False
            yield setup_cell


def _runnable(cell: Cell) -> dict[str, Any]:
    metadata: dict[str, Any] = {"kind": cell.kind.value, "line": cell.line}
    if cell.kind is CellKind.NODE:
        metadata["node"] = cell.name
        spin_class = f" --class {cell.spin_class}" if cell.spin_class else ""
        source = f"%%node {cell.name}{_bounds(cell)}{spin_class}\n{cell.source}"
    elif cell.kind is CellKind.INTERFACE:
        metadata["interface"] = cell.name
        source = f"%%interface {cell.name}\n{cell.source}"
    elif cell.kind is CellKind.SHELL:
        source = "\n".join(_shell_line(command, cell) for command in cell.commands)
    else:
        source = cell.source
    return _code(cell.id, source, metadata, ["raises-exception"] if cell.raises else [])


def _bounds(cell: Cell) -> str:
    """The options that say how long a cell shows or runs."""
    seconds = f" --seconds {cell.seconds:g}" if cell.seconds else ""
    return seconds + (f" --until {shlex.quote(cell.until)}" if cell.until else "")


def _shell_line(command: Command, cell: Cell) -> str:
    if command.kind is CommandKind.NOTE:
        return command.text
    # A magic is one line: a value that a terminal would take over several loses its line breaks.
    text = " ".join(command.text.split("\n"))
    program, _, rest = text.partition(" ")
    if command.kind is CommandKind.PLOT:
        return f"%plot {rest}" + (f" --seconds {cell.seconds:g}" if cell.seconds else "")
    return f"%{program}{_bounds(cell)} {rest}"


def _exercise(cell: Cell, course: Course) -> Iterator[dict[str, Any]]:
    exercise = load(course.root / "exercises" / (cell.name or ""))
    folder = Path("exercises", exercise.name).as_posix()
    task = portable(_one_level_down(exercise.task), folder, course.repository)
    yield _prose(f"{cell.id}-task", task, cell.line)
    if exercise.solution_file is not None:
        module = exercise.file_name.removesuffix(".py")
        source = f"%%node {module}\n{starter(exercise.solution_file.read_text(encoding='utf-8'))}"
        metadata = {"kind": "exercise", "line": cell.line, "node": module, "exercise": exercise.name}
        yield _code(f"{cell.id}-starter", source, metadata)
        # Not marked as the exercise's: its code is in the cell above.
        yield _code(f"{cell.id}-check", f"%check {exercise.name}", {"kind": "check", "line": cell.line})


def _one_level_down(task: str) -> str:
    """A task's headings, one level below the chapter's section in which it stands."""
    return re.sub(r"^(#{1,5}) ", r"#\1# ", task, flags=re.MULTILINE)


def _prose(cell_id: str, source: str, line: int) -> dict[str, Any]:
    return {"cell_type": "markdown", "id": cell_id, "metadata": {"spinbook": {"line": line}}, "source": source}


def _code(cell_id: str, source: str, metadata: dict[str, Any], tags: list[str] | None = None) -> dict[str, Any]:
    shown: dict[str, Any] = {"spinbook": metadata}
    if tags:
        shown["tags"] = tags
    return {
        "cell_type": "code",
        "id": cell_id,
        "metadata": shown,
        "source": source.rstrip("\n"),
        "outputs": [],
        "execution_count": None,
    }
