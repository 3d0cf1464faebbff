"""Late work: what exercise.toml may say about it, what it costs, and what the instructor decides otherwise."""

from __future__ import annotations

from datetime import datetime, timedelta, timezone
from pathlib import Path

import plain_grades as plain
import pytest

from grader.classroom.deadline import Adjuster, Deadline, deadline_of, overrides_in
from grader.classroom.submissions import SubmissionsError
from grader.exercise import Exercise, ExerciseError, load

DUE = datetime(2026, 11, 22, 23, 59, tzinfo=timezone.utc)


@pytest.fixture
def exercise(tmp_path: Path) -> Exercise:
    """An exercise of the test's own, without a deadline."""
    folder = tmp_path / "exercises" / "joint_velocity"
    folder.mkdir(parents=True)
    for name in ("exercise.toml", "task.md"):
        (folder / name).write_bytes((plain.ROOT / "exercises" / "joint_velocity" / name).read_bytes())
    return load(folder)


def saying(exercise: Exercise, *lines: str) -> Deadline | None:
    with (exercise.folder / "exercise.toml").open("a", encoding="utf-8") as file:
        file.write("\n[deadline]\n" + "\n".join(lines) + "\n")
    return deadline_of(exercise)


def after(**length: float) -> datetime:
    return DUE + timedelta(**length)


def test_without_a_deadline_nothing_is_late(exercise: Exercise) -> None:
    assert deadline_of(exercise) is None
    assert Adjuster(None)(plain.entry(plain.RIGHT)) == ()


def test_a_file_with_a_byte_order_mark_is_read(exercise: Exercise) -> None:
    file = exercise.folder / "exercise.toml"
    file.write_text("\ufeff" + file.read_text(encoding="utf-8"), encoding="utf-8")
    deadline = saying(exercise, "due = 2026-11-22T23:59:00Z")
    assert deadline
    assert deadline.due == DUE


@pytest.mark.parametrize(
    ("handed_in", "lost"),
    [
        (DUE, 0),
        (after(minutes=15), 0),
        (after(minutes=16), 10),
        (after(hours=24), 10),
        (after(hours=24, seconds=1), 20),
        (after(days=9), 50),
        (after(days=11), 100),
    ],
)
def test_each_day_that_has_begun_costs_up_to_a_most(exercise: Exercise, handed_in: datetime, lost: float) -> None:
    deadline = saying(
        exercise,
        "due = 2026-11-22T23:59:00Z",
        'grace = "15 minutes"',
        'penalty = "10 % a day up to 50 %"',
        "closes = 2026-12-03T00:00:00Z",
    )
    assert deadline
    assert deadline.lost(handed_in) == lost


def test_a_due_date_may_be_a_day_and_a_rule_may_be_by_the_hour(exercise: Exercise) -> None:
    deadline = saying(exercise, "due = 2026-11-22", 'penalty = "1.5 % per hour"')
    assert deadline
    assert deadline.due == datetime(2026, 11, 22, 23, 59, 59).astimezone()
    assert deadline.lost(deadline.due + timedelta(hours=2)) == 3.0


@pytest.mark.parametrize(
    ("lines", "message"),
    [
        (['penalty = "10 % a day"'], "has no due"),
        (['due = "tomorrow"'], "due = 'tomorrow'"),
        (["due = 2026-11-22", 'penalty = "ten percent"'], "penalty = 'ten percent'"),
        (["due = 2026-11-22", 'penalty = "110 % a day"'], "110 %"),
        (["due = 2026-11-22", 'grace = "soon"'], "grace = 'soon'"),
        (["due = 2026-11-22", "late = 3"], "has 'late'"),
        (["due = 2026-11-22", "closes = 2026-11-20"], "is before due"),
    ],
)
def test_what_can_not_be_understood_names_the_file_and_what_to_write(
    exercise: Exercise, lines: list[str], message: str
) -> None:
    with pytest.raises(ExerciseError, match=r"exercise\.toml") as error:
        saying(exercise, *lines)
    assert message in str(error.value)


def adjuster(tmp_path: Path, *rows: str) -> Adjuster:
    file = tmp_path / "overrides.csv"
    file.write_text("student,points,due,reason\n" + "\n".join(rows) + "\n", encoding="utf-8")
    return Adjuster(Deadline(DUE, percent=10.0), overrides_in(file, {"ada", "ben"}))


def test_lateness_is_that_of_the_hand_in_and_reported_with_its_source(tmp_path: Path) -> None:
    late = plain.entry(plain.HALF, submitted=after(days=1, hours=3), submitted_from="timestamp.txt")
    [found] = adjuster(tmp_path)(late)
    assert (found.kind, found.points) == ("late", -1.2)
    assert found.reason == "handed in 1 day 3 h late, by timestamp.txt: 20 % of 6 points"


def test_a_later_due_date_of_one_student_is_kept_with_its_reason(tmp_path: Path) -> None:
    adjust = adjuster(tmp_path, "ada,,2026-11-24 12:00 +0000,was ill".replace(" +0000", "+00:00"))
    late = plain.entry(plain.RIGHT, submitted=after(days=1), submitted_from="timestamp.txt")
    [found] = adjust(late)
    assert (found.kind, found.points) == ("override", 0.0)
    assert found.reason.endswith("was ill")


def test_points_may_be_added_beyond_full_marks(tmp_path: Path) -> None:
    on_time = plain.entry(plain.RIGHT, submitted=DUE)
    made = adjuster(tmp_path, "ada,+2.5,,found a mistake in the task")(on_time)
    assert plain.entry(plain.RIGHT, adjustments=made).final == 12.5


def test_points_that_are_set_count_late_or_not_also_after_a_fault_of_ours(tmp_path: Path) -> None:
    adjust = adjuster(tmp_path, "ada,7,,graded by hand")
    for grade in (plain.HALF, plain.FAULT):
        late = plain.entry(grade, submitted=after(days=3))
        assert plain.entry(grade, adjustments=adjust(late)).final == 7


def test_an_extension_to_a_day_lasts_until_its_end(tmp_path: Path) -> None:
    file = tmp_path / "overrides.csv"
    file.write_text("Student;Due;Reason\nada;24.11.2026;ill\n", encoding="utf-8")
    (extension,) = overrides_in(file, {"ada"}, timezone.utc)["ada"]
    assert str(extension.due) == "2026-11-24 23:59:59+00:00"


def test_nobody_gets_less_than_nothing(tmp_path: Path) -> None:
    made = adjuster(tmp_path, "ada,-20,,copied")(plain.entry(plain.HALF, submitted=DUE))
    assert plain.entry(plain.HALF, adjustments=made).final == 0


@pytest.mark.parametrize(
    ("row", "message"),
    [
        ("eve,5,,why", "no student is called 'eve'. Write the name of a folder"),
        ("Ada,5,,why", "no student is called 'Ada'. Did you mean ada?"),
        ("ada,5,,", "the reason is missing"),
        ("ada,,,why", "Give one of the two"),
        ("ada,5,2026-11-24,why", "Give one of the two"),
        ("ada,five,,why", "points = 'five'"),
        ("ada,,soon,why", "due = 'soon'"),
    ],
)
def test_a_row_with_a_mistake_is_reported_with_its_line(tmp_path: Path, row: str, message: str) -> None:
    with pytest.raises(SubmissionsError, match=r"overrides.csv:2: ") as error:
        adjuster(tmp_path, row)
    assert message in str(error.value)
