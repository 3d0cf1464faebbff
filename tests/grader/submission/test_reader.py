"""A submission is a file, a notebook's cell or an installed executable. Reading it is harmless."""

from __future__ import annotations

import json
import os
from dataclasses import replace
from pathlib import Path

import pytest

from grader.exercise import Exercise, load
from grader.exercise.exercise import ProgramFile
from grader.submission import NoSubmission, read

ROOT = Path(__file__).parents[3]
CELL = "%%node joint_velocity\nclass JointVelocity:\n    pass\n"


@pytest.fixture(scope="session")
def exercise() -> Exercise:
    """The exercise joint_velocity; the folder's other tests use heartbeat."""
    return load(ROOT / "exercises" / "joint_velocity")


def notebook(tmp_path: Path, *cells: tuple[str, dict[str, object]]) -> str:
    file = tmp_path / "week3.ipynb"
    entries = [{"cell_type": "code", "source": source, "metadata": metadata} for source, metadata in cells]
    file.write_text(json.dumps({"cells": entries, "metadata": {}, "nbformat": 4, "nbformat_minor": 5}))
    return str(file)


def test_a_file_is_taken_as_it_is(tmp_path: Path, exercise: Exercise) -> None:
    file = tmp_path / "my node (2).py"
    file.write_bytes(b"x = '\xe4'\r\n")
    submission = read(str(file), exercise)
    assert submission.program
    assert submission.program.files == {"joint_velocity.py": b"x = '\xe4'\r\n"}


@pytest.mark.parametrize(
    "cells",
    [
        [("x = 1", {}), ("class Other: pass", {"spinbook": {"exercise": "joint_velocity"}}), ("JointVelocity", {})],
        [("x = 1", {}), ("%%node joint_velocity\nclass Other: pass", {}), ("class JointVelocity: pass", {})],
        [("x = 1", {}), ("class Other: pass\nclass JointVelocity(Node): pass", {}), ("JointVelocity", {})],
        [("x = 1", {}), ("class Other: pass\nnode = rclpy.create_node('joint_velocity')", {})],
    ],
    ids=["metadata", "magic", "class", "node"],
)
def test_a_notebooks_cell_is_found(
    tmp_path: Path, exercise: Exercise, cells: list[tuple[str, dict[str, object]]]
) -> None:
    submission = read(notebook(tmp_path, *cells), exercise)
    assert "class Other" in submission.source
    assert "x = 1" not in submission.source


def test_magic_lines_are_emptied_so_that_line_numbers_stay(tmp_path: Path, exercise: Exercise) -> None:
    source = read(notebook(tmp_path, (CELL, {})), exercise).source
    assert source.splitlines() == ["", "class JointVelocity:", "    pass"]


def test_a_notebook_without_the_cell_is_the_students_to_hear_of(tmp_path: Path, exercise: Exercise) -> None:
    submission = read(notebook(tmp_path, ("x = 1", {})), exercise)
    assert submission.program is None
    assert "JointVelocity" in submission.problem


@pytest.mark.parametrize("content", [b"", b"{", b"[]", b'{"cells": 3}', b"\xff\xfe", b'{"cells": [1]}', b"[" * 100_000])
def test_rubbish_instead_of_a_notebook_does_no_harm(tmp_path: Path, exercise: Exercise, content: bytes) -> None:
    file = tmp_path / "week3.ipynb"
    file.write_bytes(content)
    assert read(str(file), exercise).problem


def test_a_notebook_of_twenty_thousand_cells_is_read(tmp_path: Path, exercise: Exercise) -> None:
    submission = read(notebook(tmp_path, *[("x = 1", {})] * 20_000, (CELL, {})), exercise)
    assert "JointVelocity" in submission.source


def test_a_file_too_large_is_reported(tmp_path: Path, exercise: Exercise) -> None:
    file = tmp_path / "large.py"
    file.write_bytes(b"#" * 2_000_000)
    assert "larger" in read(str(file), exercise).problem


def test_a_symbolic_link_is_not_followed(tmp_path: Path, exercise: Exercise) -> None:
    (tmp_path / "secret").write_text("the solution")
    link = tmp_path / "link.py"
    link.symlink_to(tmp_path / "secret")
    submission = read(str(link), exercise)
    assert "symbolic link" in submission.problem
    assert "solution" not in submission.source


