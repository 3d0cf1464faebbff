"""`spinbook submit` finds the student's code, checks it, and writes the one file that `spinbook grade` reads."""

from __future__ import annotations

import json
import os
import pty
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from click.testing import CliRunner, Result

from grader.exercise import load, starter
from grader.submission import read
from grader.submission.upload import Upload, unpack
from spinbook.problem import SpinbookError
from spinbook.submit.command import check, submit

ROOT = Path(__file__).parents[3]
SOLUTION = (ROOT / "solutions" / "joint_velocity" / "solution.py").read_text()
STARTER = starter(SOLUTION)
UPLOAD = "joint_velocity-submission.zip"


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder with the exercise in it, as the current folder."""
    for part in ("exercises", "solutions"):
        shutil.copytree(ROOT / part / "joint_velocity", tmp_path / part / "joint_velocity")
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "1700000000")
    return tmp_path


def submitted(*words: str) -> Result:
    return CliRunner().invoke(submit, ["joint_velocity", *words])


def upload(file: str = UPLOAD) -> Upload:
    return unpack(Path(file).read_bytes())


def write_notebook(name: str, code: str) -> None:
    cell = {"cell_type": "code", "source": f"%%node joint_velocity\n{code}", "metadata": {}, "outputs": []}
    Path(name).write_text(json.dumps({"cells": [cell], "metadata": {}, "nbformat": 4, "nbformat_minor": 5}))


def test_a_file_is_checked_handed_in_and_read_again(folder: Path) -> None:
    Path("joint_velocity.py").write_text(SOLUTION)
    done = submitted("--student", "  Ada\nLovelace ")
    assert done.exit_code == 0, done.output
    assert f"Upload this file: {UPLOAD}" in done.output
    assert "37 of 37 points" in done.output, "what the public scenarios do not test is not counted"
    assert "long gap" not in done.output, "no hidden check is shown"
    record = upload().record
    assert record["student"] == "Ada Lovelace"
    assert record["time"] == "2023-11-14T22:13:20+00:00"
    assert (record["self_check"]["score"], record["self_check"]["points"]) == (41, 41)
    assert {"python", "rclpy", "spinbook"} <= set(record["versions"])
    submission = read(UPLOAD, load("exercises/joint_velocity"))
    assert (submission.source, submission.warning) == (SOLUTION, "")


def test_hints_are_counted_if_the_exercise_says_so(folder: Path) -> None:
    declaration = Path("exercises/joint_velocity/exercise.toml")
    Path("joint_velocity.py").write_text(f'{SOLUTION}\n# Hints shown in the page: {{"It answers.":2}}\n')
    assert submitted("--no-check").exit_code == 0
    assert "hints" not in upload().record
    declaration.write_text(declaration.read_text().replace("points = 100\n", "points = 100\ncount_hints = true\n"))
    assert submitted("--no-check").exit_code == 0
    assert upload().record["hints"] == {"It answers.": 2}
    read_back = read(UPLOAD, load("exercises/joint_velocity"))
    assert read_back.notes == ("Hints taken: 2.",), "these are in the grade's message, which the instructor reads"


def test_a_notebook_is_handed_in_with_its_cell_and_as_a_whole(folder: Path) -> None:
    write_notebook("week3.ipynb", SOLUTION)
    assert submitted("--no-check").exit_code == 0
    files = upload().files
    assert files["joint_velocity.py"].decode() == f"\n{SOLUTION}"
    assert files["week3.ipynb"] == Path("week3.ipynb").read_bytes()
    assert upload().record["from"] == "week3.ipynb"


def test_of_several_cells_none_is_handed_in_by_guess(folder: Path) -> None:
    write_notebook("week3.ipynb", "first = 1")
    notebook = json.loads(Path("week3.ipynb").read_text())
    for line in ("%%node joint_velocity --seconds 20", "%%node joint_velocity.py"):
        notebook["cells"].append({**notebook["cells"][0], "source": f"{line}\nsecond = 2"})
    Path("week3.ipynb").write_text(json.dumps(notebook))
    done = submitted("--no-check")
    assert done.exit_code == 1
    assert isinstance(done.exception, SpinbookError)
    assert "3 cells of the notebook can be joint_velocity.py, they differ" in str(done.exception)
    assert not Path(UPLOAD).exists()


def test_a_choice_among_cells_is_reported(folder: Path) -> None:
    write_notebook("week3.ipynb", SOLUTION)
    notebook = json.loads(Path("week3.ipynb").read_text())
    notebook["cells"].append({**notebook["cells"][0], "source": "%%node joint_velocity\n# notes"})
    Path("week3.ipynb").write_text(json.dumps(notebook))
    done = submitted("--no-check")
    assert upload().files["joint_velocity.py"].decode() == f"\n{SOLUTION}"
    assert 'Taken: code cell 1 ("%%node joint_velocity"), because the other one has no' in done.output


def test_a_huge_notebook_stays_at_home(folder: Path) -> None:
    write_notebook("week3.ipynb", SOLUTION + "#" * 3_000_000)
    Path("joint_velocity.py").write_text(SOLUTION)
    assert submitted("week3.ipynb", "--no-check").exit_code == 0
    assert set(upload().files) == {"joint_velocity.py"}


def test_bytes_that_are_no_utf_8_are_handed_in_as_they_are(folder: Path) -> None:
    Path("joint_velocity.py").write_bytes(b"x = '\xe4'\r\n")
    assert submitted("--no-check").exit_code == 0
    assert upload().files["joint_velocity.py"] == b"x = '\xe4'\r\n"


def test_the_same_work_gives_the_same_bytes(folder: Path) -> None:
    Path("joint_velocity.py").write_text(SOLUTION)
    submitted("--no-check")
    once = Path(UPLOAD).read_bytes()
    submitted("--no-check", "--output", "again.zip")
    assert Path("again.zip").read_bytes() == once


def test_an_untouched_starter_does_not_count_beside_the_students_work(folder: Path) -> None:
    Path("joint_velocity.py").write_text(STARTER)
    write_notebook("week3.ipynb", SOLUTION)
    assert submitted("--no-check").exit_code == 0
    assert upload().record["from"] == "week3.ipynb"


def test_a_starter_that_nobody_touched_is_handed_in_with_a_word(folder: Path) -> None:
    write_notebook("week3.ipynb", STARTER)
    done = submitted("--no-check")
    assert done.exit_code == 0
    assert "still the starter" in done.output


def test_the_file_beside_the_task_is_found_and_its_starter_known(folder: Path) -> None:
    own = Path("exercises/joint_velocity/joint_velocity.py")
    kept = Path(".spinbook/base") / own
    shutil.rmtree("solutions")
    kept.parent.mkdir(parents=True)
    kept.write_text(STARTER)
    write_notebook("week3.ipynb", STARTER)
    own.write_text(SOLUTION)
    assert submitted("--no-check").exit_code == 0
    assert upload().record["from"] == str(own)


def test_the_same_code_twice_is_no_question(folder: Path) -> None:
    Path("joint_velocity.py").write_text(SOLUTION)
    write_notebook("week3.ipynb", SOLUTION)
    assert submitted("--no-check").exit_code == 0


def test_two_candidates_are_a_question(folder: Path) -> None:
    write_notebook("week3.ipynb", SOLUTION)
    write_notebook("week3 (1).ipynb", SOLUTION + "# later\n")
    done = submitted("--no-check")
    assert done.exit_code == 2
    assert "week3 (1).ipynb, week3.ipynb" in done.output
    assert not Path(UPLOAD).exists()


def test_in_a_terminal_the_file_and_the_name_are_asked_and_the_name_only_once(folder: Path) -> None:
    write_notebook("week3.ipynb", SOLUTION)
    write_notebook("week3 (1).ipynb", SOLUTION + "# later\n")
    for answers in (b"2\nAda\n", b"2\n"):
        ours, theirs = pty.openpty()
        os.write(ours, answers)
        command = [sys.executable, "-m", "spinbook", "submit", "joint_velocity", "--no-check"]
        done = subprocess.run(command, stdin=theirs, capture_output=True, text=True, timeout=120)
        os.close(ours)
        os.close(theirs)
        assert done.returncode == 0, done.stderr
        assert (upload().record["from"], upload().record["student"]) == ("week3.ipynb", "Ada")


def test_a_self_check_that_can_not_run_keeps_nobody_from_handing_in(folder: Path) -> None:
    shutil.rmtree("solutions")
    Path("exercises/joint_velocity/scenarios.py").write_text("1 / 0\n")
    Path("joint_velocity.py").write_text(SOLUTION)
    done = submitted()
    assert done.exit_code == 0, done.output
    assert "No self-check:" in done.output
    assert "You can still hand in." in done.output
    assert upload().record["self_check"]["not_run"]


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["nowhere.py"], "there is no such file"),
        (["pkg/executable"], "give a notebook"),
    ],
)
def test_wrong_usage_is_reported(folder: Path, words: list[str], message: str) -> None:
    done = submitted(*words)
    assert done.exit_code == 2
    assert message in done.output


def test_an_unknown_exercise_is_reported_with_those_that_there_are(folder: Path) -> None:
    done = CliRunner().invoke(submit, ["joint_velocty"])
    assert done.exit_code == 2
    assert "There are: joint_velocity" in done.output


def test_a_folder_without_the_exercise_says_what_was_looked_for(folder: Path) -> None:
    write_notebook("week2.ipynb", "class SomethingElse: pass")
    Path("week2.ipynb").write_text(Path("week2.ipynb").read_text().replace("joint_velocity", "other"))
    done = submitted()
    assert isinstance(done.exception, SpinbookError)
    assert "no joint_velocity.py, and no notebook with its cell" in str(done.exception)


def test_an_empty_file_is_nothing_to_hand_in(folder: Path) -> None:
    Path("joint_velocity.py").write_text("\n")
    done = submitted("joint_velocity.py")
    assert "empty" in str(done.exception)
    assert not Path(UPLOAD).exists()


def test_the_public_checks_run_in_a_terminal_too(folder: Path) -> None:
    Path("mine.py").write_text(SOLUTION.replace("/joint_velocities", "/velocities"))
    done = CliRunner().invoke(check, ["joint_velocity", "mine.py"])
    assert done.exit_code == 1, done.output
    assert "Checking mine.py." in done.output
    assert "of 41 points" in done.output
    assert not Path(UPLOAD).exists()
    assert CliRunner().invoke(check, ["joint_velocity", "none.py"]).exit_code == 2
    with pytest.raises(SpinbookError, match="nothing here holds joint_velocity"):
        CliRunner().invoke(check, ["joint_velocity"], catch_exceptions=False)
