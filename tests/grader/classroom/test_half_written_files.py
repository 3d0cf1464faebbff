"""Files that a killed run left half-written are gone after the next one began."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

from grader.classroom.results import Results
from grader.report.as_json import STUDENTS

KILLED = """
import os, pathlib, signal, sys
import groundwork.files
os.replace = lambda old, new: os.kill(os.getpid(), signal.SIGKILL)
groundwork.files.write_if_changed(pathlib.Path(sys.argv[1]), "half")
"""


def test_a_file_that_was_being_written_when_a_run_was_killed_goes_with_the_next_run(tmp_path: Path) -> None:
    for file in (tmp_path / "grades.csv", tmp_path / STUDENTS / "bert" / "grade.json"):
        subprocess.run([sys.executable, "-c", KILLED, str(file)], timeout=120)
    mine = tmp_path / ".notes.part"
    mine.touch()
    assert len([*tmp_path.rglob(".*.part")]) == 3
    with Results(tmp_path):
        assert [*tmp_path.rglob(".*.part")] == [mine]
