"""`spinbook lint`: tells an author what will not run and why."""

from __future__ import annotations

import json
import sys
from pathlib import Path

import click

from spinbook.build.reading import read_all
from spinbook.chapter.chapter import CellKind
from spinbook.chapter.read import Reading
from spinbook.course.course import Course, find_course
from spinbook.interfaces.collect import checked
from spinbook.problem import Problem, SpinbookError


@click.command()
@click.option("--course", "start", type=click.Path(path_type=Path), default=".", help="The course's folder.")
@click.option("--strict", is_flag=True, help="Warnings fail as well.")
@click.option(
    "--static", "show_static", is_flag=True, help="List every fence that is shown and not run, with the reason."
)
@click.option("--json", "as_json", is_flag=True, help="Print JSON, for editors and CI.")
def lint(start: Path, strict: bool, show_static: bool, as_json: bool) -> None:
    """Read every chapter, run nothing, and tell what is wrong and what will not run.

    Each message names file and line, what stands there, and what to do. Exit code: 0 nothing to mend, 1 an error
    (or, with --strict, a warning).
    """
    course = find_course(start)
    readings = list(read_all(course))
    problems = [*_interfaces(course), *(problem for reading in readings for problem in reading.problems)]
    if as_json:
        click.echo(json.dumps([_as_json(reading) for reading in readings], indent=1))
    else:
        for problem in problems:
            click.echo(str(problem))
        for reading in readings:
            _summary(reading, show_static)
    errors = sum(problem.is_error for problem in problems)
    if not as_json:
        click.echo(f"{errors} errors, {len(problems) - errors} warnings")
    sys.exit(1 if errors or (strict and problems) else 0)


def _interfaces(course: Course) -> tuple[Problem, ...]:
    """What is wrong in the course's messages, services and actions."""
    try:
        checked(course)
    except SpinbookError as error:
        return error.problems
    return ()


def _summary(reading: Reading, show_static: bool) -> None:
    chapter = reading.chapter
    if chapter is None:
        return
    counts = {kind: sum(cell.kind is kind for cell in chapter.cells) for kind in CellKind}
    told = ", ".join(f"{counts[kind]} {kind.value}" for kind in CellKind if counts[kind])
    click.echo(f"{chapter.file}: {told}, {len(chapter.static_fences)} fences shown and not run")
    if show_static:
        for fence in chapter.static_fences:
            click.echo(f"  {chapter.file}:{fence.line}: {fence.language or 'fence'}: {fence.why}")


def _as_json(reading: Reading) -> dict[str, object]:
    chapter = reading.chapter
    return {
        "chapter": chapter.file.as_posix() if chapter else None,
        "problems": [
            {"file": p.file.as_posix(), "line": p.line, "severity": p.severity.value, "found": p.found, "mend": p.mend}
            for p in reading.problems
        ],
        "cells": [{"id": cell.id, "kind": cell.kind.value, "line": cell.line} for cell in chapter.cells]
        if chapter
        else [],
        "static": [{"line": f.line, "language": f.language, "why": f.why} for f in chapter.static_fences]
        if chapter
        else [],
    }
