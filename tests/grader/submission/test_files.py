"""A file is read whatever its name ends with; one that can't be read is named in a sentence that says what to do."""

from __future__ import annotations

import gzip
import json
import sys
from pathlib import Path

import pytest
from student_work import IMPORTS, NODE, PROGRAM, cell, notebook, zipped

from grader.exercise import Exercise
from grader.grading.grading import Grading
from grader.submission import NoSubmission, read
from grader.submission.code import NO_CPP
from grader.submission.file_kinds import can_be_read
from grader.submission.program_choice import digest_of
from grader.submission.python_code import normalized
from grader.submission.python_version import newer_name, newer_syntax, running
from grader.submission.reader import of_content

NAMES = {
    "heartbeat.py": PROGRAM.encode(),
    "HEARTBEAT.PY": PROGRAM.encode(),
    "heartbeat.py.txt": PROGRAM.encode(),
    "heartbeat.Py.TXT": PROGRAM.encode(),
    "heartbeat.py.py": PROGRAM.encode(),
    "heartbeat (1).py": PROGRAM.encode(),
    "heartbeat.py (1)": PROGRAM.encode(),
    "heartbeat.py.download": PROGRAM.encode(),
    "heartbeat.py(2)": PROGRAM.encode(),
    "heartbeat.py - Kopie": PROGRAM.encode(),
    "heartbeat.py.bak": PROGRAM.encode(),
    "heartbeat.txt": PROGRAM.encode(),
    "heartbeat": PROGRAM.encode(),
    "week3.ipynb": PROGRAM.encode(),
    "week3.IPYNB": notebook(NODE),
    "week3.ipynb.json": notebook(NODE),
    "week3.ipynb.txt": notebook(NODE),
    "week3.json": notebook(NODE),
    "week3.py": notebook(NODE),
    "all.ZIP": zipped({"HEARTBEAT.PY": PROGRAM}),
    "all.zip.zip": zipped({"heartbeat.py.txt": PROGRAM}),
    "week3.zip.txt": zipped({"week3.IPYNB": notebook(NODE)}),
    "renamed.py": zipped({"heartbeat.py": PROGRAM}),
    "heartbeat.py.gz": gzip.compress(PROGRAM.encode()),
    "of names without a suffix.zip": zipped({"bin/heartbeat": PROGRAM, "README": "mine"}),
    "of text.zip": zipped({"heartbeat.txt": PROGRAM, "plot.py": "import matplotlib\n"}),
    "of JSON.zip": zipped({"week3.json": notebook(NODE)}),
    "of a notebook as .py.zip": zipped({"week3.py": notebook(NODE)}),
    "of a program as .ipynb.zip": zipped({"week3.ipynb": PROGRAM}),
    "of a large notebook.zip": zipped(
        {"week3.ipynb": notebook(cell(NODE, outputs=[{"output_type": "stream", "text": "x" * 5_000_000}]))}
    ),
    "from a chat.py": f"Here is the code:\n\n```python\n{PROGRAM}```\n\nIt beats.\n".encode(),
}


@pytest.mark.parametrize("name", NAMES)
def test_any_suffix_in_any_case_is_read(name: str, tmp_path: Path, exercise: Exercise) -> None:
    (tmp_path / name).write_bytes(NAMES[name])
    submission = read(str(tmp_path / name), exercise)
    assert submission.program, submission.problem
    assert digest_of(submission.source) == digest_of(PROGRAM)
    assert can_be_read(name) or name in ("week3.json", "heartbeat.txt", "heartbeat", "heartbeat.py.gz")


