"""Hostile and broken submissions through the whole grader: each gets exactly the grade that submissions.md says."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from few_scenarios import in_scenarios
from odd_files import ODD_FILES, OddFile
from submissions import SUBMISSIONS

from grader.grading import Grade
from grader.grading.grading import Grading
from grader.recording.recording import Ending
from grader.submission import read
from grader.submission.reader import of_source

#: One of each kind, for every `make test`, except those in tests/grader/grading/test_outcomes.py. `make soak` grades
#: all.
ALWAYS = {
    *("fork_bomb", "kills_its_parent", "looks_for_solutions", "searches_its_process_for_paths"),
    *("patches_rclpy", "prints_a_forged_report", "publishes_clock", "copies_another_publisher"),
}
#: The scenarios for those that run to the end.
FEW = ("chapter", "irregular")


def shown(grade: Grade) -> str:
    """Return everything that the student is told."""
    findings = [verdict.finding.text for verdict in grade.verdicts if verdict.finding]
    titles = [verdict.title for verdict in grade.verdicts if verdict.status == "failed"]
    return "\n".join([grade.message, *findings, *titles])


def has_its_grade(grading: Grading, name: str) -> None:
    """Check that a submission gets the grade that submissions.md says, and that it is told why."""
    program = SUBMISSIONS[name]
    grade = grading.grade(of_source(f"{name}.py", program.source.encode(), grading.runner.exercise))
    assert grade.outcome in program.outcome, (grade.outcome, grade.message)
    right = {"zero": grade.score == 0, "full": grade.full_marks, "less": not grade.full_marks, "any": True}
    assert right[program.score], [v for v in grade.verdicts if v.status != "passed"]
    for words in program.words:
        assert re.search(words, shown(grade), re.IGNORECASE), shown(grade)
    logs = "\n".join(recording.log for recording in grade.recordings.values())
    for word in program.never:
        assert word not in logs
    if not grade.full_marks:
        assert shown(grade).strip(), "the student has to be told something"


@pytest.mark.parametrize("name", sorted(ALWAYS))
def test_the_grade_is_the_expected_one(grading: Grading, name: str) -> None:
    goes_on = "graded" in SUBMISSIONS[name].outcome
    has_its_grade(in_scenarios(grading, *FEW) if goes_on else grading, name)


@pytest.mark.soak
@pytest.mark.parametrize("name", sorted(SUBMISSIONS))
def test_the_grade_of_each_in_all_scenarios_is_the_expected_one(grading: Grading, name: str) -> None:
    has_its_grade(grading, name)


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
    ending = Ending("did-not-start", submission.problem or submission.question)
    if submission.program:
        ending = grading.runner.only("chapter").run(submission)["chapter"].ending
    assert ("graded" if ending.outcome == "completed" else ending.outcome) in odd.outcome
    assert odd.words in ending.message
    assert ending.message or ending.outcome == "completed", "the student has to be told something"


def test_afterwards_an_honest_submission_still_gets_full_marks(grading: Grading) -> None:
    solution = grading.runner.exercise.solution_file
    assert solution
    assert in_scenarios(grading, *FEW).grade(read(str(solution), grading.runner.exercise)).full_marks