def test_a_fifo_does_not_hang_the_grader(tmp_path: Path, exercise: Exercise) -> None:
    os.mkfifo(tmp_path / "pipe.py")
    assert "not a regular file" in read(str(tmp_path / "pipe.py"), exercise).problem


@pytest.mark.parametrize("given", ["nowhere.py", "notes.txt", "no_package/no_executable"])
def test_what_is_not_there_is_a_matter_of_usage(given: str, exercise: Exercise) -> None:
    with pytest.raises(NoSubmission) as caught:
        read(given, exercise)
    assert given in str(caught.value)


@pytest.mark.parametrize(
    ("content", "message"),
    [
        ("import rclpy\n".encode("utf-16"), "Your file is saved as UTF-16, which Python can't read."),
        (b"import rclpy\nx = 1\0\n", "Line 2 of your file contains a NUL byte, so it is not a text file."),
        (b"x = " + b"-" * 200_000 + b"1\n", "A line of your file nests 200,000 operators or brackets."),
        (b"x = " + b"+".join([b"1"] * 100_000) + b"\n", "A line of your file nests 99,999 operators or brackets."),
    ],
    ids=["UTF-16", "NUL", "signs", "sum"],
)
def test_what_python_can_not_read_is_named(tmp_path: Path, exercise: Exercise, content: bytes, message: str) -> None:
    (tmp_path / "node.py").write_bytes(content)
    submission = read(str(tmp_path / "node.py"), exercise)
    assert submission.program is None
    assert submission.problem.startswith(message)


def test_a_long_line_of_data_is_read(tmp_path: Path, exercise: Exercise) -> None:
    (tmp_path / "node.py").write_text(f"x = [{'[-1, 1], ' * 20_000}]\ny = '{'-' * 20_000}'\n")
    assert read(str(tmp_path / "node.py"), exercise).program


@pytest.mark.parametrize(
    "line",
    ["# it's " + r"\a" * 100_000, "# it's " + r"\'" * 100_000, "#" + "\"'" * 100_000, "# it's " + "\\" * 100_001],
    ids=["backslashes", "escaped quotes", "quotes of both kinds", "a backslash at the end"],
)
def test_a_long_line_with_a_quote_that_is_not_closed_is_read(tmp_path: Path, exercise: Exercise, line: str) -> None:
    (tmp_path / "node.py").write_text(f"{line}\nx = 1\n")
    assert read(str(tmp_path / "node.py"), exercise).program


def test_half_of_a_character_in_a_notebook_is_reported_with_its_line(tmp_path: Path, exercise: Exercise) -> None:
    submission = read(notebook(tmp_path, (CELL + "name = '\ud83e'\n", {})), exercise)
    assert submission.program is None
    assert submission.problem.startswith("Line 4 of the exercise's cell contains '\\ud83e', half of a character.")


@pytest.fixture
def pair(exercise: Exercise) -> Exercise:
    """An exercise with two programs in one submission."""
    return replace(exercise, programs=(ProgramFile("speaker.py", "speaker"), ProgramFile("hearer.py", "hearer")))


def test_several_programs_are_handed_in_as_a_folder_or_as_one_file(tmp_path: Path, pair: Exercise) -> None:
    folder = tmp_path / "package"
    folder.mkdir()
    for name in ("speaker", "hearer", "words"):
        (folder / f"{name}.py").write_text(f"name = '{name}'\n")
    of_folder = read(str(folder), pair)
    (tmp_path / "both.py").write_text(of_folder.source)
    of_file = read(str(tmp_path / "both.py"), pair)

    for submission in (of_folder, of_file):
        assert submission.program
        assert sorted(submission.program.files) == ["hearer.py", "speaker.py", "words.py"]
        assert b"name = 'words'" in submission.program.files["words.py"]


@pytest.mark.parametrize("as_folder", [True, False], ids=["folder", "file"])
def test_files_without_end_are_refused(tmp_path: Path, pair: Exercise, as_folder: bool) -> None:
    given = tmp_path / ("package" if as_folder else "all.py")
    if as_folder:
        given.mkdir()
        for number in range(1000):
            (given / f"file_{number}.py").write_text("x = 1\n")
    else:
        given.write_text("".join(f"# file: file_{number}.py\n" for number in range(40_000)))
    submission = read(str(given), pair)
    assert submission.program is None
    assert submission.problem.startswith("It holds 1000 files." if as_folder else "There are more than 20 files")
