"""A student's page says what is right, what is wrong and what to do; and reveals no hidden check."""

from __future__ import annotations

import re
from html import unescape

import pytest
from graded_class import EXTRA, LATE, entry

from grader.exercise import Exercise
from grader.grading import Grade
from grader.report.feedback import feedback_page
from grader.report.feedback_plot import feedback_plot


def text(page: str) -> str:
    """Return the text of a page, without its head, in one line."""
    body = page.split("</head>")[1]
    return re.sub(r"\s+", " ", unescape(re.sub(r"<[^>]+>", " ", body)))


def page_of(grade: Grade, exercise: Exercise) -> str:
    return feedback_page(entry(grade), exercise, feedback_plot(grade, exercise))


def test_a_failed_public_check_tells_what_was_expected_and_got_when_and_where(
    graded: dict[str, Grade], exercise: Exercise
) -> None:
    shown = text(page_of(graded["position_for_velocity"], exercise))
    assert "Begin here The first check that your node fails: It subscribes to /joint_commands" in shown
    assert shown.index("Begin here") < shown.index("Checks ") < shown.index("Your node and the solution")
    assert (
        "expected 0.499167 rad/s got 0.0499167 rad/s when 0.10 s after the start (message 2) joint left_shoulder_pitch"
        in shown
    )
    assert "Every velocity is the position of the message that arrived, unchanged." in shown
    assert "Where to look Which line computes the value" in shown
    assert "What to do The number that arrives is sent on as it is." in shown
    assert "(position now - position before)" not in shown, "the author's hint is for another cause"


def test_one_cause_is_said_once_with_how_many_checks_wait_for_it(graded: dict[str, Grade], exercise: Exercise) -> None:
    page = page_of(graded["position_for_velocity"], exercise)
    blocked = [verdict for verdict in graded["position_for_velocity"].verdicts if verdict.status == "blocked"]
    assert blocked
    said = re.findall(r"(\d+) more checks? waits? for this", page)
    assert said[1:], "where to begin, and at the check"
    assert int(said[0]) >= len(blocked)
    assert "can't be judged until" not in page


def test_of_a_hidden_check_only_title_points_outcome_and_hint_are_reported(
    graded: dict[str, Grade], exercise: Exercise
) -> None:
    grade = graded["joints_by_index"]
    page = page_of(grade, exercise)
    failed = [verdict for verdict in grade.verdicts if verdict.status == "failed"]
    assert failed
    assert all(verdict.hidden for verdict in failed)
    for verdict in failed:
        assert verdict.finding
        assert verdict.title in text(page)
        assert verdict.hint in text(page)
        for secret in (verdict.name, verdict.finding.text, verdict.finding.scenario, verdict.finding.expected):
            assert not re.search(rf"(?<![\w.]){re.escape(secret)}(?![\w.])", text(page)), secret


def test_the_plot_shows_a_public_scenario_only_and_nothing_where_nothing_differs_in_it(
    graded: dict[str, Grade], exercise: Exercise
) -> None:
    assert feedback_plot(graded["joints_by_index"], exercise) is None, "its faults are in hidden scenarios"
    assert "Your node and the solution" not in page_of(graded["joints_by_index"], exercise)
    plot = feedback_plot(graded["solution"], exercise)
    assert plot
    assert "over 9.9 s" in plot, "the public scenario"
    assert "They agree everywhere." in plot


def test_the_plot_says_in_words_where_it_first_goes_wrong(graded: dict[str, Grade], exercise: Exercise) -> None:
    page = page_of(graded["position_for_velocity"], exercise)
    said = "6 of them differ; the first wrong value, left_elbow at 0.10 s, is marked with a cross."
    assert re.search(rf'<img src="data:image/svg\+xml;base64,[^"]+" alt="[^"]*{said}">', unescape(page))
    assert said in text(page)


def test_full_marks_are_celebrated(graded: dict[str, Grade], exercise: Exercise) -> None:
    shown = text(page_of(graded["solution"], exercise))
    assert "Everything is right" in shown
    assert "100 of 100 points" in shown
    assert "Where to look" not in shown


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("crashes_at_message_37", ["Your program crashed", "message 37 is too much for me", "line 23", "Traceback"]),
        ("syntax_error", ["Your program did not start", "SyntaxError", "python3 joint_velocity.py"]),
        ("never_spins", ["Your node stopped answering", "rclpy.spin(node)", "A busy machine is not the reason"]),
    ],
)
def test_a_run_that_broke_off_tells_why_and_what_to_do(
    graded: dict[str, Grade], exercise: Exercise, name: str, words: list[str]
) -> None:
    shown = text(page_of(graded[name], exercise))
    assert "0 of 100 points" in shown
    for word in words:
        assert word in shown


def test_a_fault_of_ours_is_no_zero(graded: dict[str, Grade], exercise: Exercise) -> None:
    assert graded["host_error"].outcome == "host-error"
    shown = text(page_of(graded["host_error"], exercise))
    assert "No score yet" in shown
    assert "not your fault" in shown
    assert "points" not in shown
    assert "worker process" not in shown, "that is for the instructor"


def test_adjustments_are_reported_with_their_reasons(graded: dict[str, Grade], exercise: Exercise) -> None:
    grade = graded["fixed_dt"]
    shown = text(feedback_page(entry(grade, adjustments=(LATE, EXTRA)), exercise, None))
    counts = f"{grade.score - 5.1:.1f}"
    assert f"{counts} of 100 points" in shown
    assert f"All checks {grade.score:g} Late handed in 1 day late −8.1" in shown
    assert f"Extra credit found a mistake in the task +3 Total {counts}" in shown


def test_it_tells_what_was_handed_in_when_and_how_it_was_graded(graded: dict[str, Grade], exercise: Exercise) -> None:
    grade = graded["fixed_dt"]
    shown = text(page_of(grade, exercise))
    assert "20 Nov 2026, 23:41 +01:00 (the file's date)" in shown
    assert f"Sandbox {grade.isolation}" in shown
    assert f"rclpy {grade.versions['rclpy']}" in shown


def test_of_a_long_log_the_end_is_shown_without_terminal_codes(graded: dict[str, Grade], exercise: Exercise) -> None:
    page = page_of(graded["breaks_pages"], exercise)
    assert "What your program printed" in text(page)
    assert not re.search(r"[\x00-\x08\x0b-\x1f\u202a-\u202e\u2066-\u2069]", page)
    assert len(page) < 300_000


def test_a_traceback_has_the_frames_of_the_students_program_only(graded: dict[str, Grade], exercise: Exercise) -> None:
    shown = text(page_of(graded["crashes_at_message_37"], exercise))
    files = set(re.findall(r'File "([^"]+)"', shown))
    assert files == {"joint_velocity.py"}
