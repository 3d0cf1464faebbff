"""Grades a class of sixty with hostile names in several exercises, kills the grading again and again, and checks all.

    python benchmarks/class/mixed_class.py --count 60 --exercise joint_velocity --exercise heartbeat

All submissions are in one nbgrader folder. Each exercise's command is killed twice with SIGKILL while it grades, and
then run to its end, with a roster of everybody. Ends with 1 if a single grade is not what it must be.
"""

from __future__ import annotations

import argparse
import json
import random
import shutil
import signal
import subprocess
import sys
import time
from dataclasses import replace
from pathlib import Path

from grades import wrong_with
from students import ROOT, Handed, course_class

from grader.classroom.names import student_id

#: Names with a meaning in a page, a spreadsheet, a shell, a file system or a terminal, and in many scripts.
HOSTILE = (
    *("index.html", "grades.csv", "reference-1.json.gz", "=HYPERLINK(1)", "<script>alert(1)<_script>", "\x1b[2J"),
    *("-rf", "--out", "CON", "$(reboot)", "\u202egnp", "x" * 240, "é" * 100, "{{ 7 * 7 }}", "Zoë", "Zoé", "अंकिता"),
    *("สมชาย", "محمد", "Nguyễn", "x_7_assignsubmission_file_", "miller_LATE_12_34_node", "a,b;c", 'O\'Neil "Bo"'),
)
TIMES = ("2026-11-20 22:01:00.000000 UTC", "2026-11-20 22:01 CET", "2026-11-20T22:01:00Z", "2026-11-20 22:01:00 PST")


def main() -> int:
    """Make, grade, kill, grade, check."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--count", type=int, default=60, help="how many students")
    parser.add_argument("--seed", type=int, default=3, help="which class, and when it is killed")
    parser.add_argument("--out", type=Path, default=ROOT / "build" / "mixed", help="a folder, made anew")
    parser.add_argument("--exercise", action="append", help="may be given several times")
    wanted = parser.parse_args()
    made = course_class(wanted.exercise or ["joint_velocity", "heartbeat", "motor_switch"], wanted.count, wanted.seed)
    shutil.rmtree(wanted.out, ignore_errors=True)
    named = _write(made, wanted.out)
    chance = random.Random(wanted.seed)
    wrong = sum(_graded(exercise, handed, wanted.out, chance) for exercise, handed in named.items())
    total = wanted.count * len(named)
    print(f"{total - wrong} of {total} rows are what they must be.")
    return 1 if wrong else 0


def _write(made: dict[str, list[Handed]], out: Path) -> dict[str, list[Handed]]:
    """Write submitted/STUDENT/EXERCISE/ and the roster; returns the class under the names that it has there."""
    everybody = sorted({one.student for handed in made.values() for one in handed})
    names = dict(zip(everybody, [*HOSTILE, *everybody[len(HOSTILE) :]], strict=False))
    named = {exercise: [replace(one, student=names[one.student]) for one in made[exercise]] for exercise in made}
    for exercise, handed in named.items():
        for number, one in enumerate(handed):
            folder = out / "submitted" / one.student / exercise
            folder.mkdir(parents=True)
            one.write(folder)
            (folder / "timestamp.txt").write_text(TIMES[number % len(TIMES)])
    quoted = [name.replace('"', '""') for name in names.values()]
    (out / "roster.csv").write_text("student\n" + "".join(f'"{name}"\n' for name in quoted), encoding="utf-8")
    return named


def _graded(exercise: str, handed: list[Handed], out: Path, chance: random.Random) -> int:
    """Grade one exercise, killed twice; returns how many rows are wrong, and names them."""
    results = out / "results" / exercise
    command = [sys.executable, "-m", "grader", exercise, str(out / "submitted"), "--out", str(results)]
    command += ["--roster", str(out / "roster.csv")]
    for share in (0.3, 0.6):
        process = subprocess.Popen(command, cwd=ROOT, stdout=subprocess.DEVNULL)
        while process.poll() is None and _count(results) < share * len(handed) + chance.randrange(4):
            time.sleep(0.05)
        process.send_signal(signal.SIGKILL)
        process.wait()
        print(f"{exercise}: killed after {_count(results)} of {len(handed)}", flush=True)
    code = subprocess.run(command, cwd=ROOT).returncode
    wrong = {one.student: why for one in handed if (why := wrong_with(one, results))}
    kept = {file.parent.name: json.loads(file.read_text()) for file in results.glob("students/*/grade.json")}
    missing = {who for who, entry in kept.items() if entry["grade"]["outcome"] == "missing"}
    if (code, len(kept), len(missing)) != (0, _everybody(out), _everybody(out) - len(handed)):
        wrong["everybody"] = f"code {code}, {len(kept)} rows, {len(missing)} of them missing"
    if missing & {student_id(one.student) for one in handed}:
        wrong["missing"] = "somebody who handed in is missing"
    for who, why in wrong.items():
        print(f"WRONG {exercise} {who!r}: {why}")
    return len(wrong)


def _count(results: Path) -> int:
    return len(list(results.glob("students/*/grade.json")))


def _everybody(out: Path) -> int:
    return len((out / "roster.csv").read_text(encoding="utf-8").splitlines()) - 1


if __name__ == "__main__":
    sys.exit(main())
