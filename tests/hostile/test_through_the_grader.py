"""Hostile and broken submissions through the whole grader: each gets exactly the grade that expected.toml says."""

from __future__ import annotations

import re
import sys
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from odd_files import ODD_FILES, OddFile

from grader.exercise import load
from grader.grading import Grade, Options, grading_of
from grader.grading.grading import Grading
from grader.submission import read
from grader.workers import WorkerPool

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

HERE = Path(__file__).parent
EXERCISE = HERE.parents[1] / "exercises" / "joint_velocity"
EXPECTED: dict[str, dict[str, Any]] = tomllib.loads((HERE / "expected.toml").read_text(encoding="utf-8"))

#: One of each kind, for every `make test`, except those in tests/grader/test_outcomes.py. `make soak` grades
#: all.
ALWAYS = {
    *("syntax_error", "missing_dependency", "not_utf8", "never_creates_a_node", "crashes_at_message_37"),
    *("ends_with_0_in_the_callback", "fork_bomb", "kills_its_parent"),
    *("looks_for_solutions", "patches_rclpy", "prints_a_forged_report", "publishes_clock", "copies_another_publisher"),
}


def every() -> list[Any]:
    return [pytest.param(name, marks=() if name in ALWAYS else pytest.mark.soak) for name in sorted(EXPECTED)]


@pytest.fixture(scope="module")
def grading() -> Iterator[Grading]:
    """A grading that runs two scenarios at once: a second one beside each attack, and no four fork bombs."""
    with WorkerPool() as workers:
        yield grading_of(load(EXERCISE), Options(parallel=2), workers)


def shown(grade: Grade) -> str:
    """Return everything that the student is told."""
    findings = [verdict.finding.text for verdict in grade.verdicts if verdict.finding]
    titles = [verdict.title for verdict in grade.verdicts if verdict.status == "failed"]
    return "\n".join([grade.message, *findings, *titles])


@pytest.mark.parametrize("name", every())
def test_the_grade_is_the_expected_one(grading: Grading, name: str) -> None:
    expected = EXPECTED[name]
    grade = grading.grade(read(str(HERE / "submissions" / f"{name}.py"), grading.runner.exercise))
    assert grade.outcome in expected["outcome"], (grade.outcome, grade.message)
    right = {"zero": grade.score == 0, "full": grade.full_marks, "less": not grade.full_marks, "any": True}
    assert right[expected["score"]], [v for v in grade.verdicts if v.status != "passed"]
    for words in expected.get("words", []):
        assert re.search(words, shown(grade), re.IGNORECASE), shown(grade)
    logs = "\n".join(recording.log for recording in grade.recordings.values())
    for word in expected.get("never", []):
        assert word not in logs
    if not grade.full_marks:
        assert shown(grade).strip(), "the student has to be told something"


@pytest.mark.parametrize("odd", [pytest.param(odd, id=odd.name) for odd in ODD_FILES])
def test_an_odd_file_is_graded_or_refused_without_harm(
    grading: Grading, odd: OddFile, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    folder = tmp_path / "handed in"
    folder.mkdir()
    path = odd.make(folder)
    monkeypatch.chdir(folder)
    submission = read(str(path), grading.runner.exercise)
    assert "secret" not in submission.source
    alone = replace(grading, runner=grading.runner.only("chapter"))
    recordings = alone.runner.spin(submission) if submission.program else None
    if recordings is None:
        assert "did-not-start" in odd.outcome
        assert submission.problem
        assert grading.grade(submission).score == 0
    else:
        assert "graded" in odd.outcome
        assert recordings["chapter"].ending.outcome == "completed"


def test_afterwards_an_honest_submission_still_gets_full_marks(grading: Grading) -> None:
    solution = grading.runner.exercise.solution_file
    assert solution
    assert grading.grade(read(str(solution), grading.runner.exercise)).full_marks
