"""A class's grades as files for spreadsheets, learning platforms and CI."""

from __future__ import annotations

import csv
import io
import re
import xml.etree.ElementTree as ET
from collections.abc import Iterable, Sequence
from datetime import datetime, timezone
from html import escape
from pathlib import Path

from grader.checking.verdict import Verdict
from grader.exercise.exercise import Exercise
from grader.grading.grade import Entry, Student
from grader.report.as_json import folder_of, results_json
from grader.report.feedback import shown_checks
from grader.report.printable import printable
from groundwork.files import write_if_changed

Cell = str | float | None

#: A spreadsheet takes a text that begins like this for a formula (OWASP, "CSV Injection").
FORMULA = ("=", "+", "-", "@", "\t", "\r", "\n", "＝", "＋", "－", "＠")

LONGEST_CELL = 20_000


def csv_text(header: Sequence[str], rows: Iterable[Sequence[Cell]]) -> str:
    """Return header and rows as CSV (RFC 4180): quoted if needed, numbers as `number` writes them, None as nothing.

    A text that a spreadsheet would take for a formula gets an apostrophe in front of it. Control characters are
    replaced.
    """
    out = io.StringIO()
    writer = csv.writer(out)
    writer.writerow([_text(name) for name in header])
    writer.writerows(
        [[number(cell) if isinstance(cell, (int, float)) else _text(cell) for cell in row] for row in rows]
    )
    return out.getvalue()


def number(value: float) -> str:
    """Return points with at most two decimals, as learning platforms store them: 81, 80.5, 33.33."""
    return f"{value:.2f}".rstrip("0").rstrip(".")


def _text(cell: str | None) -> str:
    text = printable(cell or "", LONGEST_CELL)
    formula = text.lstrip(" ").startswith(FORMULA) and text.strip() != "-"
    return f"'{text}" if formula else text


def last_and_first(student: Student) -> tuple[str, str]:
    """Return last and first name: "Müller, Jörg" is split at the comma, "Jörg Müller" before the last word."""
    name = student.name.strip()
    if "," in name:
        last, _, first = name.partition(",")
    else:
        first, _, last = name.rpartition(" ")
    return last.strip(), first.strip()


def last_first(student: Student) -> str:
    """Return the name as Canvas sorts it: "Müller, Jörg"; the id of a student without a name."""
    return ", ".join(filter(None, last_and_first(student))) or student.id


def grades(exercise: Exercise, entries: Sequence[Entry]) -> str:
    """Return everything, for people and their spreadsheets: one row per student, one column per check at the end."""
    checks = list(dict.fromkeys(verdict.name for entry in entries for verdict in entry.grade.verdicts))
    header = ["student", "name", "email", "points", "of", "before adjustments", "adjustments", "outcome", "failed"]
    rows: list[list[Cell]] = []
    for entry in entries:
        grade, earned = entry.grade, {verdict.name: verdict.earned for verdict in entry.grade.verdicts}
        host = grade.outcome == "host-error"
        adjustments = "; ".join(f"{a.kind} {a.points:+g}: {a.reason}" for a in entry.adjustments)
        failed = ", ".join(verdict.name for verdict in grade.verdicts if verdict.status == "failed")
        rows.append(
            [
                *(entry.student.id, entry.student.name, entry.student.email, entry.final, grade.points),
                *(None if host else grade.score, adjustments, grade.outcome, failed, grade.message),
                *(entry.file, entry.submitted.isoformat() if entry.submitted else ""),
                *(None if host else earned.get(name) for name in checks),
            ]
        )
    return csv_text([*header, "message", "file", "submitted", *checks], rows)


def nbgrader(exercise: Exercise, entries: Sequence[Entry], due: datetime | None = None) -> str:
    """Return what `nbgrader export` writes (nbgrader/plugins/export.py, CsvExportPlugin): its columns, times in UTC.

    `late_submission_penalty` is what was taken for lateness, `raw_score` the score before that.
    """
    header = ["assignment", "duedate", "timestamp", "student_id", "last_name", "first_name", "email", "raw_score"]
    rows: list[list[Cell]] = []
    for entry in entries:
        last, first = last_and_first(entry.student)
        penalty = -sum(a.points for a in entry.adjustments if a.kind == "late")
        raw = None if entry.final is None else entry.final + penalty
        rows.append(
            [
                *(exercise.name, _utc(due), _utc(entry.submitted), entry.student.id),
                *(last, first, entry.student.email, raw, None if raw is None else penalty),
                *(entry.final, entry.grade.points),
            ]
        )
    return csv_text([*header, "late_submission_penalty", "score", "max_score"], rows)


