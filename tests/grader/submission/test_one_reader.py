"""The same saved notebook is the same program for `%check`, `submit`, the page and `grade`."""

from __future__ import annotations

import json
import shutil
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from click.testing import CliRunner
from notebook_kernel import Kernel
from student_work import BEAT, CLASS, EXERCISE, GUARD, IMPORTS, INIT, MAIN, OLD, PROGRAM, cell, check_cell, notebook

from grader.exercise import Exercise, starter
from grader.submission import read
from grader.submission.code import code_of_notebook
from grader.submission.notebook import RECORD, Notebook
from grader.submission.program_choice import digest_of
from grader.submission.reader import of_content
from spinbook.kernel.check_cell import cells_as_run
from spinbook.submit.command import submit

ROOT = Path(__file__).parents[3]
BEGIN = "%%node heartbeat --seconds 0.1\n"
MINE = BEGIN + PROGRAM
STARTER = BEGIN + starter((ROOT / "solutions" / "heartbeat" / "solution.py").read_text())
TEXT = 'TEXT = """\n%done\n!important\n"""\n'

#: The same program twelve times; what stands below the cell that ran last must not change that.
NOTEBOOKS: dict[str, list[Any]] = {
    "one cell": [MINE],
    "notes below": [cell(MINE, EXERCISE), cell("# my notes", EXERCISE)],
    "an empty copy below": [cell(MINE, EXERCISE), cell("", EXERCISE)],
    "a copy below": [cell(MINE, EXERCISE), cell(MINE, EXERCISE)],
    "the starter above": [cell(STARTER, EXERCISE), cell(MINE, EXERCISE)],
    "an old version above": [BEGIN + OLD.partition("\n")[2], MINE, check_cell(digest_of(PROGRAM))],
    "split in two": [cell(f"{BEGIN}{IMPORTS}\n{CLASS}", EXERCISE), cell(f"{MAIN}\n{GUARD}", EXERCISE)],
    "split in the class": [cell(f"{BEGIN}{IMPORTS}\n{INIT}", EXERCISE), cell(f"{BEAT}\n{MAIN}\n{GUARD}", EXERCISE)],
    "parts": [f"%%part common\n{IMPORTS}", f"%%part beats\n{CLASS}",
              f"%%node heartbeat --after common beats --seconds 0.1\n{MAIN}\n{GUARD}"],
    "parts that are kept": [f"%%part beats --keep\n{IMPORTS}\n{CLASS}",
                            f"%%node heartbeat --after beats --keep\n{MAIN}\n{GUARD}"],
    "commands": ["%pwd\n!true\n", "%%bash\ntrue\n", MINE],
    "signs of commands in a text": [BEGIN + PROGRAM.replace(IMPORTS, IMPORTS + TEXT)],
}  # fmt: skip


def sources(cells: list[Any]) -> list[str]:
    return ["".join(one if isinstance(one, str) else one["source"]) for one in cells]


def saved(tmp_path: Path, name: str) -> Path:
    """Write a notebook into a course of its own, and return it."""
    for part in ("exercises", "solutions"):
        shutil.copytree(ROOT / part / "heartbeat", tmp_path / part / "heartbeat")
    file = tmp_path / "week3.ipynb"
    file.write_bytes(notebook(*NOTEBOOKS[name]))
    return file


def handed_in(file: Path, monkeypatch: pytest.MonkeyPatch) -> bytes:
    """Hand a notebook in with `spinbook submit`; return the upload."""
    monkeypatch.chdir(file.parent)
    done = CliRunner().invoke(submit, ["heartbeat", file.name, "--no-check", "--student", "Ada"])
    assert done.exit_code == 0, done.output
    return (file.parent / "heartbeat-submission.zip").read_bytes()


@pytest.mark.parametrize("name", NOTEBOOKS)
def test_a_notebook_is_one_program_for_everybody(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, exercise: Exercise
) -> None:
    file = saved(tmp_path, name)
    graded = read(str(file), exercise)
    assert graded.program, graded
    assert "0.25" in graded.source
    assert "0.5" not in graded.source

    uploaded = of_content("heartbeat-submission.zip", handed_in(file, monkeypatch), exercise)
    history = SimpleNamespace(history_manager=SimpleNamespace(input_hist_raw=["", *sources(NOTEBOOKS[name])]))
    session: Any = SimpleNamespace(ran={})
    checked = code_of_notebook(Notebook(cells_as_run(session, history)), exercise)

    assert uploaded.program
    assert uploaded.program.files == graded.program.files
    assert digest_of(checked.source) == digest_of(graded.source)


def checked_in_a_kernel(file: Path, cells: list[Any]) -> dict[str, Any]:
    """Run a notebook's cells and `%check` in a kernel; return the record that is saved with the check's output."""
    kernel = Kernel(file.parent)
    try:
        for source in sources(cells):
            kernel.run(source)
        shown = kernel.run("%check heartbeat")
        assert not shown.error, shown.error
        assert " 0 of " not in shown.pictures[-1]["text/plain"]
        record: dict[str, Any] = shown.metadata[-1][RECORD]
        return record
    finally:
        kernel.shut_down()


def same_in_a_kernel(name: str, tmp_path: Path, exercise: Exercise) -> None:
    file = saved(tmp_path, name)
    record = checked_in_a_kernel(file, NOTEBOOKS[name])
    graded = read(str(file), exercise)
    assert record == {"exercise": "heartbeat", "code": digest_of(graded.source)}


def test_what_check_judges_in_a_kernel_is_what_is_graded(tmp_path: Path, exercise: Exercise) -> None:
    same_in_a_kernel("parts", tmp_path, exercise)


@pytest.mark.soak
@pytest.mark.parametrize("name", sorted(NOTEBOOKS.keys() - {"parts"}))
def test_every_notebook_is_one_program_in_a_kernel_too(name: str, tmp_path: Path, exercise: Exercise) -> None:
    same_in_a_kernel(name, tmp_path, exercise)


def test_the_record_of_a_check_is_what_the_reader_looks_for(exercise: Exercise) -> None:
    check = json.loads(notebook(check_cell(digest_of(PROGRAM))))["cells"][0]
    assert digest_of(of_content("week3.ipynb", notebook(OLD, MINE, check), exercise).source) == digest_of(PROGRAM)
