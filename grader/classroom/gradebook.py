"""A class's grades as files for spreadsheets, learning platforms and CI."""

from __future__ import annotations

import contextlib
import xml.etree.ElementTree as ET
from collections.abc import Sequence
from datetime import datetime
from pathlib import Path

from grader.checking.verdict import Verdict
from grader.classroom.formats.registry import TABLES
from grader.classroom.tables import BYTE_ORDER_MARK, Cell, csv_text
from grader.exercise.exercise import Exercise
from grader.grading.grade import Entry
from grader.report.as_json import folder_of, results_json
from grader.report.printable import printable
from groundwork.files import write_if_changed


def grades(exercise: Exercise, entries: Sequence[Entry]) -> str:
    """Return the complete table for spreadsheets: one row per student, with one column per check at the end."""
    checks = list(dict.fromkeys(verdict.name for entry in entries for verdict in entry.grade.verdicts))
    header = ["student", "name", "email", "points", "of", "before adjustments", "adjustments", "outcome", "failed"]
    rows: list[list[Cell]] = []
    for entry in entries:
        grade, earned = entry.grade, {verdict.name: verdict.earned for verdict in entry.grade.verdicts}
        adjustments = "; ".join(f"{a.kind} {a.points:+g}: {a.reason}" for a in entry.adjustments)
        failed = ", ".join(verdict.name for verdict in grade.verdicts if verdict.status == "failed")
        rows.append(
            [
                *(entry.student.id, entry.student.name, entry.student.email, entry.final, grade.points),
                *(grade.score if grade.has_score else None, adjustments, grade.outcome, failed, grade.message),
                *(entry.file, entry.submitted.isoformat() if entry.submitted else ""),
                *(earned.get(name) if grade.has_score else None for name in checks),
            ]
        )
    return csv_text([*header, "message", "file", "submitted", *checks], rows)


def junit(exercise: Exercise, entries: Sequence[Entry]) -> str:
    """Return all entries as one JUnit XML document, in the form that Jenkins and pytest share. It is for the instructor
    only, as it names hidden checks and says why they fail.

    A blocked check is skipped. A run that did not complete has an additional test case, `outcome`, which failed; a
    fault of ours is an error there.
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
            case, "failure" if grade.has_score else "error", type=grade.outcome, message=_xml_text(grade.message)
        )
    if grade.has_score:
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
            f"{text}\nHint: {(verdict.finding and verdict.finding.where) or verdict.hint}"
        )
    elif verdict.status == "blocked":
        ET.SubElement(case, "skipped", message=_xml_text("blocked by " + ", ".join(verdict.blocked_by)))
    elif verdict.status == "error":
        ET.SubElement(case, "error", message=_xml_text(verdict.error))
    return case


def _xml_text(text: str) -> str:
    """Return the text without the characters that XML can't contain."""
    return printable(text, 20_000)


def write_gradebook(
    results: Path, exercise: Exercise, entries: Sequence[Entry], due: datetime | None
) -> tuple[Path, ...]:
    """Write a class's grades into the folder `results`, and return the files, sorted by student id.

    `grades.csv`, a table for each platform that imports one, `junit.xml`, and in each student's folder `results.json`
    for Gradescope. nbgrader's table contains the due date, `due`. Each file is written completely or not at all.
    Raises OSError if the folder can't be written.
    """
    contents = gradebook(results, exercise, entries, due)
    # These may be host errors because their results could not be written.
    faulty = {folder_of(results, entry.student.id) for entry in entries if entry.grade.outcome == "host-error"}
    for file, content in contents.items():
        with contextlib.suppress(OSError) if file.parent in faulty else contextlib.nullcontext():
            write_if_changed(file, content, durable=True)
    return tuple(contents)


def gradebook(
    results: Path, exercise: Exercise, entries: Sequence[Entry], due: datetime | None = None
) -> dict[Path, str]:
    """Return the content of each file that `write_gradebook` writes."""
    ordered = sorted(entries, key=lambda entry: entry.student.id)
    return {
        results / "grades.csv": BYTE_ORDER_MARK + grades(exercise, ordered),
        **{results / table.file: table.content(exercise, ordered, due) for table in TABLES},
        results / "junit.xml": junit(exercise, ordered),
        **{folder_of(results, entry.student.id) / "results.json": results_json(entry) for entry in ordered},
    }
