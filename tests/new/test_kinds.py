"""`spinbook new --kind` makes an exercise of each kind that works at once: right solutions pass, mistakes are caught."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from pathlib import Path

import pytest
from click.testing import CliRunner, Result

from grader.crew import Crew
from grader.exercise import load
from grader.grading import Options, grading_of
from grader.grading.grading import Grading
from grader.submission import read
from spinbook.new.command import new
from spinbook.new.kind import KINDS, Kind
from spinbook.new.writing import write_course
from spinbook.problem import SpinbookError

KIND_NAMES = [kind.name for kind in KINDS]


@pytest.fixture(scope="module")
def course(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A new course with one exercise of each kind, called my_… after the kind."""
    folder = tmp_path_factory.mktemp("kinds") / "robots"
    write_course(folder, "Robots", "robots")
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(folder)
        for kind in KIND_NAMES:
            done = made("--exercise", exercise_of(kind), "--kind", kind)
            assert done.exit_code == 0, done.output
    return folder


@pytest.fixture(scope="module")
def crew() -> Iterator[Crew]:
    with Crew() as crew:
        yield crew


@pytest.fixture(scope="module", params=KIND_NAMES)
def grading(request: pytest.FixtureRequest, course: Path, crew: Crew) -> Grading:
    """Ready to grade one exercise; making it has graded the solution, which passed every check."""
    return grading_of(load(course / "exercises" / exercise_of(request.param)), Options(), crew)


def made(*words: str) -> Result:
    return CliRunner().invoke(new, words)


def exercise_of(kind: str) -> str:
    return f"my_{kind.replace('-', '_')}"


def files(grading: Grading, folder: str) -> list[Path]:
    """The submissions in a folder of the exercise's solutions: each a file, or a folder of several programs."""
    found = (course_of(grading) / "solutions" / grading.spinner.exercise.name / folder).iterdir()
    return sorted(path for path in found if path.name != "__pycache__")


def course_of(grading: Grading) -> Path:
    return grading.spinner.exercise.folder.parents[1]


def named(mistake: Path) -> set[str]:
    """The checks that a mistake says catch it."""
    programs = sorted(mistake.glob("*.py")) if mistake.is_dir() else [mistake]
    headers = [ast.get_docstring(ast.parse(file.read_text(encoding="utf-8"))) or "" for file in programs]
    return {name for header in headers for name in re.findall(r"^- (test_\w+)$", header, re.MULTILINE)}


def test_every_mistake_loses_exactly_the_checks_that_it_names(grading: Grading) -> None:
    mistakes = files(grading, "mistakes")
    assert len(mistakes) >= 8
    for mistake in mistakes:
        grade = grading.grade(read(str(mistake), grading.spinner.exercise))
        assert {verdict.name for verdict in grade.verdicts if verdict.status == "failed"} == named(mistake), mistake.name
