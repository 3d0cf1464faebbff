"""What decides a grade is in the key under which the solution's recordings and grades are kept."""

from __future__ import annotations

import shutil
from collections.abc import Callable
from pathlib import Path

import pytest

import ros_in_python
from grader.exercise import load
from grader.grading.reference import exercise_digest, versions

EXERCISE = Path(__file__).parents[3] / "exercises" / "heartbeat"


def write(name: str, text: str) -> Callable[[Path], int]:
    return lambda folder: (folder / name).write_text((folder / name).read_text() + text)


@pytest.mark.parametrize(
    ("change", "decides"),
    [
        (write("task.md", "\nGood luck!\n"), False),
        (write("exercise.toml", "\n# A comment.\n[deadline]\ndue = 2026-11-17T12:00:00Z\n"), False),
        (write("exercise.toml", '\n[[parameter]]\nname = "rate"\ntype = "double"\ndefault = 1.0\n'), True),
        (write("checks.py", "\n"), True),
        (lambda folder: (folder / "data" / "maps").rename(folder / "data" / "worlds"), True),
    ],
    ids=["task", "deadline", "parameter", "check", "folder of data"],
)
def test_all_that_decides_a_grade_counts_and_nothing_else(
    tmp_path: Path, change: Callable[[Path], object], decides: bool
) -> None:
    folder = shutil.copytree(EXERCISE, tmp_path / "heartbeat")
    (folder / "data" / "maps").mkdir(parents=True)
    (folder / "data" / "maps" / "hall.pgm").write_bytes(b"P5 1 1 255 0")
    before = exercise_digest(load(folder))
    change(folder)
    assert (exercise_digest(load(folder)) != before) is decides


def test_a_change_of_the_modules_that_programs_import_decides(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    before = versions()
    (tmp_path / "tf2.py").write_text("")
    monkeypatch.setattr(ros_in_python, "__file__", str(tmp_path / "__init__.py"))
    versions.cache_clear()
    changed = {name for name, version in versions().items() if version != before[name]}
    versions.cache_clear()
    assert changed == {"ros_in_python"}
