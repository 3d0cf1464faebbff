"""The list of the class's students: an instructor's table, or the list that a platform exports."""

from __future__ import annotations

import re
from collections import defaultdict
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from datetime import tzinfo
from functools import cache
from pathlib import Path

from grader.classroom.formats.format import person
from grader.classroom.formats.moodle_languages import LANGUAGE, LANGUAGES, in_english, time_in_english
from grader.classroom.formats.registry import PLATFORMS
from grader.classroom.names import comparable, normal, student_id
from grader.classroom.submissions import SubmissionsError
from grader.classroom.tables import platform_rows
from grader.classroom.times import UNKNOWN, Time, read_time
from grader.grading.grade import Student

#: Columns in which platforms identify students.
IDENTITY = {
    *("ID", "Identifier", "Username", "EID", "Display ID", "SID", "Login", "UserID", "OrgDefinedId", "Email address"),
    *("SIS User ID", "SIS Login ID", "Email", "student", "login", "username"),
}

#: Columns that say who a student is, in a table that is not a platform's.
WHO = ("student", "username", "login", "email", "email address")

#: What spreadsheets make of long numbers.
SHORTENED = re.compile(r"\d([.,]\d+)?E\+\d+")

#: The column with the time of submission, in our own table and in Moodle's grading worksheet.
SUBMITTED = ("submitted", "Last modified (submission)")


@dataclass(frozen=True)
class RosterRow:
    """A student of the class, and the time of submission, if the table has it."""

    student: Student
    time: Time = UNKNOWN


def read_roster(table: Path, zone: tzinfo | None) -> tuple[RosterRow, ...]:
    """Return the students in a table with the column student, and optionally name, email, submitted and others, or in a
    list that a platform has exported. Instead of student, a column may be called username, login or email. Times
    without a zone are in `zone`.

    Raises `SubmissionsError` for a table that has none of these columns, and for a row with a mistake.
    """
    rows: dict[str, RosterRow] = {}
    for number, row in platform_rows(table, lambda columns: _student(in_english(columns)) is not None):
        row = in_english(row)
        student = _student(row)
        if student is None:
            raise SubmissionsError(
                f"{table}:{number}: nothing in this row says who it is. Fill in a column student, or give the "
                "list of students, grades or submissions that your platform exports (Moodle's worksheet: with English "
                f"or one of {', '.join(LANGUAGES)} as your language there). The columns are: {', '.join(row)}."
            )
        if SHORTENED.fullmatch(student.id):
            raise SubmissionsError(
                f"{table}:{number}: {student.id} is a number that a spreadsheet has shortened. Format its column as "
                "text, write the whole numbers, and save it as CSV again."
            )
        if student.id:  # a student in two sections is listed twice
            listed = rows.setdefault(student.id, RosterRow(student, _time(row, f"{table}:{number}", zone)))
            if listed.student.name != student.name:
                raise SubmissionsError(
                    f"{table}:{number}: {student.id} is {student.name!r} here and {listed.student.name!r} above. Two "
                    "students can't share an id: correct one of the rows."
                )
    return tuple(rows.values())


def _student(row: Mapping[str, str]) -> Student | None:
    if {"Student", "ID", "Section"} <= row.keys() and (row["Student"] == "Student, Test" or not row["ID"].isdigit()):
        return Student("")  # Canvas's own rows
    known = next((student for form in PLATFORMS if form.of_row and (student := form.of_row(row))), None)
    own = {name.casefold(): value for name, value in row.items()}
    who = next((own[name] for name in WHO if own.get(name)), "")
    name = own.get("name") or own.get("full name") or " ".join(filter(None, map(own.get, ("first name", "last name"))))
    email = own.get("email") or own.get("email address", "")
    return known or (generic_student({**row, "student": who, "name": name, "email": email}) if who else None)


def generic_student(row: Mapping[str, str]) -> Student:
    """Return the student in a row of a table in our own format."""
    lms = {name: value for name, value in row.items() if name not in ("student", "name", "email", "group", "submitted")}
    return person(row["student"], row.get("name", ""), row.get("email", ""), **lms)


