"""The gradebook of a course: one page and one table for all exercises that were graded."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import plain_grades as plain
import pytest
from click.testing import CliRunner

from grader.classroom.course_gradebook import (
    column_of,
    course_csv,
    course_page,
    course_rows,
    feedback_of,
    graded_exercises,
    struggles,
)
from grader.grading.grade import Entry, Student
from grader.report.as_json import folder_of, to_json
from spinbook.cli import spinbook

ROOT = Path(__file__).parents[3]
ADA, BEN, CARL = Student("ada", "Ada Lovelace", "ada@example.org"), Student("ben"), Student("carl", "Carl Gauss")


def keep(results: Path, exercise: str, *entries: Entry) -> None:
    """Write what `spinbook grade` stores for an exercise."""
    for entry in entries:
        folder = folder_of(results / exercise, entry.student.id)
        folder.mkdir(parents=True)
        graded = replace(entry, grade=replace(entry.grade, exercise=exercise))
        (folder / "grade.json").write_text(to_json(graded), encoding="utf-8")


@pytest.fixture
def results(tmp_path: Path) -> Path:
    """Two exercises of 10 points: Ada did both, Ben one, and Carl's second could not be graded."""
    keep(tmp_path, "heartbeat", plain.entry(plain.RIGHT, ADA), plain.entry(plain.HALF, CARL))
    fault = plain.entry(plain.FAULT, CARL)
    keep(tmp_path, "joint_velocity", plain.entry(plain.HALF, ADA), plain.entry(plain.HALF, BEN), fault)
    return tmp_path


def test_exercises_come_in_the_order_of_the_course(results: Path) -> None:
    names = [exercise.name for exercise in graded_exercises(results, ["joint_velocity", "not_graded_yet"])]
    assert names == ["joint_velocity", "heartbeat"]


def test_points_so_far_count_what_was_not_handed_in_as_0_and_faults_of_ours_not_at_all(results: Path) -> None:
    rows = {row.student.id: row for row in course_rows(graded_exercises(results))}
    assert (rows["ada"].earned, rows["ada"].of) == (16, 20)
    assert (rows["ben"].earned, rows["ben"].of) == (6, 20)
    assert (rows["carl"].earned, rows["carl"].of) == (6, 10)
    assert [rows["ben"].percent, rows["carl"].percent] == [30, 60]


def test_the_table_has_a_column_per_exercise(results: Path) -> None:
    exercises = graded_exercises(results)
    assert course_csv(exercises, course_rows(exercises)).splitlines() == [
        "student,name,email,heartbeat,joint_velocity,points so far,of,percent",
        "ada,Ada Lovelace,ada@example.org,10,6,16,20,80",
        "ben,,,,6,6,20,30",
        "carl,Carl Gauss,,6,,6,10,60",
    ]


def test_the_worst_checks_of_all_exercises_are_named_first(results: Path) -> None:
    found = struggles([column_of(exercise) for exercise in graded_exercises(results)])
    assert [(one.column.exercise.name, one.tally.failed, one.tally.share) for one in found] == [
        ("joint_velocity", 2, 100.0),
        ("heartbeat", 1, 50.0),
    ]


def test_a_grade_that_can_not_be_read_is_left_out(results: Path) -> None:
    (folder_of(results / "heartbeat", "ada") / "grade.json").write_text("{", encoding="utf-8")
    [heartbeat, _] = graded_exercises(results)
    assert set(heartbeat.entries) == {"carl"}


def test_the_page_links_to_each_exercise_and_each_students_page(results: Path) -> None:
    exercises = graded_exercises(results, titles={"heartbeat": "A heartbeat"})
    rows = course_rows(exercises)
    page = course_page("Humanoids", exercises, rows)
    assert '<a class="whole" href="heartbeat/index.html">A heartbeat</a>' in page
    assert feedback_of(exercises[1], rows[0]) == "joint_velocity/students/ada/feedback.html"
    assert feedback_of(exercises[1], rows[0]) in page
    assert "nothing handed in" in page
    assert "not graded" in page


def test_the_command_writes_page_and_table(results: Path) -> None:
    done = CliRunner().invoke(spinbook, ["gradebook", str(results), "--course", str(ROOT)])
    assert done.exit_code == 0, done.output
    assert "3 students, exercises: " in done.output
    assert "Joint velocities from joint positions" in (results / "index.html").read_text(encoding="utf-8")
    assert (results / "gradebook.csv").read_text(encoding="utf-8").startswith("\ufeffstudent,name,email,")
    assert done.stderr == ""


def test_the_command_says_who_may_be_one_student_and_whose_grade_can_not_be_read(tmp_path: Path) -> None:
    named = {name: plain.entry(plain.RIGHT, Student(name)) for name in ("w1-ada", "w2-ada", "ada", "w2-ben")}
    named |= {name: plain.entry(plain.RIGHT, Student(name)) for name in ("Guest_1", "Guest_2", "Guest_3")}
    keep(tmp_path, "heartbeat", named["w1-ada"], named["w2-ben"], named["Guest_1"], named["Guest_2"])
    keep(tmp_path, "joint_velocity", named["w2-ada"], named["w2-ben"], named["Guest_3"])
    (folder_of(tmp_path / "heartbeat", "w2-ben") / "grade.json").write_text("{", encoding="utf-8")
    done = CliRunner().invoke(spinbook, ["gradebook", str(tmp_path), "--course", str(ROOT)])
    assert [line.partition(". ")[0] for line in done.stderr.splitlines()] == [
        f"{tmp_path}/heartbeat/students/w2-ben: this grade can't be read, and counts as not handed in",
        "counted as 2 students: w1-ada, w2-ada",
    ]


def test_results_without_a_grade_are_said_to_have_none(tmp_path: Path) -> None:
    done = CliRunner().invoke(spinbook, ["gradebook", str(tmp_path), "--course", str(ROOT)])
    assert done.exit_code == 1
    assert "Grade an exercise first" in done.output
