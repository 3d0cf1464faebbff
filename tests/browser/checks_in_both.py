"""Checks every program of an exercise's solutions as a page does, and by the real grader, and prints the differences.

    python tests/browser/checks_in_both.py EXERCISE [NAME …]

Prints a JSON object: name of the program -> "same", why a page does not check it, or how the two differ. NAME is a
file's name without `.py`. A process of its own, since it uses the course's interfaces.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

from grader.exercise import Exercise, load
from grader.grading import grade_submission
from grader.recording import Recording
from grader.recording.store import from_plain
from grader.submission import read
from grader.workers import WorkerPool
from spinbook.course.course import find_course
from spinbook.handout.student_copy import exercise_files
from spinbook.interfaces.compiling import compile_course

ROOT = Path(__file__).resolve().parents[2]
CHECK_FILE = Path(__file__).with_name("check_file.py")


def handed_out(name: str, folder: Path) -> Exercise:
    """Return a student's copy of the exercise, in `folder`."""
    with WorkerPool() as workers:
        for file, content in exercise_files(load(ROOT / "exercises" / name), workers).items():
            (folder / file).parent.mkdir(parents=True, exist_ok=True)
            (folder / file).write_bytes(content)
    return load(folder).public()


def in_the_page(exercise: Exercise, file: Path, out: Path) -> dict[str, Any]:
    """What the page's check comes to, from a process that runs over rcl_python."""
    command = [sys.executable, os.fspath(CHECK_FILE), os.fspath(exercise.folder), os.fspath(file), os.fspath(out)]
    done = subprocess.run(["timeout", "-k", "1", "60", *command], capture_output=True, text=True, cwd=ROOT, check=False)
    assert done.returncode == 0, f"exit code {done.returncode}: {done.stderr}"
    found: dict[str, Any] = json.loads(out.read_text(encoding="utf-8"))
    return found


def comparable(recording: Recording) -> Recording:
    """Return the result without messages about an end, which name folders that differ."""
    return replace(recording, ending=replace(recording.ending, story=""))


def compared(exercise: Exercise, file: Path, folder: Path) -> str:
    """How the page's check of a program differs from the real grader's."""
    try:
        here = in_the_page(exercise, file, folder / "result.json")
    except AssertionError as error:
        return str(error)
    if here["hindrance"]:
        return f"not checked: {here['hindrance']}"
    grade = grade_submission(exercise, read(str(file), exercise))
    statuses = {v.name: [v.status, v.finding.text if v.finding else ""] for v in grade.verdicts}
    return "; ".join(_differences(here, statuses, grade.recordings)) or "same"


def _differences(here: dict[str, Any], statuses: dict[str, Any], there: dict[str, Recording]) -> Iterator[str]:
    for name, status in statuses.items():
        if here["verdicts"].get(name) != status:
            yield f"{name}: {here['verdicts'].get(name)} instead of {status}"
    for name, recording in from_plain(here["recordings"]).items():
        mine, theirs = vars(comparable(recording)), vars(comparable(there[name]))
        for field in mine:
            if field not in ("log", "seconds", "lockstep_seconds") and mine[field] != theirs[field]:
                yield f"{name}: {field}: {_first(mine[field], theirs[field])}"


def _first(mine: Any, theirs: Any) -> str:
    if isinstance(mine, tuple) and isinstance(theirs, tuple):
        pairs = [pair for pair in zip(mine, theirs, strict=False) if pair[0] != pair[1]]
        return f"{len(mine)} and {len(theirs)} of them; {pairs[0] if pairs else 'one has more'}"
    return f"{mine} instead of {theirs}"


def main(name: str, only: list[str]) -> int:
    """Compare the programs of an exercise, and print what was found."""
    compile_course(find_course(ROOT))
    files = sorted(file for file in (ROOT / "solutions" / name).rglob("*.py") if not only or file.stem in only)
    with tempfile.TemporaryDirectory() as place:
        copy = Path(place) / name
        copy.mkdir()
        exercise = handed_out(name, copy)
        found = {}
        for file in files:
            found[file.stem] = compared(exercise, file, Path(place))
            print(f"{file.stem}: {found[file.stem]}", file=sys.stderr, flush=True)
    print(json.dumps(found))
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1], sys.argv[2:]))
