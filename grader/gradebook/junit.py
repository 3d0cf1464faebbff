"""JUnit XML: a test suite a student, a test case a check.

For the instructor alone: it names hidden checks, and tells why they fail.
"""

from __future__ import annotations

import xml.etree.ElementTree as ET
from collections.abc import Sequence

from grader.checking.verdict import Verdict
from grader.classroom.entry import Entry
from grader.exercise import Exercise
from grader.report.printable import printable


def junit(exercise: Exercise, entries: Sequence[Entry]) -> str:
    """All entries as one JUnit XML document (the form that Jenkins and pytest share).

    A blocked check is skipped. A run that did not come through is one more test case, `outcome`, that failed; a
    fault of ours is one with an error.
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
            message=_text(grade.message),
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
        ET.SubElement(case, "failure", message=_text(verdict.title)).text = _text(f"{text}\nHint: {verdict.hint}")
    elif verdict.status == "blocked":
        ET.SubElement(case, "skipped", message=_text("blocked by " + ", ".join(verdict.blocked_by)))
    elif verdict.status == "error":
        ET.SubElement(case, "error", message=_text(verdict.error))
    return case


def _text(text: str) -> str:
    """What XML can hold."""
    return printable(text, 20_000)
