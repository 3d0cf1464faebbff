"""Tables that instructors and spreadsheets write are read as they are, or refused with the line: nobody is lost."""

from __future__ import annotations

import csv
import re
from datetime import datetime, timezone
from pathlib import Path

import plain_grades as plain
import pytest
from classes import collected, folder

from grader.classroom.formats import moodle
from grader.classroom.formats.moodle_languages import COLUMNS, LANGUAGES
from grader.classroom.groups import read_groups
from grader.classroom.roster import read_roster, with_row
from grader.classroom.submissions import SubmissionsError
from grader.classroom.tables import csv_text
from grader.grading.grade import Student

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
    "a spreadsheet": (b"PK\x03\x04\xb3", "it is a spreadsheet. Save it as CSV in UTF-8"),
    "a number as Excel shows it": (
        b"student\n1.23457E+12\n",
        "2: 1.23457E+12 is a number that a spreadsheet has shortened",
    ),
    "Latin-1": ("student\nMüller\n".encode("latin-1"), "Save it as CSV in UTF-8"),
    "a name with a comma": (
        b"student,name\nanna,Lee, Anna\n",
        "2: 3 values for 2 columns. Put a value that has a comma",
    ),
    "a quotation mark": (b'student,name\n"anna,Anna\nbert,Bert\n', "Is a quotation mark missing?"),
    "a column twice": (b"student,student\nanna,bert\n", "1: two columns are called 'student'"),
    "no student": (b"name,points\nAnna,3\n", "2: nothing in this row says who it is. Fill in a column student"),
    "nobody in a row": (b"student,name\nanna,Anna\n,Bert\n", "3: nothing in this row says who it is."),
    "two students with one id": (b"student,name\n007,Anna\n007,Bert\n", "3: 007 is 'Bert' here and 'Anna' above."),
    "a time": (b"student,submitted\nanna,11/12/2026 10:00\n", "2: submitted = '11/12/2026 10:00'. Write it as"),
    "Moodle in another language": (
        b"Identyfikator;Nazwa;Status\nUczestnik 7;Anna;x\n",
        "with English or one of ca, de, es, fr, it, ja, nl, pt, ru, sv, zh_cn as your language there",
    ),
}


@pytest.mark.parametrize(("content", "message"), REFUSED.values(), ids=REFUSED)
def test_a_roster_that_would_lose_somebody_is_refused(content: bytes, message: str, tmp_path: Path) -> None:
    (tmp_path / "roster.csv").write_bytes(content)
    with pytest.raises(SubmissionsError) as refused:
        read_roster(tmp_path / "roster.csv", None)
    assert message in str(refused.value)


TIMES = {
    "ca": "diumenge, 22 de novembre 2026, 23:59",
    "de": "Sonntag, 22. November 2026, 23:59",
    "es": "domingo, 22 de noviembre de 2026, 23:59",
    "fr": "dimanche 22 novembre 2026, 23:59",
    "it": "domenica, 22 novembre 2026, 23:59",
    "ja": "2026年 11月 22日(日曜日) 23:59",
    "nl": "zondag, 22 november 2026, 23:59",
    "pt": "domingo, 22 de novembro de 2026 às 23:59",
    "ru": "воскресенье, 22 ноября 2026, 23:59",
    "sv": "söndag, 22 november 2026, 23:59",
    "zh_cn": "2026年11月22日 星期日 23:59",
}


@pytest.mark.parametrize("language", LANGUAGES)
def test_moodles_worksheet_may_be_in_another_language(language: str, tmp_path: Path) -> None:
    with (tmp_path / "roster.csv").open("w", encoding="utf-8-sig") as file:
        columns = [LANGUAGES[language][name] for name in COLUMNS]
        csv.writer(file).writerows(
            [columns, ["X 77", "Anna Lee", "a@x.org", "x", "", 50, "x", TIMES[language], "-", ""]]
        )
    (row,) = read_roster(tmp_path / "roster.csv", timezone.utc)
    assert (row.student.id, row.student.name, row.student.email) == ("Anna Lee_77", "Anna Lee", "a@x.org")
    assert row.time.at == datetime(2026, 11, 22, 23, 59, tzinfo=timezone.utc)
    # Moodle reads its own table back only in the same language.
    student = with_row(Student("Anna Lee_77", "", "", {"Identifier": "Participant 77"}), row)
    back = list(csv.reader(moodle.table(plain.exercise(), [plain.entry(plain.RIGHT, student)]).splitlines()))
    assert back[0] == columns
    assert (back[1][0], back[1][7]) == ("X 77", TIMES[language])


