"""`spinbook lint`: says what is wrong in chapters and exercises, and what will not run and why."""

from __future__ import annotations

import json
import sys
from collections.abc import Sequence
from dataclasses import asdict, replace
from pathlib import Path

import click

from grader.checking.proofreader import problems_of
from groundwork.files import from_here
from groundwork.problem import Problem, Severity
from groundwork.words import counted
from spinbook.chapter.classify import CellKind
from spinbook.chapter.read import ReadResult
from spinbook.chapters import read_all
from spinbook.course.course import Course, find_course
from spinbook.course.obstacles import ranked
from spinbook.interfaces.definitions import checked, compile_course
from spinbook.problem import SpinbookError

#: Up to this many problems need no count; with more, a count follows at the end.
_FEW = 12


@click.command()
@click.option("--course", "start", type=click.Path(path_type=Path), default=".", help="The course's folder.")
@click.option("--strict", is_flag=True, help="Treat warnings as errors.")
@click.option(
    "--static", "show_static", is_flag=True, help="List every fence that is shown but not run, with the reason."
)
@click.option("--json", "as_json", is_flag=True, help="Print JSON, for editors and CI.")
def lint(start: Path, strict: bool, show_static: bool, as_json: bool) -> None:
    """Read every chapter and exercise, run no node, and say what is wrong and what will not run.

    Each message names file and line, what is there, and what to do. Exit code: 0 nothing to fix, 1 an error
    (or, with --strict, a warning).
    """
    course = find_course(start)
    readings = list(read_all(course))
    of_course = [*_interfaces(course), *_exercises(course)]
    problems = [*of_course, *(problem for reading in readings for problem in reading.problems)]
    if as_json:
        # What is wrong in the course's other files is in no chapter.
        readings += [ReadResult(None, tuple(of_course))] if of_course else []
        click.echo(json.dumps([_as_json(reading) for reading in readings], indent=1))
    else:
        for problem in problems:
            click.echo(str(problem))
        for reading in readings:
            _summary(reading, show_static)
        for line in ranked(problems) if len(problems) > _FEW else ():
            click.echo(line)
    errors = sum(problem.is_error for problem in problems)
    not_run = sum(problem.severity is Severity.NOT_RUN for problem in problems)
    if not as_json:
        words = f"{not_run} not run, " if not_run else ""
        warnings = counted(len(problems) - errors - not_run, "warning")
        click.echo(f"{counted(errors, 'error')}, {words}{warnings}")
    sys.exit(1 if errors or (strict and problems) else 0)


def _interfaces(course: Course) -> tuple[Problem, ...]:
    """Return what is wrong in the course's messages, services and actions. Those that exercises use are compiled."""
    try:
        collected = checked(course)
        if any(_mentions(file, collected.packages) for file in _exercise_files(course)):
            compile_course(course, collected)
    except SpinbookError as error:
        return error.problems
    return ()


def _mentions(file: Path, packages: Sequence[str]) -> bool:
    text = file.read_bytes()
    return any(f"{package}/".encode() in text for package in packages)


def _exercise_files(course: Course) -> list[Path]:
    return sorted((course.root / "exercises").glob("*/exercise.toml"))


def _exercises(course: Course) -> tuple[Problem, ...]:
    """Return what is wrong in the course's exercises and their solutions."""
    problems = [problem for file in _exercise_files(course) for problem in problems_of(file.parent)]
    return tuple(replace(problem, file=from_here(problem.file)) for problem in problems)


def _summary(reading: ReadResult, show_static: bool) -> None:
    chapter = reading.chapter
    if chapter is None:
        return
    counts = {kind: sum(cell.kind is kind for cell in chapter.cells) for kind in CellKind}
    text = ", ".join(f"{counts[kind]} {kind.value}" for kind in CellKind if counts[kind])
    click.echo(f"{chapter.file}: {text}, {len(chapter.static_fences)} fences shown and not run")
    if show_static:
        for fence in chapter.static_fences:
            click.echo(f"  {chapter.file}:{fence.line}: {fence.language or 'fence'}: {fence.why}")


def _as_json(reading: ReadResult) -> dict[str, object]:
    chapter = reading.chapter
    cells, static_fences = (chapter.cells, chapter.static_fences) if chapter else ((), ())
    return {
        "chapter": chapter.file.as_posix() if chapter else None,
        "problems": [problem.plain for problem in reading.problems],
        "cells": [{"id": cell.id, "kind": cell.kind.value, "line": cell.line} for cell in cells],
        "static": [asdict(fence) for fence in static_fences],
    }
