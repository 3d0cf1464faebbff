"""The programs of the author's that an exercise is audited with."""

from __future__ import annotations

import ast
import re
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

from grader.exercise import Exercise, starter
from grader.grading.reference import solution_file
from grader.submission import Submission
from grader.submission.reading import of_source

#: A node that is there and does nothing.
IDLE = """import rclpy

rclpy.init()
rclpy.spin(rclpy.create_node({name!r}))
"""


@dataclass(frozen=True)
class Candidate:
    """One program: what it is, where, and for a mistake which checks are to catch it, and in which line that stands."""

    kind: Literal["solution", "right", "mistake", "nothing"]
    name: str
    file: Path
    title: str
    submission: Submission
    caught_by: tuple[str, ...] = ()
    line: int = 1


def right_ones(exercise: Exercise) -> list[Candidate]:
    """The solution, then every other right one."""
    solution = solution_file(exercise)
    files = [solution, *sorted((solution.parent / "right").glob("*.py"))]
    return [_candidate("solution" if file == solution else "right", file, exercise) for file in files]


def mistakes(exercise: Exercise) -> list[Candidate]:
    """Every usual mistake."""
    folder = solution_file(exercise).parent / "mistakes"
    return [_candidate("mistake", file, exercise) for file in sorted(folder.glob("*.py"))]


def nothings(exercise: Exercise) -> list[Candidate]:
    """What must get no points at all: the starter, an empty file, a node that does nothing."""
    solution = solution_file(exercise)
    sources = {
        "the starter": starter(solution.read_text(encoding="utf-8")),
        "an empty file": "",
        "a node that does nothing": IDLE.format(name=exercise.node_name),
    }
    return [
        Candidate("nothing", name, solution, name, of_source(name, source.encode(), exercise))
        for name, source in sources.items()
    ]


def _candidate(kind: Literal["solution", "right", "mistake"], file: Path, exercise: Exercise) -> Candidate:
    code = file.read_bytes()
    name = file.name if kind == "solution" else f"{file.parent.name}/{file.name}"
    text = code.decode("utf-8", errors="replace")
    header = _header(text)
    title = header.strip().partition("\n")[0] or file.stem
    caught_by = tuple(re.findall(r"^- (\w+)\s*$", header.partition("Caught by:")[2], re.MULTILINE))
    line = next((i for i, row in enumerate(text.splitlines(), start=1) if row.strip() == "Caught by:"), 1)
    return Candidate(kind, name, file, title, of_source(str(file), code, exercise), caught_by, line)


def _header(text: str) -> str:
    try:
        return ast.get_docstring(ast.parse(text)) or ""
    except SyntaxError:
        return ""
