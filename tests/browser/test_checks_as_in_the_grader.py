"""A check in the page records and says what the real grader's public part does, for every solution and mistake."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from grader.exercise import Exercise, load
from grader.grading import Grade, grade_submission
from grader.recording import Recording
from grader.recording.store import from_plain
from grader.submission import read
from grader.workers import WorkerPool
from spinbook.handout.student_copy import exercise_files

ROOT = Path(__file__).resolve().parents[2]
SOLUTIONS = ROOT / "solutions" / "joint_velocity"
CHECK_FILE = Path(__file__).with_name("check_file.py")
#: What every `make test` goes through; `make soak` goes through all.
ALWAYS = {"solution", "degrees", "traceback_on_ctrl_c", "wrong_topic"}
#: A page can't run these, and says so.
NEEDS_MORE = {"asyncio_loop", "numpy_arrays", "own_thread", "several_threads"}
#: What this one publishes is another thing each time.
READS_THE_TIME = {"wall_clock"}


def files() -> list[object]:
    found = sorted(file for file in SOLUTIONS.rglob("*.py"))
    return [pytest.param(f, id=f.stem, marks=() if f.stem in ALWAYS else pytest.mark.soak) for f in found]


@pytest.fixture(scope="module")
def handed_out(tmp_path_factory: pytest.TempPathFactory) -> Exercise:
    """A student's copy of the exercise."""
    folder = tmp_path_factory.mktemp("handout") / "joint_velocity"
    folder.mkdir()
    with WorkerPool() as workers:
        for name, content in exercise_files(load(ROOT / "exercises" / "joint_velocity"), workers).items():
            (folder / name).write_bytes(content)
    return load(folder).public()


def in_the_page(exercise: Exercise, file: Path, out: Path) -> dict[str, Any]:
    """What the page's check comes to."""
    command = [sys.executable, os.fspath(CHECK_FILE), os.fspath(exercise.folder), os.fspath(file), os.fspath(out)]
    done = subprocess.run(command, capture_output=True, text=True, cwd=ROOT, timeout=120, check=False)
    assert done.returncode == 0, done.stderr
    found: dict[str, Any] = json.loads(out.read_text())
    return found


def comparable(recording: Recording) -> Recording:
    """Without the words about an end, which name folders that differ."""
    return replace(recording, ending=replace(recording.ending, story=""))


@pytest.mark.parametrize("file", files())
def test_a_check_in_the_page_comes_to_the_same(handed_out: Exercise, file: Path, tmp_path: Path) -> None:
    here = in_the_page(handed_out, file, tmp_path / "result.json")
    if file.stem in NEEDS_MORE:
        assert "a web page does not have" in here["hindrance"] or "needs the browser" in here["hindrance"]
        return
    assert here["hindrance"] == ""
    grade: Grade = grade_submission(handed_out, read(str(file), handed_out))
    statuses = {v.name: [v.status, v.finding.text if v.finding else ""] for v in grade.verdicts}
    if file.stem in READS_THE_TIME:
        assert [status for status, _ in here["verdicts"].values()] == [status for status, _ in statuses.values()]
        return
    assert here["verdicts"] == statuses
    recordings = {name: comparable(recording) for name, recording in from_plain(here["recordings"]).items()}
    assert recordings == {name: comparable(grade.recordings[name]) for name in recordings}