def canvas(exercise: Exercise, entries: Sequence[Entry]) -> str:
    """Return what Canvas exports and imports (canvas-lms, lib/gradebook_exporter.rb and gradebook_importer.rb).

    The name Canvas has for a student comes from `Student.lms`; Canvas finds students by ID, otherwise by SIS User ID,
    SIS Login ID, name. The assignment's column is the one of `lms` with a name as Canvas gives to assignments,
    "Name (1234)", or otherwise the exercise's title, from which Canvas creates a new assignment. Without a score the
    cell stays empty, and Canvas leaves the grade as it is.
    """
    given = [name for entry in entries for name in entry.student.lms]
    assignment = next((name for name in given if re.fullmatch(r".+ \(\d+\)", name)), exercise.title)
    identity = ["ID", *(["SIS User ID"] if "SIS User ID" in given else []), "SIS Login ID", "Section"]
    points = entries[0].grade.points if entries else exercise.points
    rows: list[list[Cell]] = [["    Points Possible", *[None] * len(identity), points]]
    for entry in entries:
        lms = entry.student.lms
        login = lms.get("SIS Login ID", "" if "ID" in lms else entry.student.id)
        cells = {**lms, "SIS Login ID": login}
        name = lms.get("Student") or last_first(entry.student)
        rows.append([name, *(cells.get(column, "") for column in identity), entry.final])
    return csv_text(["Student", *identity, assignment], rows)


def moodle(exercise: Exercise, entries: Sequence[Entry]) -> str:
    """Return Moodle's offline grading worksheet (mod/assign/feedback/offline/importgradeslib.php), ready to upload.

    Moodle finds students by Identifier, "Participant 1234567", which is only in Moodle's own download or a table: it is
    empty if neither had it, and Moodle then does not find the student. It leaves out a row whose grade is above the
    maximum, so extra credit is cut off there, which the comment says; and a row without a grade, so a fault of ours
    changes nothing. Columns of a worksheet that was read are returned as they were.
    """
    columns = ["Identifier", "Full name", "Email address", "Status", "Grade", "Maximum Grade"]
    columns += ["Grade can be changed", "Last modified (submission)", "Last modified (grade)", "Feedback comments"]
    rows: list[list[Cell]] = []
    for entry in entries:
        final, points = entry.final, entry.grade.points
        cells: dict[str, Cell] = {
            "Identifier": "",
            "Full name": entry.student.name,
            "Email address": entry.student.email,
            "Status": "Submitted for grading",
            "Grade can be changed": "Yes",
            "Last modified (submission)": "-",
            "Last modified (grade)": "-",
            **{name: value for name, value in entry.student.lms.items() if name in columns},
            "Grade": None if final is None else min(final, points),
            "Maximum Grade": points,
            "Feedback comments": _comment(entry),
        }
        rows.append([cells[column] for column in columns])
    return csv_text(columns, rows)


def unknown_to_moodle(entries: Sequence[Entry]) -> int:
    """Return how many students Moodle can't find, because their Moodle identifier is unknown."""
    return sum(not entry.student.lms.get("Identifier") for entry in entries)


def _comment(entry: Entry) -> str:
    """Return what a student reads on a platform, as the HTML that Moodle expects in comments."""
    grade, final = entry.grade, entry.final
    if final is None:
        return ""
    lines = [f"{number(final)} of {number(grade.points)} points."]
    lines += [f"{a.points:+g}: {a.reason}" for a in entry.adjustments]
    if grade.message:
        lines.append(grade.message[:500])
    for check in shown_checks(grade):
        if check.status == "failed" and (check.finding or check.hint):
            lines.append(f"✗ {check.title}" + (f" Hint: {check.hint}" if check.hint else ""))
    return "<br>".join(escape(line) for line in lines)


