"""The gradebook's files have the columns that each platform reads, and nothing in them harms those who open them."""

from __future__ import annotations

import csv
import io
import xml.etree.ElementTree as ET
from datetime import datetime, timezone
from pathlib import Path

import plain_grades as plain
from rich.console import Console

from grader.classroom.class_display import show_result
from grader.classroom.gradebook import write_gradebook
from grader.grading.grade import Adjustment, Entry, Student

LATE = Adjustment("late", -1.0, "handed in 1 h 0 min late")
EXTRA = Adjustment("override", 3.0, "found a mistake")

MOODLE = {"Identifier": "Participant 77", "Full name": "Jörg Müller"}
CANVAS = {"ID": "4711", "SIS User ID": "s-9", "Section": "A"}


def rows(folder: Path, name: str, entries: list[Entry]) -> list[dict[str, str]]:
    write_gradebook(folder, plain.exercise(), entries, datetime(2026, 11, 20, 22, 0, tzinfo=timezone.utc))
    return list(csv.DictReader(io.StringIO((folder / name).read_text(encoding="utf-8-sig"))))


def header(folder: Path, name: str) -> list[str]:
    return (folder / name).read_text(encoding="utf-8-sig").splitlines()[0].split(",")


def test_ours_tells_everything_and_a_column_a_check(tmp_path: Path) -> None:
    [row] = rows(tmp_path, "grades.csv", [plain.entry(plain.HALF, adjustments=(LATE,))])
    assert (row["student"], row["name"], row["points"], row["of"]) == ("ada", "Ada Lovelace", "5", "10")
    assert (row["before adjustments"], row["outcome"], row["failed"]) == ("6", "graded", "test_secret_gap")
    assert row["adjustments"] == "late -1: handed in 1 h 0 min late"
    assert (row["test_answers"], row["test_secret_gap"]) == ("6", "0")
    assert row["submitted"] == "2026-11-20T23:41:07+01:00"


def test_nbgraders_columns_are_those_of_its_export(tmp_path: Path) -> None:
    # nbgrader's documentation, "Exporting grades": the columns of grades.csv.
    [row] = rows(tmp_path, "nbgrader.csv", [plain.entry(plain.HALF, adjustments=(LATE, EXTRA))])
    assert header(tmp_path, "nbgrader.csv") == [
        *("assignment", "duedate", "timestamp", "student_id", "last_name", "first_name", "email"),
        *("raw_score", "late_submission_penalty", "score", "max_score"),
    ]
    assert (row["student_id"], row["last_name"], row["first_name"]) == ("ada", "Lovelace", "Ada")
    assert (row["duedate"], row["timestamp"]) == ("2026-11-20 22:00:00", "2026-11-20 22:41:07")
    assert float(row["score"]) == float(row["raw_score"]) - float(row["late_submission_penalty"]) == 8
    assert row["late_submission_penalty"] == "1"


def test_canvas_finds_students_by_its_own_columns_and_knows_the_points_possible(tmp_path: Path) -> None:
    # Canvas Instructor Guide, "How do I import grades in the Gradebook?".
    student = Student("m_ller_4711", "Müller, Jörg", "", CANVAS)
    possible, row = rows(tmp_path, "canvas.csv", [plain.entry(plain.HALF, student)])
    title = plain.exercise().title
    assert header(tmp_path, "canvas.csv") == ["Student", "ID", "SIS User ID", "SIS Login ID", "Section", title]
    assert (possible["Student"].strip(), possible[title]) == ("Points Possible", "10")
    assert (row["Student"], row["ID"], row["SIS User ID"], row[title]) == ("Müller, Jörg", "4711", "s-9", "6")


def test_canvas_keeps_the_assignment_that_it_named(tmp_path: Path) -> None:
    student = Student("a", "Ada", "", {**CANVAS, "Velocities (1234)": ""})
    _, row = rows(tmp_path, "canvas.csv", [plain.entry(plain.RIGHT, student)])
    assert row["Velocities (1234)"] == "10"


