"""Whatever a student is called, and wherever the name was typed: one student is one row, and two are two."""

from __future__ import annotations

import unicodedata
import zipfile
from pathlib import Path

import pytest
from classes import archive, collected, files, folder

from grader.classroom.names import student_id, unique_ids


@pytest.mark.parametrize(
    "name",
    ["Zoë", "Zoé", "Nguyễn", "हिन्दी", "สมชาย ศรีสุข", "مُحَمَّد", "ক্ষুদ্র", "Ångström", "क्\u200dष", "李明", "김민준"],
)
def test_marks_are_part_of_a_name_and_all_ways_to_write_them_are_one(name: str) -> None:
    assert student_id(name) == unicodedata.normalize("NFC", name).replace(" ", "_")
    assert student_id(unicodedata.normalize("NFD", name)) == student_id(name)


@pytest.mark.parametrize(
    ("name", "expected"),
    [
        ("Müller, Jörg", "Müller_Jörg"),
        ('O\'Neil "Bo"', "O_Neil_Bo"),
        ("-rf", "-rf"),
        ("CON", "CON"),
        ("\u202egnp.exe", "gnp.exe"),
        ("../../etc", "etc"),
        ("a\nb\x1b[2J", "a_b_2J"),
        ("...", "nameless"),
        ("😀", "nameless"),
    ],
)
def test_everything_else_becomes_an_underscore(name: str, expected: str) -> None:
    assert student_id(name) == expected


def test_no_two_names_share_an_id() -> None:
    names = [
        "Anna Müller",
        "Anna_Müller",
        "Anna  Müller",
        "anna müller",
        "😀",
        "😁",
        "x" * 200,
        "x" * 201,
        "Zoé",
        "Zoë",
    ]
    ids = unique_ids([*names, unicodedata.normalize("NFD", "Zoé")])
    assert len(ids) == len(names)
    assert len({one.casefold() for one in ids.values()}) == len(names)
    assert max(len(one.encode()) for one in ids.values()) <= 120
    assert (ids["Zoé"], ids["Zoë"]) == ("Zoé", "Zoë")


def test_a_mac_and_windows_write_one_student(tmp_path: Path) -> None:
    for form in ("NFC", "NFD"):
        name = unicodedata.normalize(form, "Zoé Lefèvre")
        source = archive(tmp_path / f"{form}.zip", [f"{name}.py", "Zoë Lefèvre/node.py"])
        assert list(files(collected(source))) == ["Zoé_Lefèvre", "Zoë_Lefèvre"]


def test_a_mac_names_files_in_utf_8_without_saying_so(tmp_path: Path) -> None:
    source = tmp_path / "class.zip"
    with zipfile.ZipFile(source, "w") as out:
        out.writestr("Jürgen.py", "")
        out.writestr("bert.py", "")
    content = source.read_bytes()  # the flag that says UTF-8 is bit 11
    for mark, offset in ((b"PK\x03\x04", 7), (b"PK\x01\x02", 9)):
        at = content.index(mark)
        content = content[: at + offset] + b"\0" + content[at + offset + 1 :]
    source.write_bytes(content)
    assert "Jürgen" in files(collected(source))


def test_a_file_whose_name_says_nothing_still_has_a_row(tmp_path: Path) -> None:
    source = folder(
        tmp_path / "class", ["anna.PY", "bert.py.txt", "carl.IPYNB", "dora.ipynb.json", "emil.tar.gz", "fay/x.cpp"]
    )
    found = collected(source)
    assert list(files(found)) == ["anna", "bert", "carl", "dora", "emil", "fay"]
    assert found.notes == ("handed in, but not one of .py, .ipynb, .zip: fay/x.cpp",)
