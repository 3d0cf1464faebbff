"""Reads hostile and broken programs, each with the grade that it must get: submissions.md and on_the_grader.md."""

from __future__ import annotations

import sys
from dataclasses import dataclass
from pathlib import Path

from grader.exercise.edits import Edit, read_edits

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

FILE = Path(__file__).with_suffix(".md")

#: What most of them change: a right solution with nothing to hide.
HONEST = Path(__file__).parent / "honest.py"

#: What is above each attack on the grader's own processes.
RAW_CONNECTIONS = HONEST.with_name("raw_connections.py").read_text()


@dataclass(frozen=True)
class HostileProgram:
    """A whole program, what it tries, and the expected grade: see the head of submissions.md."""

    name: str
    tries: str
    source: str
    outcome: tuple[str, ...]
    score: str
    words: tuple[str, ...] = ()
    never: tuple[str, ...] = ()


def _program(edit: Edit, above: str = "") -> HostileProgram:
    tries, _, grade = (" ".join(part.split()) for part in edit.text.partition("Expected:"))
    expected = tomllib.loads(f"grade = {grade}")["grade"]
    expected |= {key: tuple(expected[key]) for key in ("outcome", "words", "never") if key in expected}
    return HostileProgram(edit.name, tries, above + edit.applied_to(HONEST), **expected)


SUBMISSIONS = {edit.name: _program(edit) for edit in read_edits(FILE)}
ON_THE_GRADER = {edit.name: _program(edit, RAW_CONNECTIONS) for edit in read_edits(FILE.with_name("on_the_grader.md"))}
