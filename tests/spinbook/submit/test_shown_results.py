"""What `%check` shows of the starter and of mistakes: judged here in one worker pool, without a notebook."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from grader.exercise import load, starter
from grader.exercise.mistakes import mistake_of
from grader.grading import Options, grading_of
from grader.grading.grading import Grading
from grader.submission.reader import of_source
from grader.workers import WorkerPool
from spinbook.submit.self_check_view import as_html, as_text
from submit.conftest import PUBLIC, ROOT, solution


@pytest.fixture(scope="module")
def grading(handed_out: Path, workers: WorkerPool) -> Grading:
    """A self-check in a student's copy of the exercise, as `%check` makes one."""
    return grading_of(load(handed_out / "exercises" / "joint_velocity").public(), Options(), workers)


def shown_of(grading: Grading, code: str) -> tuple[str, str]:
    """Return (plain text with single spaces, HTML) of a check."""
    exercise = grading.runner.exercise
    grade = grading.grade(of_source("your cell", code.encode(), exercise))
    return " ".join(as_text(grade, exercise).split()), as_html(grade, exercise)


def test_the_starter_gets_no_points_and_is_told_what_to_fix_first(grading: Grading) -> None:
    text, html = shown_of(grading, starter(solution()))

    for message in (text, html):
        assert re.search(rf"\b0 of {PUBLIC} public checks, 0 of \d+ points", message)
        assert re.search(r"\d+ hidden checks \(\d+ points\) will be judged after you hand in\.", message)
        assert "This is a self-check, not your grade." in message
        assert "Next:" in message
        assert "fix the first ✗, run the cell that begins with %%node joint_velocity, then this one again." in message
        assert message.count(f"{PUBLIC - 1} more checks wait for this.") == 1, "what all wait for is said once"
    assert html.count('class="sb-failed"') == 1
    assert html.count('class="sb-blocked"') == PUBLIC - 1


def test_a_mistake_is_reported_with_what_was_expected_what_came_when_and_which_joint(grading: Grading) -> None:
    text, html = shown_of(grading, mistake_of(load(ROOT / "exercises" / "joint_velocity"), "degrees").source)

    assert "Message 2 of 100 (0.10 s after the start" in text
    assert "expected velocity 0.499167 rad/s, got 28.6002 rad/s. Every velocity is in degrees." in text
    assert "Which line turns" not in text, "further hints are on request"
    assert "More help: %hint joint_velocity shows where to look, and then what to do." in text
    for label, value in {
        "expected": "0.499167 rad/s",
        "got": "28.6002 rad/s",
        "when": "0.10 s after the start (message 2 of 100)",
        "joint": "left_shoulder_pitch",
    }.items():
        assert f'<th scope="row">{label}</th><td>{value}</td>' in html
    assert "Every velocity is in degrees." in html
    assert "<summary>Where to look</summary><p>Which line turns the value into degrees?</p>" in html
    assert "(position now - position before)" not in text + html, "the author's hint is for another cause"
    assert "First wrong: 0.10 s, left_shoulder_pitch." in html


def test_a_misspelled_topic_is_named_and_nothing_that_the_grader_itself_brings(grading: Grading) -> None:
    text, html = shown_of(grading, solution().replace("/joint_commands", "/joint_comands"))

    for message in (text, html):
        assert "Is /joint_comands a misspelling of /joint_commands?" in message
        assert "/clock" not in message


def test_nothing_of_the_students_becomes_markup(grading: Grading) -> None:
    bad = "<script>alert(1)</script><img src=x onerror=alert(2)>"
    spoiled = solution().replace("answer = JointState()", f"raise ValueError({bad!r})")
    assert bad in spoiled

    _, html = shown_of(grading, spoiled)

    assert "&lt;script&gt;alert(1)&lt;/script&gt;" in html
    assert "<script" not in html
    assert "<img src=x" not in html
