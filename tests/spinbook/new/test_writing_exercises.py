"""The guide to writing exercises shows what the exercises of all kinds really contain, and has a section for each."""

from __future__ import annotations

import re
import textwrap
from pathlib import Path

import pytest

from grader.checking.proofreader import problems_of
from grader.exercise import load, starter
from grader.grading import Options, grading_of
from grader.submission.reader import of_source
from grader.workers import WorkerPool
from spinbook.new.kind import ExerciseKind
from spinbook.new.templates import KINDS

DOCS = Path(__file__).parents[3] / "docs"
FENCE = re.compile(r"^```(?:python|toml)\n(.*?)^```", re.MULTILINE | re.DOTALL)
OF_KIND = [pytest.param(kind, id=kind.name) for kind in KINDS]


def flat(text: str) -> str:
    """Return the text without indentation, which differs if an example was taken out of a function."""
    return "\n".join(line.strip() for line in textwrap.dedent(text).strip().splitlines())


def files_of(kind: ExerciseKind) -> str:
    """Return everything in the files of an exercise of this kind."""
    return "\n".join(flat(text) for text in kind.files("gripper_force", "Gripper force").values())


@pytest.mark.parametrize("kind", OF_KIND)
def test_every_example_of_a_kind_stands_in_its_exercise_which_is_graded(kind: ExerciseKind) -> None:
    page = (DOCS / "writing-exercises" / "kinds.md").read_text()
    section = page.partition(f"\n## `{kind.name}`\n")[2].partition("\n## ")[0]
    examples = FENCE.findall(section)
    assert len(examples) >= 2
    for example in examples:
        assert flat(example) in files_of(kind), example


def test_every_example_of_the_guide_stands_in_an_exercise() -> None:
    guide = (DOCS / "writing-exercises.md").read_text()
    everything = "\n".join(files_of(kind) for kind in KINDS)
    assert [example for example in FENCE.findall(guide) if flat(example) not in everything] == []


#: A mistake for each of the whole exercises on that page, and the check that has to catch it.
WHOLE = {
    "egg_timer": ("goal.canceled()", "goal.succeed()", "test_cancel"),
    "water_tank": ("min(1.0, max(0.0, 5.0 * (2.0 - message.data) + 0.3))", "5.0 * (2.0 - message.data)", "test_limits"),
}


def whole_exercise(name: str, course: Path) -> Path:
    """Return the folder of one of the exercises of the page, as the page has it."""
    page = (DOCS / "writing-exercises" / "whole-exercises.md").read_text()
    for place, text in re.findall(r'^```\w+ title="(\S+)"\n(.*?)^```', page, re.MULTILINE | re.DOTALL):
        (course / place).parent.mkdir(parents=True, exist_ok=True)
        (course / place).write_text(text)
    (course / "exercises" / name / "task.md").write_text("# A task\n")
    return course / "exercises" / name


@pytest.mark.parametrize("name", WHOLE)
def test_a_whole_exercise_of_the_docs_has_nothing_to_fix_and_is_short(name: str, tmp_path: Path) -> None:
    folder = whole_exercise(name, tmp_path)
    assert problems_of(folder) == ()
    lines = {file: len((folder / file).read_text().splitlines()) for file in ("scenarios.py", "checks.py")}
    assert lines["scenarios.py"] <= 30
    assert lines["checks.py"] <= 40


@pytest.mark.soak
@pytest.mark.parametrize("name", WHOLE)
def test_a_whole_exercise_of_the_docs_grades(name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("SPINBOOK_CACHE", str(tmp_path / "cache"))
    exercise = load(whole_exercise(name, tmp_path))
    solution = (tmp_path / "solutions" / name / "solution.py").read_text()
    right, wrong, caught_by = WHOLE[name]
    assert right in solution
    with WorkerPool() as workers:
        grading = grading_of(exercise, Options(), workers)  # the solution passes every check
        assert grading.grade(of_source("starter", starter(solution).encode(), exercise)).score == 0
        grade = grading.grade(of_source("wrong", solution.replace(right, wrong).encode(), exercise))
    assert [verdict.name for verdict in grade.verdicts if verdict.status == "failed"] == [caught_by]