def test_moodles_worksheet_can_be_uploaded_as_it_is(tmp_path: Path) -> None:
    # Moodle's documentation, "Offline grading worksheet": a row above the maximum grade is left out.
    student = Student("J_rg_77", "Jörg Müller", "", MOODLE)
    [row] = rows(tmp_path, "moodle.csv", [plain.entry(plain.RIGHT, student, adjustments=(EXTRA,))])
    assert header(tmp_path, "moodle.csv") == [
        *("Identifier", "Full name", "Email address", "Status", "Grade", "Maximum Grade", "Grade can be changed"),
        *("Last modified (submission)", "Last modified (grade)", "Feedback comments"),
    ]
    assert (row["Identifier"], row["Full name"], row["Grade can be changed"]) == (
        "Participant 77",
        "Jörg Müller",
        "Yes",
    )
    assert (row["Grade"], row["Maximum Grade"]) == ("10", "10")
    assert "+3: found a mistake" in row["Feedback comments"]


def test_moodles_comments_give_no_hidden_check_away(tmp_path: Path) -> None:
    [row] = rows(tmp_path, "moodle.csv", [plain.entry(plain.HALF)])
    assert row["Feedback comments"] == "6 of 10 points.<br>✗ It survives a long gap. Hint: Think of stamps."


def test_a_fault_of_ours_is_no_zero_anywhere(tmp_path: Path) -> None:
    entries = [plain.entry(plain.FAULT)]
    assert rows(tmp_path, "grades.csv", entries)[0]["points"] == ""
    assert rows(tmp_path, "nbgrader.csv", entries)[0]["score"] == ""
    assert rows(tmp_path, "canvas.csv", entries)[1][plain.exercise().title] == ""
    assert rows(tmp_path, "moodle.csv", entries)[0]["Grade"] == ""
    assert '"score"' not in (tmp_path / "students" / "ada" / "results.json").read_text()


def test_no_name_becomes_a_formula_and_no_line_a_row(tmp_path: Path) -> None:
    evil = Student("eve", '=HYPERLINK("http://x")\n@SUM(1)\r\x1b[2J')
    for name in ("grades.csv", "nbgrader.csv", "canvas.csv", "moodle.csv"):
        for row in rows(tmp_path, name, [plain.entry(plain.RIGHT, evil)]):
            for cell in row.values():
                assert not cell.lstrip().startswith(("=", "+", "@", "\t")), (name, cell)
                assert "\x1b" not in cell


def test_students_stand_in_the_order_of_their_ids(tmp_path: Path) -> None:
    entries = [plain.entry(plain.RIGHT, Student(name)) for name in ("c", "a", "b")]
    assert [row["student"] for row in rows(tmp_path, "grades.csv", entries)] == ["a", "b", "c"]


def test_junit_has_a_suite_a_student_and_a_case_a_check(tmp_path: Path) -> None:
    entries = [
        plain.entry(of, Student(name)) for name, of in (("a", plain.HALF), ("b", plain.CRASHED), ("c", plain.FAULT))
    ]
    rows(tmp_path, "grades.csv", entries)
    root = ET.parse(tmp_path / "junit.xml").getroot()
    assert root.attrib["tests"] == "6"
    half, crashed, fault = root.findall("testsuite")
    assert [(case.get("name"), len(case)) for case in half] == [("test_answers", 0), ("test_secret_gap", 1)]
    assert half.get("failures") == "1"
    assert crashed[0].get("name") == "outcome"
    assert crashed.find("testcase/failure").get("type") == "crashed"  # type: ignore[union-attr]
    assert (fault.get("errors"), fault.get("failures")) == ("1", "0")


def test_a_student_whom_moodle_does_not_know_has_no_identifier_and_that_is_said(tmp_path: Path) -> None:
    known = plain.entry(plain.HALF, Student("jörg", "Jörg Müller", "", MOODLE))
    unknown = plain.entry(plain.HALF, Student("ada", "Ada Lovelace"))
    found = {row["Full name"]: row["Identifier"] for row in rows(tmp_path, "moodle.csv", [known, unknown])}
    assert found == {"Jörg Müller": "Participant 77", "Ada Lovelace": ""}
    of_moodle = "a download from Moodle"  # in which groups have no numbers of students
    for entries, kind, message in (
        ([known], "", ""),
        ([known, unknown], "", "1 of the 2 students"),
        ([unknown], "", ""),
        ([unknown], of_moodle, "1 of the 1 students"),
    ):
        said = io.StringIO()
        show_result(Console(file=said, width=500), entries, [], kind)
        assert (
            (f"moodle.csv has no Identifier for {message}, so" in said.getvalue())
            if message
            else ("moodle.csv" not in said.getvalue())
        )