SAVED = notebook(NODE)
BROKEN = {
    "cut off": (SAVED[: len(SAVED) // 2], "the file ends in line 1, in the middle. Was the download or the"),
    "cut off after a cell": (SAVED[: SAVED.index(b'"metadata": {}, "nbformat"')], "in the middle"),
    "a conflict": (
        json.dumps(json.loads(SAVED), indent=1).replace('   "source": [', '<<<<<<< HEAD\n   "source": [', 1).encode()
        + b"\n=======\n>>>>>>> theirs\n",
        "Line 8 of the notebook's file holds a mark of a merge conflict from git",
    ),
    "empty": (b"", "Your notebook's file is empty. Open the notebook, save it, and hand it in again."),
    "blank": (b" \n", "Your notebook's file is empty."),
    "a web page": (b"<!DOCTYPE html>\n<html></html>", "a web page. Download the notebook's own file"),
    "a comma": (SAVED.replace(b'"cells":', b'"cells",'), "line 1 of the file can't be read"),
    "another JSON": (b'{"exercise": "heartbeat"}', "holds no cells. Hand in the .ipynb that Jupyter saves."),
    "a page with a program": (f"<html>\n{PROGRAM}".encode(), "a web page. Download the notebook's own file"),
    "a program as text": (
        json.dumps({"cells": [{"cell_type": "raw", "source": NODE}]}).encode(),
        "The class Heartbeat is in a text cell of the notebook, which is not run. Make it a code cell",
    ),
    "a list": (b"[1]", "It is not a valid notebook"),
    "deeply nested": (b"[" * 100_000, "It is not a valid notebook"),
    "deeply nested cells": (b'{"cells": ' + b"[" * 100_000, "It is not a valid notebook"),
    "half of UTF-16": (SAVED.decode().encode("utf-16")[:201], "It is not a valid notebook"),
    "text": (b"hello\n", "It is not a valid notebook"),
    "a web page with a BOM": (b"\xef\xbb\xbf<!DOCTYPE html>\n", "a web page. Download the notebook's own file"),
    "Latin-1": (notebook(NODE + "# M\u00fcller").replace(b"\\u00fc", b"\xfc"), "line 1 of the file is not UTF-8"),
    "a C++ notebook": (
        notebook("int main() {}", language_info={"name": "c++"}),
        "C++ is not graded yet: hand in Python.",
    ),
}


@pytest.mark.parametrize(("content", "message"), BROKEN.values(), ids=BROKEN)
def test_a_notebook_that_can_not_be_read_is_named_with_what_to_do(
    content: bytes, message: str, exercise: Exercise
) -> None:
    submission = of_content("week3.ipynb", content, exercise)
    assert message in submission.problem
    assert "Error" not in submission.problem
    assert "KeyError" not in submission.problem


READABLE = {
    "nbformat 3": json.dumps(
        {
            "metadata": {"name": ""},
            "nbformat": 3,
            "nbformat_minor": 0,
            "worksheets": [
                {"cells": [{"cell_type": "markdown", "source": "x"}]},
                {"cells": [{"cell_type": "code", "input": NODE.splitlines(keepends=True), "prompt_number": 3}]},
            ],
        }
    ).encode(),
    "BOM": b"\xef\xbb\xbf" + SAVED,
    "UTF-16": SAVED.decode().encode("utf-16"),
    "text with line ends of Windows": json.dumps(
        {"cells": [{**cell(""), "source": NODE.replace("\n", "\r\n")}], "metadata": {}, "nbformat": 4}
    ).encode(),
    "lines without their ends": json.dumps({"cells": [{**cell(""), "source": NODE.split("\n")}]}).encode(),
    "line ends of an old Macintosh": json.dumps({"cells": [{**cell(""), "source": NODE.replace("\n", "\r")}]}).encode(),
    "a blank before the magic": notebook(" " + NODE),
    "nbformat 1": json.dumps({"cells": [{"cell_type": "code", "code": NODE}], "nbformat": 1}).encode(),
    "odd cells": json.dumps(
        {"cells": [None, 3, {"cell_type": 4}, {"cell_type": "code", "source": {"a": 1}, "metadata": [1], "outputs": 7},
                   {"cell_type": "code", "source": ["x = 1", 3], "outputs": [None, {"text": [1], "metadata": 2}]},
                   cell(NODE)]}
    ).encode(),
}  # fmt: skip


@pytest.mark.parametrize("content", READABLE.values(), ids=READABLE)
def test_other_forms_of_a_notebook_are_read(content: bytes, exercise: Exercise) -> None:
    assert normalized(of_content("week3.ipynb", content, exercise).source) == normalized(PROGRAM)


def test_jupyters_own_copy_is_read_with_a_word(exercise: Exercise) -> None:
    submission = of_content("03-checkpoint.ipynb", SAVED, exercise)
    assert submission.program
    assert "a copy that Jupyter makes by itself; your notebook may be newer" in submission.notes[0]


def test_a_merge_conflict_in_the_program_is_named(exercise: Exercise) -> None:
    conflict = PROGRAM.replace(IMPORTS, f"<<<<<<< HEAD\n{IMPORTS}=======\nimport os\n>>>>>>> theirs\n")
    expected = "Line 1 of your file is a mark of a merge conflict from git."
    assert of_content("heartbeat.py", conflict.encode(), exercise).problem.startswith(expected)
    in_a_cell = of_content("week3.ipynb", notebook(f"%%node heartbeat\n{conflict}"), exercise)
    assert "a mark of a merge conflict from git" in in_a_cell.problem
    shown = PROGRAM + "TEXT = '''\n<<<<<<< HEAD\n>>>>>>> theirs\n'''\n"
    assert of_content("heartbeat.py", shown.encode(), exercise).program


@pytest.mark.parametrize(
    "content", [b"Rar!\x1a\x07\x01", b"7z\xbc\xaf\x27\x1c", b"\x28\xb5\x2f\xfd"], ids=["RAR", "7z", "Zstandard"]
)
def test_an_archive_that_python_can_not_unpack_is_named_as_one(content: bytes, exercise: Exercise) -> None:
    assert "is an archive that can't be read here" in of_content("work.rar", content, exercise).problem
    assert "is an archive that can't be read here" in of_content("work.zip", content, exercise).problem
    inside = of_content("work.zip", zipped({"work.rar": content, "README.md": ""}), exercise).problem
    assert inside.startswith("work.rar in it is an archive that can't be read here.")


OTHER_KINDS = {
    "week3.md": (f"# Mine\n```python\n{PROGRAM}```\n".encode(), "Your file is neither Python, nor a notebook"),
    "week3.html": (f"<!DOCTYPE html>\n<pre>\n{PROGRAM}".encode(), "Your file is a web page, not Python."),
    "heartbeat.py": (b"%PDF-1.7\n%\xe2\xe3", "Your file is a PDF document, not Python."),
    "photo.jpg": (b"\xff\xd8\xff\xe0", "Your file is a picture, not Python."),
    "cached.py": (b"\xa7\r\r\n\0\0\0\0x", "Your file is Python's compiled code, not Python."),
    "heartbeat.docx": (
        zipped({"[Content_Types].xml": "", "word/document.xml": f"<w:t>\n{PROGRAM}"}),
        "of an office program.",
    ),
    "page.py": (b"\n<!DOCTYPE html>\n", "Your file is a web page, not Python."),
    "rich.py": (b"{\\rtf1 import rclpy}", "Your file is rich text, not Python."),
    "wide.py": (PROGRAM.encode("utf-16"), "Your file is saved as UTF-16, which Python can't read."),
    "wide.zip": (zipped({"mine.py": PROGRAM.encode("utf-16"), "rates.py": ""}), "Your file is saved as UTF-16"),
}


@pytest.mark.parametrize("name", OTHER_KINDS)
def test_a_file_that_only_quotes_a_program_is_named_for_what_it_is(name: str, exercise: Exercise) -> None:
    content, problem = OTHER_KINDS[name]
    assert problem in of_content(name, content, exercise).problem


@pytest.mark.parametrize("name", ["essay.docx", "notes.txt", "video.mp4", "nameless"])
def test_a_file_of_another_kind_is_a_submission_with_a_problem(name: str, tmp_path: Path, exercise: Exercise) -> None:
    (tmp_path / name).write_bytes(b"hello")
    assert "is neither Python, nor a notebook, nor an archive." in read(str(tmp_path / name), exercise).problem
    with pytest.raises(NoSubmission):
        read(str(tmp_path / f"no-{name}"), exercise)


@pytest.mark.parametrize(
    ("name", "content"),
    [
        ("heartbeat.cpp", b"int main() {}\n"),
        ("heartbeat.HPP", b""),
        ("beat.zip", zipped({"p/package.xml": "<name>p</name>", "p/src/heartbeat.cpp": "int main() {}\n"})),
        ("heartbeat.py", b"#include <rclcpp/rclcpp.hpp>\nint main() {}\n"),
        ("beat.zip", zipped({"src/heartbeat.cpp": "", "src/heartbeat.h": "", "tools/plot.py": "print(1)\n"})),
    ],
)
def test_cpp_is_refused_by_name(name: str, content: bytes, exercise: Exercise, grading: Grading) -> None:
    assert can_be_read(name)
    grade = grading.grade(of_content(name, content, exercise))
    assert (grade.outcome, grade.score, grade.message) == ("did-not-start", 0.0, NO_CPP)
    assert NO_CPP == "C++ is not graded yet: hand in Python."


def test_other_languages_are_refused_by_name_too(exercise: Exercise) -> None:
    assert of_content("heartbeat.rs", b"", exercise).problem == "Rust is not graded yet: hand in Python."
    crate = zipped({"Cargo.toml": "", "src/main.rs": ""})
    assert of_content("beat.zip", crate, exercise).problem == "Rust is not graded yet: hand in Python."


@pytest.mark.parametrize(
    "before", ["%%node heartbeat\n", "\ufeff%%node heartbeat\n", "!pip install rclpy\n", "# mine\n%matplotlib inline\n"]
)
def test_a_notebooks_commands_in_a_file_are_left_out_with_a_word(before: str, exercise: Exercise) -> None:
    submission = of_content("heartbeat.py", (before + PROGRAM).encode(), exercise)
    assert submission.source.endswith(PROGRAM)
    assert "lines that only a notebook understands" in submission.notes[0]
    assert submission.source.count("\n") == (before + PROGRAM).count("\n")
    assert of_content("heartbeat.py", b"x = = 1\n%time y\n", exercise).notes == ()


#: Programs that only a newer Python reads -> its version.
SYNTAX = {
    "x = f'{f'{1}'}'\n": (3, 12),
    'd = {"a": 1}\nx = f"{d["a"]}"\n': (3, 12),
    "def first[T](x: T) -> T:\n    return x\n": (3, 12),
    "class Box[T]:\n    pass\n": (3, 12),
    "type Pair = tuple[int, int]\n": (3, 12),
    "class Box[T = int]:\n    pass\n": (3, 13),
    "name = t'hello'\n": (3, 14),
    "try:\n    pass\nexcept ValueError, KeyError:\n    pass\n": (3, 14),
}


@pytest.mark.parametrize(("code", "version"), SYNTAX.items())
def test_a_program_for_a_newer_python_is_told_both_versions(
    code: str, version: tuple[int, int], exercise: Exercise
) -> None:
    this = f"The grader runs Python {sys.version_info[0]}.{sys.version_info[1]}."
    for notes in (
        newer_syntax(code),
        of_content("heartbeat.py", code.encode(), exercise).notes,
        of_content("week3.ipynb", notebook(f"%%node heartbeat\n{code}"), exercise).notes,
    ):
        if running() >= version:
            assert notes == ()
        else:
            assert f"only Python {version[0]}.{version[1]} and newer can read. {this}" in notes[0]


@pytest.mark.parametrize(
    "code", ["x = (\n", "x = f'{'\n", "def f(:\n    pass\n", "x = 1\n", "try:\n  pass\nexcept A, B\n"]
)
def test_a_mistake_is_not_taken_for_a_newer_python(code: str) -> None:
    assert "type" not in str(newer_syntax(code))
    assert not any("3.13" in note or "3.14" in note for note in newer_syntax(code))


@pytest.mark.parametrize(("begins", "repeated"), [("except a,", " "), ("class A[", "= ")])
def test_a_line_that_fills_a_file_does_not_keep_the_reader_busy(begins: str, repeated: str) -> None:
    assert newer_syntax(begins + repeated * (290_000 // len(repeated))) == newer_syntax(begins + repeated * 9)


NAMES_ADDED = {
    "AttributeError: module 'itertools' has no attribute 'batched'": (3, 12),
    "ImportError: cannot import name 'override' from 'typing' (/usr/lib/python3.11/typing.py)": (3, 12),
    "ModuleNotFoundError: No module named 'annotationlib'": (3, 14),
    "ImportError: cannot import name 'StrEnum' from 'enum'": (3, 11),
    "AttributeError: 'PosixPath' object has no attribute 'walk'": (3, 12),
}


@pytest.mark.parametrize(("message", "version"), NAMES_ADDED.items())
def test_a_name_of_a_newer_python_is_told_both_versions(message: str, version: tuple[int, int]) -> None:
    if running() >= version:
        assert newer_name(message) == ""
    else:
        assert f"is new in Python {version[0]}.{version[1]}. The grader runs Python" in newer_name(message)


def test_a_name_that_no_python_has_is_not_excused() -> None:
    assert newer_name("ImportError: cannot import name 'Nodes' from 'rclpy.node'") == ""
    assert newer_name("AttributeError: module 'itertools' has no attribute 'batch'") == ""


def test_a_notebook_that_names_a_newer_python_is_told_if_something_is_wrong(
    exercise: Exercise, grading: Grading
) -> None:
    info = {"language_info": {"name": "python", "version": "3.99.1"}}
    right = of_content("week3.ipynb", notebook(NODE, **info), exercise)
    wrong = of_content("week3.ipynb", notebook(NODE.replace("0.25", "0.5"), **info), exercise)
    assert right.newer_python.startswith("It was written with Python 3.99. The grader runs Python 3.")
    assert grading.grade(right).message == ""
    assert right.newer_python in grading.grade(wrong).message