@pytest.mark.parametrize(
    ("time", "fault"), [("22. Fevruar 2026, 23:59", "Last modified"), ("30. Februar 2026, 23:59", "Last modified")]
)
def test_a_time_in_it_that_can_not_be_read_is_an_error(time: str, fault: str, tmp_path: Path) -> None:
    names = [LANGUAGES["de"][name] for name in ("Identifier", "Full name", "Status", "Last modified (submission)")]
    (tmp_path / "roster.csv").write_text(";".join(names) + f"\nTeilnehmer/in 7;Anna;x;{time}\n", encoding="utf-8")
    with pytest.raises(SubmissionsError, match=fault):
        read_roster(tmp_path / "roster.csv", None)


GROUPS = {
    "members in one cell": ("A,anna; bert", "2: student = 'anna; bert'. Write one row per member."),
    "a group in two spellings": ("Team,anna\nteam,bert", "3: the group 'team' is 'Team' above."),
    "a student in two groups": ("A,anna\nB,anna", "3: 'anna' is also in group 'A'."),
    "a group without a student": ("A,", "2: group = 'A', student = ''. Give both."),
}


@pytest.mark.parametrize(("rows", "message"), GROUPS.values(), ids=GROUPS)
def test_groups_that_would_lose_somebody_are_refused(rows: str, message: str, tmp_path: Path) -> None:
    (tmp_path / "groups.csv").write_text(f"group,student\n{rows}\n")
    with pytest.raises(SubmissionsError, match=re.escape(message)):
        read_groups(tmp_path / "groups.csv")


@pytest.mark.parametrize("language", ["", "de"])
def test_moodles_worksheet_has_no_names_in_blind_marking(language: str, tmp_path: Path) -> None:
    columns = [LANGUAGES.get(language, {}).get(name, name) for name in COLUMNS if name not in COLUMNS[1:3]]
    label = {"": "Participant", "de": "Teilnehmer/in"}[language]
    rows = [[f"{label} {number}", "x", "", 50, "x", "2026-11-22 23:59", "-", ""] for number in (7, 8)]
    with (tmp_path / "roster.csv").open("w", encoding="utf-8-sig") as file:
        csv.writer(file).writerows([columns, *rows])
    names = [f"{label.replace('/', '')}_{number}_assignsubmission_file/node.py" for number in (7, 8)]
    roster = read_roster(tmp_path / "roster.csv", timezone.utc)
    found = collected(folder(tmp_path / "class", names), roster=roster)
    assert ([one.file.name for one in found.handed_in], found.missing, found.mismatches) == (names, (), {})
    assert found.handed_in[0].file.submitted == datetime(2026, 11, 22, 23, 59, tzinfo=timezone.utc)


def test_columns_of_our_own_tables_may_be_in_any_case(tmp_path: Path) -> None:
    (tmp_path / "groups.csv").write_text("Group;STUDENT\nA;anna\nA;bert\n")
    (group,) = read_groups(tmp_path / "groups.csv")
    assert (group.name, [member.id for member in group.members]) == ("A", ["anna", "bert"])


def test_a_worksheet_comes_back_with_all_its_columns_and_names(tmp_path: Path) -> None:
    columns = [*COLUMNS[:2], "ID number", *COLUMNS[2:]]
    values = ["Participant 77", "An Nguy\u1ec5n\u3000V\u0103n\u200c", "0042", *[""] * 7, "old comment"]
    with (tmp_path / "roster.csv").open("w", encoding="utf-16") as file:
        csv.writer(file, delimiter=";").writerows([columns, values])
    (row,) = read_roster(tmp_path / "roster.csv", None)
    student = with_row(Student("x_77", "x", "", {"Identifier": "Participant 77", "Full name": "x"}), row)
    back = list(csv.reader(moodle.table(plain.exercise(), [plain.entry(plain.RIGHT, student)]).splitlines()))
    assert (back[0], back[1][:3]) == (columns, values[:3])
    assert csv_text(["a\u00a0b\u202ec"], []) == "a\u00a0b<U+202E>c\r\n"
