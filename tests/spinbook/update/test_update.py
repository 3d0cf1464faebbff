"""`spinbook update` brings a folder up to a newer handout: with a backup, completely or not at all, or as a preview."""

from __future__ import annotations

import io
import json
import re
import stat
import zipfile
from pathlib import Path

import pytest
from click.testing import CliRunner, Result
from update_notebooks import Cell, cell, cells_of, notebook, ran, texts

from spinbook.problem import SpinbookError
from spinbook.update.command import update
from spinbook.update.handout import BASE, base_files

TITLE = cell("# Week 3", "week-3", "markdown")
TALKER = cell("%%node talker\nprint('talks')", "node-talker", node="talker")
STARTER = cell("%%node listener\n# TODO", "exercise-listener-starter", node="listener", exercise="listener")
MINE = {**STARTER, "source": "%%node listener\nprint('I listen')"}
LOUDER = {**TALKER, "source": "%%node talker\nprint('talks louder')"}


def handout(*cells: Cell, **others: bytes) -> dict[str, bytes]:
    """Return a handout's files by name, with this chapter."""
    files = {"week3.ipynb": notebook(*cells), "README.md": b"Three steps.\n", "wheels/x.whl": b"1"}
    files["exercises/listener/listener.py"] = b"# TODO\n"
    files |= {name.replace("__", "/").replace("_DOT_", "."): content for name, content in others.items()}
    return {**files, **base_files(files)}


OLD = handout(TITLE, TALKER, STARTER)


def write(folder: Path, files: dict[str, bytes]) -> Path:
    for name, content in files.items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_bytes(content)
    return folder


def zipped(files: dict[str, bytes], around: str = "course/") -> bytes:
    out = io.BytesIO()
    with zipfile.ZipFile(out, "w") as archive:
        for name, content in files.items():
            archive.writestr(around + name, content)
    return out.getvalue()


def everything(folder: Path) -> dict[str, bytes]:
    return {p.relative_to(folder).as_posix(): p.read_bytes() for p in sorted(folder.rglob("*")) if p.is_file()}


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The student's folder, as the current folder: the exercise is solved, and everything was run."""
    folder = write(tmp_path / "mine", OLD)
    (folder / "week3.ipynb").write_bytes(notebook(TITLE, ran(TALKER, "talks"), ran(MINE, "heard")))
    monkeypatch.chdir(folder)
    return folder


def updated(*words: str) -> Result:
    return CliRunner().invoke(update, words)


def test_a_changed_chapter_comes_and_the_students_cells_stay(folder: Path) -> None:
    before = (folder / "week3.ipynb").read_bytes()
    new = zipped(handout(TITLE, LOUDER, STARTER, week4_DOT_ipynb=notebook(TITLE, chapter="chapters/04.md")))
    (folder.parent / "new.zip").write_bytes(new)
    done = updated("../new.zip")
    assert done.exit_code == 0, done.output
    assert texts((folder / "week3.ipynb").read_bytes()) == [TITLE["source"], LOUDER["source"], MINE["source"]]
    assert cells_of((folder / "week3.ipynb").read_bytes())[2] == ran(MINE, "heard")
    assert (folder / "week4.ipynb").exists()
    [backup] = (folder / "backups").iterdir()
    assert everything(backup) == {"week3.ipynb": before}
    assert f"backups/{backup.name}" in done.output
    assert "week4.ipynb: is new." in done.output


def test_the_same_handout_changes_nothing_at_all(folder: Path) -> None:
    (folder / "exercises/listener/listener.py").write_bytes(b"mine\n")
    (folder / "README.md").unlink()
    before = everything(folder)
    write(folder.parent / "same", OLD)
    done = updated("../same")
    assert done.exit_code == 0
    assert "Nothing to do" in done.output
    assert everything(folder) == before


def test_an_update_done_twice_is_an_update_done_once(folder: Path) -> None:
    write(folder.parent / "new", handout(TITLE, LOUDER, {**STARTER, "source": "%%node listener\n# TODO: hear"}))
    assert "CONFLICT: you and the course changed this cell; yours is kept: %%node listener" in updated("../new").output
    once = everything(folder)
    assert "Nothing to do" in updated("../new").output
    assert everything(folder) == once


def test_an_update_that_broke_off_can_be_done_again(folder: Path) -> None:
    new = handout(TITLE, LOUDER, {**STARTER, "source": "%%node listener\n# TODO: hear"})
    write(folder.parent / "new", new)
    updated("../new")
    once = everything(folder)
    for name, content in OLD.items():
        if name.startswith(str(BASE)):
            (folder / name).write_bytes(content)
    updated("../new")
    assert (folder / "week3.ipynb").read_bytes() == once["week3.ipynb"]
    assert everything(folder / BASE) == everything(folder.parent / "new" / BASE)


def test_a_dry_run_tells_and_changes_nothing(folder: Path) -> None:
    before = everything(folder)
    write(folder.parent / "new", handout(TITLE, LOUDER, STARTER, README_DOT_md=b"Four steps.\n"))
    done = updated("../new", "--dry-run")
    assert "README.md: has changed in the handout" in done.output
    assert "other cells: 1 changed" in done.output
    assert "Nothing was changed" in done.output
    assert everything(folder) == before


