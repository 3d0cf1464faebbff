"""If a machine allows no sandbox, the user's own code is checked with a warning; other people's is not graded."""

from __future__ import annotations

from pathlib import Path

import pytest

from grader.exercise import load
from grader.grading import Options, grading, grading_of
from grader.sandbox import Isolation, SandboxUnavailable
from grader.submission.reader import of_source
from grader.workers import WorkerPool
from spinbook.submit.self_check_view import as_html, as_text
from submit.conftest import ROOT, solution


@pytest.fixture
def no_sandbox(monkeypatch: pytest.MonkeyPatch) -> None:
    """As on Colab and in many containers."""

    def choose(wanted: Isolation | None = None) -> Isolation:
        if wanted is Isolation.NONE:
            return wanted
        raise SandboxUnavailable("No sandbox works on this machine, so students' code will not be run.")

    monkeypatch.setattr(grading, "choose", choose)


@pytest.mark.usefixtures("no_sandbox")
def test_a_students_own_code_is_checked_and_the_check_says_so(handed_out: Path, workers: WorkerPool) -> None:
    exercise = load(handed_out / "exercises" / "joint_velocity")

    grade = grading_of(exercise, Options(), workers).grade(of_source("your cell", solution().encode(), exercise))

    assert (grade.full_marks, grade.isolation, grade.self_check) == (True, "none", True)
    for message in (as_text(grade, exercise), as_html(grade, exercise)):
        assert "Your code ran without a sandbox, and no grade of record is made that way." in message


@pytest.mark.usefixtures("no_sandbox")
def test_an_instructor_is_refused(workers: WorkerPool) -> None:
    with pytest.raises(SandboxUnavailable):
        grading_of(load(ROOT / "exercises" / "joint_velocity"), Options(), workers)
