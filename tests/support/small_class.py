"""A class of six in a small course, graded by the real command."""

from __future__ import annotations

import json
import os
import re
import shutil
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

from prepared_python import run_prepared

from grader.exercise import load
from grader.exercise.mistakes import mistake_of

ROOT = Path(__file__).parents[2]
TEMPLATE = ROOT / "spinbook" / "new" / "template"
EXERCISE = "speed_limit"

#: What each of the six must get, of 20 points.
POINTS = {"ana": 20, "bert": 20, "carl": 15, "dora": 17, "emil": 12, "fay": 0}

#: The usual mistakes of the exercise. Nobody makes the last one.
MISTAKES = ("only_forwards", "trusts_every_number", "full_speed_for_no_number", "ignores_ctrl_c")


class SmallClass:
    """A course with one exercise, and the submissions of six students: see `POINTS`."""

    def __init__(self, folder: Path, cache: Path) -> None:
        self.folder, self._cache = folder, cache
        for part in ("exercises", "solutions"):
            shutil.copytree(TEMPLATE / part, folder / part, ignore=shutil.ignore_patterns("__pycache__"))
        self.exercise = folder / "exercises" / EXERCISE
        _keep_mistakes(folder / "solutions" / EXERCISE / "mistakes.md")
        self.submissions = folder / "submissions"
        self.submissions.mkdir()
        exercise = load(self.exercise)
        right = _quiet((folder / "solutions" / EXERCISE / "solution.py").read_text(encoding="utf-8"))
        forwards = _quiet(mistake_of(exercise, "only_forwards").source)
        self.hand_in("ana", right)
        self.hand_in("bert", f"# mine\n{right}")
        self.hand_in("carl", forwards)
        self.hand_in("dora", _quiet(mistake_of(exercise, "trusts_every_number").source))
        self.hand_in("emil", forwards.replace("0.0 if math.isnan(message.data) else ", ""))
        self.hand_in("fay", "import rclpy\n\nrclpy.spin(\n")

    def hand_in(self, student: str, source: str) -> None:
        """Write one student's file, with a fixed date, which differs by minutes from the others'."""
        file = self.submissions / f"{student}.py"
        file.write_text(source, encoding="utf-8")
        os.utime(file, (1_794_990_300 + 100 * ord(student[0]),) * 2)

    def start(self, *arguments: str, out: str = "results") -> subprocess.Popen[str]:
        """Start the command, in a process group of its own."""
        command = [sys.executable, "-m", "grader", EXERCISE, "submissions", "--out", out, *arguments]
        return subprocess.Popen(
            command,
            cwd=self.folder,
            env=self.environment,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            start_new_session=True,
        )

    def grade(self, *arguments: str, out: str = "results") -> tuple[int, str]:
        """Return the command's exit code, and everything it printed."""
        words = (EXERCISE, "submissions", "--out", out, *arguments)
        done = run_prepared("grader", *words, cwd=self.folder, env=self.environment, merged=True)
        return done.returncode, done.stdout

    @property
    def environment(self) -> dict[str, str]:
        """The variables with which the command runs."""
        return {**os.environ, "SPINBOOK_CACHE": str(self._cache), "COLUMNS": "200"}

    def wait_for_grades(self, count: int, process: subprocess.Popen[str], out: str = "results") -> None:
        """Wait until `count` students have a grade, or the command has ended."""
        students = self.folder / out / "students"
        wait_until(lambda: len(list(students.glob("*/grade.json"))) >= count or process.poll() is not None)

    def entry(self, student: str, out: str = "results") -> dict[str, Any]:
        """Return the content of a student's grade.json."""
        file = self.folder / out / "students" / student / "grade.json"
        entry: dict[str, Any] = json.loads(file.read_text(encoding="utf-8"))
        return entry

    def finals(self, out: str = "results") -> dict[str, float]:
        """Return the points that count, by student."""
        students = sorted(file.parent.name for file in (self.folder / out).glob("students/*/grade.json"))
        return {student: self.entry(student, out)["final"] for student in students}


def _keep_mistakes(file: Path) -> None:
    """Leave in the file only the mistakes that students make here, and one that nobody makes."""
    parts = re.split(r"^(?=## )", file.read_text(encoding="utf-8"), flags=re.MULTILINE)
    kept = [part for part in parts if not part.startswith("## ") or part.split()[1] in MISTAKES]
    file.write_text("".join(kept), encoding="utf-8")


def _quiet(source: str) -> str:
    """Return the program without what rclpy logs at most once a second of real time: that is more on a busy machine."""
    return "".join(line for line in source.splitlines(keepends=True) if "throttle_duration_sec" not in line)


def wait_until(happened: Callable[[], object], timeout_s: float = 240) -> None:
    """Wait for a condition; fail the test if it never becomes true."""
    deadline = time.monotonic() + timeout_s
    while not happened():
        assert time.monotonic() < deadline, "it never happened"
        time.sleep(0.02)


def without_timings(results: Path) -> dict[str, str]:
    """Return every file in a folder of results, by its path, without timings."""
    found = {}
    for file in sorted(results.rglob("*")):
        # Recordings are compressed, and contain timings, too.
        if file.is_file() and file.name != ".lock" and file.suffix != ".gz":
            text = file.read_text(encoding="utf-8")
            text = re.sub(r'"(seconds|execution_time)": [\d.e-]+', r'"\1": 0', text)
            found[str(file.relative_to(results))] = re.sub(r' time="[\d.]+"', "", text)
    return found