def test_a_file_that_both_changed_is_kept_and_the_new_one_lies_beside_it(folder: Path) -> None:
    starter = folder / "exercises/listener/listener.py"
    starter.write_bytes(b"mine\n")
    (folder / "README.md").write_bytes(b"My notes.\n")
    write(folder.parent / "new", handout(TITLE, TALKER, STARTER, exercises__listener__listener_DOT_py=b"# TODO 2\n"))
    done = updated("../new")
    assert starter.read_bytes() == b"mine\n"
    assert starter.with_name("listener.new.py").read_bytes() == b"# TODO 2\n"
    assert (folder / "README.md").read_bytes() == b"My notes.\n"
    assert "listener.new.py" in done.output


def test_a_notebook_that_was_renamed_is_found_by_its_chapter(folder: Path) -> None:
    (folder / "week3.ipynb").rename(folder / "Ada week 3.ipynb")
    write(folder.parent / "new", handout(TITLE, LOUDER, STARTER))
    updated("../new")
    assert LOUDER["source"] in texts((folder / "Ada week 3.ipynb").read_bytes())
    assert not (folder / "week3.ipynb").exists()


def test_a_notebook_that_can_not_be_read_is_kept_beside_the_new_one(folder: Path) -> None:
    (folder / "week3.ipynb").write_bytes(b'{"cells": [')
    write(folder.parent / "new", handout(TITLE, LOUDER, STARTER))
    done = updated("../new")
    assert done.exit_code == 0
    assert (folder / "week3.ipynb").read_bytes() == b'{"cells": ['
    assert (folder / "week3.new.ipynb").exists()
    assert "can't be read" in done.output


def test_a_folder_that_remembers_nothing_keeps_all_that_differs(folder: Path) -> None:
    for name in OLD:
        if name.startswith(".spinbook"):
            (folder / name).unlink()
    write(folder.parent / "new", handout(TITLE, LOUDER, STARTER))
    updated("../new")
    kept = [text for text in texts((folder / "week3.ipynb").read_bytes()) if "CHANGED IN" not in text]
    assert kept == [TITLE["source"], TALKER["source"], MINE["source"]]
    assert (folder / BASE / "week3.ipynb").exists()
    assert "Nothing to do" in updated("../new").output


def test_the_only_handout_beside_the_folder_is_found_and_of_two_one_has_to_be_named(folder: Path) -> None:
    (folder.parent / "photos.zip").write_bytes(zipped({"a.jpg": b"x"}))
    (folder.parent / "new.zip").write_bytes(zipped(handout(TITLE, LOUDER, STARTER)))
    assert LOUDER["source"] not in texts((folder / "week3.ipynb").read_bytes())
    assert updated().exit_code == 0
    assert LOUDER["source"] in texts((folder / "week3.ipynb").read_bytes())
    (folder.parent / "newer.zip").write_bytes(zipped(OLD))
    assert updated().exit_code == 2


def link() -> bytes:
    out = io.BytesIO()
    with zipfile.ZipFile(out, "w") as archive:
        entry = zipfile.ZipInfo("week3.ipynb")
        entry.external_attr = (stat.S_IFLNK | 0o777) << 16
        archive.writestr(entry, "/etc/passwd")
    return out.getvalue()


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (b"", "can't be read"),
        (zipped({"../../evil.ipynb": b"{}"}, ""), "leads out of its folder"),
        (zipped({"/evil.ipynb": b"{}"}, ""), "leads out of its folder"),
        (link(), "symbolic link"),
        (zipped({"a.jpg": b"x"}), "no notebook in it"),
    ],
)
def test_what_is_no_handout_changes_nothing(content: bytes, message: str, folder: Path) -> None:
    before = everything(folder.parent)
    (folder.parent / "new.zip").write_bytes(content)
    done = updated("../new.zip")
    assert isinstance(done.exception, SpinbookError)
    assert message in str(done.exception)
    assert everything(folder.parent) == {**before, "new.zip": content}


def test_a_folder_that_is_no_course_is_reported(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    write(tmp_path / "new", OLD)
    (tmp_path / "empty").mkdir()
    monkeypatch.chdir(tmp_path / "empty")
    assert "not a course's folder" in str(updated("../new").exception)
    assert json.loads(OLD["week3.ipynb"])["cells"]


SETUP = cell("%load_ext spinbook\n%chapter week3 --package humanoid_control --workspace humanoid_ws", "spinbook-setup")


def other_course() -> dict[str, bytes]:
    setup = {**SETUP, "source": SETUP["source"].replace("humanoid_control", "cooking")}
    return handout(TITLE, setup, LOUDER)


@pytest.mark.parametrize(
    ("files", "message"),
    [
        ({"week3.ipynb": notebook(TITLE, LOUDER), "submission.json": b"{}"}, "a file to hand in that"),
        ({"week3.ipynb": notebook(TITLE, LOUDER)}, "it is not a handout: there is no .spinbook/base in it."),
        ({"notes.txt": b"x"}, "there is no notebook in it."),
        (other_course(), "it is a handout of another course: its package is cooking, yours is humanoid_control."),
    ],
    ids=["a submission", "a zip with a notebook", "a zip", "another course"],
)
def test_what_is_not_a_handout_of_this_course_is_refused_and_nothing_is_changed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, files: dict[str, bytes], message: str
) -> None:
    folder = write(tmp_path / "mine", handout(TITLE, SETUP, TALKER, STARTER))
    monkeypatch.chdir(folder)
    before = everything(folder)
    (tmp_path / "given.zip").write_bytes(zipped(files, ""))
    with pytest.raises(SpinbookError, match=re.escape(message)):
        CliRunner().invoke(update, ["../given.zip"], catch_exceptions=False)
    assert everything(folder) == before
