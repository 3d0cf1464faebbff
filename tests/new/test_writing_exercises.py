"""The guide to writing exercises shows what the templates really contain, and every kind has its page."""

from __future__ import annotations

import re
import textwrap
from pathlib import Path

import pytest

from grader.checking.proofreading import problems_of
from grader.exercise import load, starter
from grader.grading import Options, grading_of
from grader.submission.reading import of_source
from grader.workers import WorkerPool
from spinbook.new.writing import KINDS, Kind

DOCS = Path(__file__).parents[2] / "docs"
FENCE = re.compile(r"^```(?:python|toml)\n(.*?)^```", re.MULTILINE | re.DOTALL)
OF_KIND = [pytest.param(kind, id=kind.name) for kind in KINDS]


def flat(text: str) -> str:
    """Return the text without indentation, which differs if an example was taken out of a function."""
    return "\n".join(line.strip() for line in textwrap.dedent(text).strip().splitlines())


def files_of(kind: Kind) -> str:
    """Return everything in the template's author files."""
    return "\n".join(flat(file.read_text()) for file in (kind.root / "exercises" / kind.exercise).glob("*.*"))


@pytest.mark.parametrize("kind", OF_KIND)
def test_every_example_stands_in_the_template_which_is_graded(kind: Kind) -> None:
    page = (DOCS / "writing-exercises" / f"{kind.name}.md").read_text()
    examples = FENCE.findall(page)
    assert len(examples) >= 3
    for example in examples:
        assert flat(example) in files_of(kind), example


@pytest.mark.parametrize("kind", OF_KIND)
def test_every_page_names_its_command(kind: Kind) -> None:
    page = (DOCS / "writing-exercises" / f"{kind.name}.md").read_text()
    assert f"--kind {kind.name}" in page


def test_the_guide_links_every_page_and_its_examples_stand_in_a_template() -> None:
    guide = (DOCS / "writing-exercises.md").read_text()
    assert [kind.name for kind in KINDS if f"(writing-exercises/{kind.name}.md)" not in guide] == []
    everything = "\n".join(files_of(kind) for kind in KINDS)
    assert all(flat(example) in everything for example in FENCE.findall(guide))


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
