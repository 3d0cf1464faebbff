"""Makes a chapter's notebook. The same chapter always gives the same bytes."""

from __future__ import annotations

import json
import shlex
from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import nbformat

from grader.exercise.loading import load
from grader.exercise.starter import starter
from spinbook.build.portable import Place, portable
from spinbook.chapter.chapter import Cell, Chapter
from spinbook.chapter.classify import CellKind
from spinbook.chapter.flavours import parser
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
    place = Place(course.root, chapter.file.parent.as_posix(), course.names, course.repository)
    waiting = True
    for cell in chapter.cells:
        # The chapter's heading comes first, then what makes its cells work.
        if waiting and cell.kind is not CellKind.PROSE:
            waiting = False
            yield setup_cell
        if cell.kind is CellKind.PROSE:
            yield _prose(cell.id, cell.source, cell.line, place)
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
        source = f"%%node {cell.name}{_bounds(cell)}{_how(cell)}\n{cell.source}"
        if cell.before:
            metadata["above"] = cell.before.count("\n")
    elif cell.kind is CellKind.PART:
        source = f"%%part {cell.name}{'' if cell.runs_in_kernel else ' --keep'}\n{cell.source}"
    elif cell.kind is CellKind.INTERFACE:
        metadata["interface"] = cell.name
        source = f"%%interface {cell.name}\n{cell.source}"
    elif cell.kind is CellKind.FILE:
        metadata["file"] = cell.name
        source = f"%%package_file {cell.name}\n{cell.source}"
    elif cell.kind is CellKind.SHELL:
        source = "\n".join(_shell_line(command, cell) for command in cell.commands)
    else:
        source = cell.source
    return _code(cell.id, source, metadata, ["raises-exception"] if cell.raises else [])


def _how(cell: Cell) -> str:
    """The options that say how a node's code is started and made whole."""
    words = [f"--class {name}" for name in cell.spin_classes]
    words += ["--main"] if cell.runs_main else []
    words += [f"--as {package}/{executable}" for package, executable in cell.executables]
    if cell.before:
        words.append(" ".join(["--after", *cell.after]) if cell.after else "--usual-imports")
    return "".join(f" {word}" for word in words)


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
    place = Place(course.root, f"exercises/{exercise.name}", course.names, course.repository)
    yield _prose(f"{cell.id}-task", _one_level_down(exercise.task), cell.line, place)
    if exercise.solution_file is not None:
        module = exercise.file_name.removesuffix(".py")
        source = f"%%node {module}\n{starter(exercise.solution_file.read_text(encoding='utf-8'))}"
        metadata = {"kind": "exercise", "line": cell.line, "node": module, "exercise": exercise.name}
        yield _code(f"{cell.id}-starter", source, metadata)
        # Not marked as the exercise's: its code is in the cell above.
        yield _code(f"{cell.id}-check", f"%check {exercise.name}", {"kind": "check", "line": cell.line})


def _one_level_down(task: str) -> str:
    """A task's headings, one level below the chapter's section in which it is."""
    lines = task.split("\n")
    for token in parser().parse(task):
        if token.type == "heading_open" and token.map and token.markup.startswith("#") and len(token.markup) < 6:
            lines[token.map[0]] = lines[token.map[0]].replace("#", "###", 1)
    return "\n".join(lines)


def _prose(cell_id: str, prose: str, line: int, place: Place) -> dict[str, Any]:
    place = replace(place, pictures={})
    source = portable(prose, place)
    metadata = {"spinbook": {"line": line}}
    cell: dict[str, Any] = {"cell_type": "markdown", "id": cell_id, "metadata": metadata, "source": source}
    return {**cell, "attachments": place.pictures} if place.pictures else cell


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
