"""Checks every program of an exercise's solutions as a page does, and by the real grader, and prints the differences.

    python tests/spinbook/browser/checks_in_both.py EXERCISE [NAME …]

Prints a JSON object: name of the program -> "same", why a page does not check it, or how the two differ. NAME is that
of a program in `solutions/`, or the path of any other one. It is a process of its own, since it uses the course's
interfaces.
"""

from __future__ import annotations

import json
import os
import select
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

from grader.audit.candidates import mistakes, right_solutions
from grader.exercise import Exercise, load
from grader.grading.grade import Options
from grader.grading.grading import Grading, grading_of
from grader.recording import Recording
from grader.recording.arrays import read_arrays
from grader.recording.recording import from_plain
from grader.submission import Submission, read
from grader.workers import WorkerPool
from spinbook.course.course import find_course
from spinbook.handout.student_copy import exercise_files
from spinbook.interfaces.definitions import compile_course

ROOT = Path(__file__).resolve().parents[3]
CHECK_FILES = Path(__file__).with_name("check_files.py")
#: A page gives a check as long.
LIMIT_S = 120


def handed_out(name: str, folder: Path) -> Exercise:
    """Return a student's copy of the exercise, in `folder`."""
    with WorkerPool() as workers:
        for file, content in exercise_files(load(ROOT / "exercises" / name), workers).items():
            (folder / file).parent.mkdir(parents=True, exist_ok=True)
            (folder / file).write_bytes(content)
    return load(folder).public()


class InThePage:
    """What the page's check comes to, from a process over rcl_python that checks one file after another."""

    def __init__(self, exercise: Exercise) -> None:
        self._command = [sys.executable, os.fspath(CHECK_FILES), os.fspath(exercise.folder)]
        self._process: subprocess.Popen[str] | None = None

    def check(self, file: Path) -> dict[str, Any]:
        """What it says of a file. Raises AssertionError where the process ends, or does not answer."""
        process = self._process or self._start()
        assert process.stdin
        assert process.stdout
        process.stdin.write(f"{file}\n")
        process.stdin.flush()
        ready, _, _ = select.select([process.stdout], [], [], LIMIT_S)
        answer = process.stdout.readline() if ready else ""
        if not answer:
            self.close()
            raise AssertionError("ended unexpectedly" if ready else f"no answer within {LIMIT_S} s")
        found: dict[str, Any] = json.loads(answer, object_hook=read_arrays())
        return found

    def _start(self) -> subprocess.Popen[str]:
        self._process = subprocess.Popen(
            self._command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True, encoding="utf-8", cwd=ROOT
        )
        return self._process

    def close(self) -> None:
        """End the process."""
        if self._process is not None:
            self._process.kill()
            self._process.communicate()
        self._process = None


def comparable(recording: Recording) -> Recording:
    """Return the result without messages about an end, which name folders that differ."""
    return replace(recording, ending=replace(recording.ending, message=""))


def compared(page: InThePage, grading: Grading, exercise: Exercise, submission: Submission) -> str:
    """How the page's check of a program differs from the real grader's."""
    file = exercise.folder.parent / Path(submission.name).name
    file.write_text(submission.source, encoding="utf-8")
    try:
        here = page.check(file)
    except AssertionError as error:
        return str(error)
    if here["hindrance"]:
        return f"not checked: {here['hindrance']}"
    grade = grading.grade(submission)
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
    author = load(ROOT / "exercises" / name)
    programs = {Path(one.name).stem: one.submission for one in [*right_solutions(author), *mistakes(author)]}
    programs = {program: submission for program, submission in programs.items() if not only or program in only}
    programs |= {Path(file).stem: read(file, author) for file in only if file.endswith(".py")}
    with tempfile.TemporaryDirectory() as place:
        copy = Path(place) / name
        copy.mkdir()
        exercise = handed_out(name, copy)
        page, found = InThePage(exercise), {}
        with WorkerPool() as workers:
            grading = grading_of(exercise, Options(), workers)
            for program, submission in programs.items():
                found[program] = compared(page, grading, exercise, submission)
                print(f"{program}: {found[program]}", file=sys.stderr, flush=True)
        page.close()
    print(json.dumps(found))
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1], sys.argv[2:]))