def _utc(moment: datetime | None) -> str:
    return str(moment.astimezone(timezone.utc).replace(tzinfo=None)) if moment else ""


# For the instructor alone: it names hidden checks, and says why they fail.


def junit(exercise: Exercise, entries: Sequence[Entry]) -> str:
    """Return all entries as one JUnit XML document (the form that Jenkins and pytest share).

    A blocked check is skipped. A run that did not complete is one more test case, `outcome`, that failed; a fault of
    ours is one with an error.
    """
    root = ET.Element("testsuites", name=exercise.name)
    for entry in entries:
        root.append(_suite(exercise, entry))
    for name in ("tests", "failures", "errors", "skipped"):
        root.set(name, str(sum(int(suite.get(name, "0")) for suite in root)))
    ET.indent(root)
    return '<?xml version="1.0" encoding="utf-8"?>\n' + ET.tostring(root, encoding="unicode") + "\n"


def _suite(exercise: Exercise, entry: Entry) -> ET.Element:
    grade = entry.grade
    suite = ET.Element("testsuite", name=printable(entry.student.id), time=f"{grade.seconds:.3f}")
    if entry.submitted:
        suite.set("timestamp", entry.submitted.isoformat(timespec="seconds"))
    if grade.outcome != "graded":
        case = ET.SubElement(suite, "testcase", classname=exercise.name, name="outcome")
        ET.SubElement(
            case,
            "error" if grade.outcome == "host-error" else "failure",
            type=grade.outcome,
            message=_xml_text(grade.message),
        )
    if grade.outcome != "host-error":
        for verdict in grade.verdicts:
            suite.append(_case(exercise, verdict))
    for name, tags in (("failures", "failure"), ("errors", "error"), ("skipped", "skipped")):
        suite.set(name, str(len(suite.findall(f"testcase/{tags}"))))
    suite.set("tests", str(len(suite.findall("testcase"))))
    return suite


def _case(exercise: Exercise, verdict: Verdict) -> ET.Element:
    case = ET.Element("testcase", classname=exercise.name, name=verdict.name)
    if verdict.status == "failed":
        text = verdict.finding.text if verdict.finding else ""
        ET.SubElement(case, "failure", message=_xml_text(verdict.title)).text = _xml_text(
            f"{text}\nHint: {verdict.hint}"
        )
    elif verdict.status == "blocked":
        ET.SubElement(case, "skipped", message=_xml_text("blocked by " + ", ".join(verdict.blocked_by)))
    elif verdict.status == "error":
        ET.SubElement(case, "error", message=_xml_text(verdict.error))
    return case


def _xml_text(text: str) -> str:
    """Return the text without the characters that XML can't contain."""
    return printable(text, 20_000)


#: Excel reads a CSV file as UTF-8 only if it begins with this. Only in the file for people.
BYTE_ORDER_MARK = "\ufeff"


def write_gradebook(
    results: Path, exercise: Exercise, entries: Sequence[Entry], due: datetime | None = None
) -> tuple[Path, ...]:
    """Write a class's grades into the folder `results`, and return the files, in order of students' ids.

    `grades.csv`, `nbgrader.csv`, `canvas.csv`, `moodle.csv`, `junit.xml`, and in each student's folder `results.json`
    for Gradescope. `due` is when the work was due, which nbgrader's file contains. Each is written whole or not at all.
    Raises OSError when the folder can't be written.
    """
    contents = gradebook(results, exercise, entries, due)
    for file, content in contents.items():
        write_if_changed(file, content, durable=True)
    return tuple(contents)


def gradebook(
    results: Path, exercise: Exercise, entries: Sequence[Entry], due: datetime | None = None
) -> dict[Path, str]:
    """Return what `write_gradebook` writes: the content of each file."""
    ordered = sorted(entries, key=lambda entry: entry.student.id)
    return {
        results / "grades.csv": BYTE_ORDER_MARK + grades(exercise, ordered),
        results / "nbgrader.csv": nbgrader(exercise, ordered, due),
        results / "canvas.csv": canvas(exercise, ordered),
        results / "moodle.csv": moodle(exercise, ordered),
        results / "junit.xml": junit(exercise, ordered),
        **{folder_of(results, entry.student.id) / "results.json": results_json(entry) for entry in ordered},
    }
