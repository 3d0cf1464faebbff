"""Tables that instructors and spreadsheets write are read as they are, or refused with the line: nobody is lost."""

from __future__ import annotations

from pathlib import Path

import pytest

from grader.classroom.groups import read_groups
from grader.classroom.roster import read_roster
from grader.classroom.submissions import SubmissionsError

READ = {
    "commas": b"student,name\nanna,Anna\n",
    "semicolons, with a byte order mark and line ends of Windows": "\ufeffstudent;name\r\nanna;Anna\r\n".encode(),
    "tabs in UTF-16": "student\tname\nanna\tAnna\n".encode("utf-16"),
    "Excel's hint": b"sep=;\nstudent;name\nanna;Anna\n",
    "line ends of an old Macintosh": b"student,name\ranna,Anna\r",
    "empty lines": b"\n\nstudent,name\n,\nanna,Anna\n",
    "capitals": b"Student,Name\nanna,Anna\n",
    "another column": b"Login,Full name\nanna,Anna\n",
    "names in two columns": b"First name,Last name,Username\nAnna,,anna\n",
    "a title": b"Lab 3,Points\n\nstudent,name\nanna,Anna\n",
    "more separators than columns": b"student,name,,\nanna,Anna,,,,\n",
}


@pytest.mark.parametrize("content", READ.values(), ids=READ)
def test_a_roster_is_read_as_spreadsheets_save_it(content: bytes, tmp_path: Path) -> None:
    (tmp_path / "roster.csv").write_bytes(content)
    assert [(row.student.id, row.student.name) for row in read_roster(tmp_path / "roster.csv", None)] == [
        ("anna", "Anna")
    ]


REFUSED = {
    "nothing": (b"", "it has no rows below its columns"),
    "columns alone": (b"student,name\n", "it has no rows below its columns"),
    "a spreadsheet": (b"PK\x03\x04\x00", "it is not a text file. Save it as CSV in UTF-8"),
    "Latin-1": ("student\nMüller\n".encode("latin-1"), "Save it as CSV in UTF-8"),
    "a name with a comma": (
        b"student,name\nanna,Lee, Anna\n",
        "2: 3 values for 2 columns. Put a value that has a comma",
    ),
    "a quotation mark": (b'student,name\n"anna,Anna\nbert,Bert\n', "Is a quotation mark missing?"),
    "a column twice": (b"student,student\nanna,bert\n", "1: two columns are called 'student'"),
    "no student": (b"name,points\nAnna,3\n", "2: no column says who this is. Add a column student"),
    "a time": (b"student,submitted\nanna,11/12/2026 10:00\n", "2: submitted = '11/12/2026 10:00'. Write it as"),
    "Moodle in German": (
        "ID;Vollständiger Name\nTeilnehmer/in7;Anna\n".encode(),
        "with English as your language there",
    ),
}


@pytest.mark.parametrize(("content", "message"), REFUSED.values(), ids=REFUSED)
def test_a_roster_that_would_lose_somebody_is_refused(content: bytes, message: str, tmp_path: Path) -> None:
    (tmp_path / "roster.csv").write_bytes(content)
    with pytest.raises(SubmissionsError) as refused:
        read_roster(tmp_path / "roster.csv", None)
    assert message in str(refused.value)


def test_columns_of_our_own_tables_may_be_in_any_case(tmp_path: Path) -> None:
    (tmp_path / "groups.csv").write_text("Group;STUDENT\nA;anna\nA;bert\n")
    (group,) = read_groups(tmp_path / "groups.csv")
    assert (group.name, [member.id for member in group.members]) == ("A", ["anna", "bert"])