def _time(row: Mapping[str, str], place: str, zone: tzinfo | None) -> Time:
    column = next((name for name in SUBMITTED if row.get(name, "").strip() not in ("", "-")), "")
    if not column:
        return UNKNOWN
    source = "the roster" if column == "submitted" else "Moodle's worksheet"
    time = read_time(time_in_english(row[column], row.get(LANGUAGE, "")), source, zone, zone)
    if time.fault:
        raise SubmissionsError(f"{place}: {column} = {row[column]!r}. Write it as 2026-11-22 23:59.")
    return time


@cache
def signs(student: Student) -> frozenset[str]:
    """Return what identifies a student among the members of groups: ids, addresses, numbers and names."""
    return frozenset(_keys(student) | _ids(student) | _names(student))


@cache
def _keys(student: Student) -> set[str]:
    known = [student.id, student.email, *(value for name, value in student.lms.items() if name in IDENTITY)]
    return {normal(key).strip().casefold() for key in known} - {""}


@cache
def _ids(student: Student) -> set[str]:
    """Return the id as in the export, and as the name of the student's results folder."""
    return {normal(student.id).casefold(), student_id(student.id).casefold()}


@cache
def _names(student: Student) -> set[str]:
    """Return the name with its words sorted, and with only its letters and digits, as platforms vary both."""
    words = re.split(r"[\s,_]+", normal(student.name or student.id).casefold())
    return {" ".join(sorted(filter(None, words))), comparable(student.name or student.id)} - {""}


def match(rows: Sequence[RosterRow], students: Sequence[Student]) -> dict[str, RosterRow]:
    """Return the row of each student who has one, by the student's id.

    A student is matched by a number, an address or the id. Otherwise the name decides, if only one student and one row
    have it. Raises `SubmissionsError` if several have it.
    """
    matched = _match_by(_keys, rows, students)
    matched |= _match_by(_ids, *_unmatched(rows, students, matched))
    return matched | _match_by_name(*_unmatched(rows, students, matched))


def _unmatched(
    rows: Sequence[RosterRow], students: Sequence[Student], matched: Mapping[str, RosterRow]
) -> tuple[list[RosterRow], list[Student]]:
    used = {id(row) for row in matched.values()}
    return [row for row in rows if id(row) not in used], [one for one in students if one.id not in matched]


def _match_by(
    keys: Callable[[Student], set[str]], rows: Sequence[RosterRow], students: Sequence[Student]
) -> dict[str, RosterRow]:
    """Return the row that shares one of its `keys` with a student, by the student's id."""
    rows_by_key = {key: row for row in rows for key in keys(row.student)}
    shared = {student.id: sorted(keys(student) & rows_by_key.keys()) for student in students}
    return {student: rows_by_key[common[0]] for student, common in shared.items() if common}


def _match_by_name(rows: Sequence[RosterRow], students: Sequence[Student]) -> dict[str, RosterRow]:
    rows_by_name = _by_name([row.student for row in rows])
    students_by_name = _by_name(students)
    matched: dict[str, RosterRow] = {}
    for student in students:
        same_rows = {number for name in _names(student) for number in rows_by_name[name]}
        namesakes = {number for name in _names(student) for number in students_by_name[name]}
        if len(same_rows) == 1 and len(namesakes) == 1:
            matched[student.id] = rows[same_rows.pop()]
        elif same_rows:
            raise SubmissionsError(
                f"{student.name or student.id}: several students have this name, and the roster does not say which of "
                "them handed this in. Give it a column that the export has, too, such as student, ID or email."
            )
    return matched


def _by_name(students: Sequence[Student]) -> dict[str, list[int]]:
    """Return the students' indices by each of their names."""
    by_name: dict[str, list[int]] = defaultdict(list)
    for number, student in enumerate(students):
        for name in _names(student):
            by_name[name].append(number)
    return by_name


def with_row(student: Student, row: RosterRow | None) -> Student:
    """Return the student with the roster's data; the id stays the same."""
    if not row:
        return student
    listed = row.student
    return replace(
        student,
        name=listed.name or student.name,
        email=listed.email or student.email,
        lms={
            **listed.lms,
            **student.lms,
            **{name: listed.lms[name] for name in ("Identifier", "Full name") if name in listed.lms},
        },
    )
