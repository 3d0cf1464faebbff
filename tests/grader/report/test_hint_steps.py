"""Further hints of the last check come one step at a time, and are counted."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import pytest

from grader.checking.verdict import Finding, Verdict
from grader.exercise import Exercise, load
from grader.grading.grade import Grade
from grader.report.hint_steps import FILE, last_hints, next_hint, remember, taken, taken_in_page

ROOT = Path(__file__).parents[3]

WRONG = Finding("At 1.00 s: wrong. It waits.", cause="It waits.", where="What waits?", todo="Do not wait.")
FIRST = Verdict("test_a", "It answers.", "failed", 2.0, "Author's hint.", finding=WRONG)
RESULT = Grade(
    *("joint_velocity", "mine.py", "", "graded", "", 0.0, 4.0),
    verdicts=(FIRST, Verdict("test_b", "It ends.", "blocked", 2.0, blocked_by=("test_a",))),
    isolation="none",
    seed=1,
    versions={},
    self_check=True,
)


@pytest.fixture(scope="module")
def exercise() -> Exercise:
    return load(ROOT / "exercises" / "joint_velocity")


def test_each_request_shows_one_step_more_and_is_counted(exercise: Exercise, tmp_path: Path) -> None:
    remember(exercise, last_hints(RESULT), tmp_path)

    first, second, third = (next_hint(exercise, tmp_path) for _ in range(3))

    assert first == "It answers.\nWhere to look: What waits?\nThere is one more hint."
    assert second == "It answers.\nWhere to look: What waits?\nWhat to do: Do not wait.\nThere are no more hints."
    assert third == second
    assert taken(exercise, tmp_path) == {"It answers.": 2}


def test_a_later_check_keeps_the_count(exercise: Exercise, tmp_path: Path) -> None:
    remember(exercise, last_hints(RESULT), tmp_path)
    next_hint(exercise, tmp_path)
    other = replace(FIRST, title="It ends.", finding=replace(WRONG, where="", todo=""), todo="Author's todo.")
    remember(exercise, last_hints(replace(RESULT, verdicts=(other,))), tmp_path)

    assert next_hint(exercise, tmp_path).startswith("It ends.\nWhere to look: Author's hint.")
    assert taken(exercise, tmp_path) == {"It answers.": 1, "It ends.": 1}


def test_a_program_that_ended_has_hints_too_and_one_that_passes_has_none(exercise: Exercise, tmp_path: Path) -> None:
    assert next_hint(exercise, tmp_path).startswith("Check your node first")
    remember(exercise, last_hints(replace(RESULT, outcome="crashed", line=3)), tmp_path)
    assert "Line 3 ends with an exception." in next_hint(exercise, tmp_path)
    remember(exercise, last_hints(replace(RESULT, verdicts=())), tmp_path)
    assert "nothing to give a hint for" in next_hint(exercise, tmp_path)


@pytest.mark.parametrize("text", ["", "[1]", json.dumps({"joint_velocity": {"taken": 3}}), "\0"])
def test_a_file_that_somebody_changed_does_no_harm(exercise: Exercise, tmp_path: Path, text: str) -> None:
    (tmp_path / FILE).parent.mkdir()
    (tmp_path / FILE).write_text(text, encoding="utf-8")

    assert taken(exercise, tmp_path) == {}
    assert next_hint(exercise, tmp_path)


def test_a_program_from_a_page_says_which_hints_were_shown_there() -> None:
    assert taken_in_page('main()\n\n# Hints shown in the page: {"It answers.":2}\n') == {"It answers.": 2}
    assert taken_in_page('# Hints shown in the page: {"It answers.":"many"}\n') == {}
    assert taken_in_page("# Hints shown in the page: {it answers}\n") == {}
