"""`make course`: makes a class that hands in every exercise of the course, grades all, and checks every grade.

    python benchmarks/class/grade_course.py --count 12 --seed 7 --out build/class

Ends with 1 if a single grade is not what it must be. Submissions are in OUT/submissions/EXERCISE, the page of the
course is OUT/results/index.html, and each exercise has a page of its own next to it. Run again, it grades only those
whose grade may have changed, as the command for instructors does.
"""

from __future__ import annotations

import argparse
import shutil
import signal
import subprocess
import sys
import time
from collections import Counter
from pathlib import Path

from grade_all import grade
from grades import wrong_with
from students import ROOT, Handed, course_class, write

from grader.classroom.names import student_id
from spinbook.course.course import find_course
from spinbook.gradebook import exercises_in_order
from spinbook.interfaces.definitions import compile_course


def main() -> int:
    """Make the class, grade exercise by exercise, write the gradebook, and check every grade."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--count", type=int, default=12, help="how many students")
    parser.add_argument("--seed", type=int, default=7, help="which class: the same seed makes the same one")
    parser.add_argument("--out", type=Path, default=ROOT / "build" / "class", help="a folder for all")
    parser.add_argument("--exercise", action="append", help="only this one; may be given several times")
    wanted = parser.parse_args()
    # So that the command that grades is ended, too.
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(128 + signal.SIGTERM))
    began = time.monotonic()
    course = find_course(ROOT)
    compile_course(course)
    made = course_class(wanted.exercise or exercises_in_order(course), wanted.count, wanted.seed)
    remove_others(made, wanted.out)
    wrong = [line for exercise, handed in made.items() for line in graded(exercise, handed, wanted.out)]
    command = [sys.executable, "-m", "spinbook", "gradebook", str(wanted.out / "results")]
    subprocess.run(command, cwd=ROOT, check=True)
    total = sum(len(handed) for handed in made.values())
    # Last, so that nobody has to look for it among everybody's points.
    print("".join(f"{line}\n" for line in wrong), end="")
    print(f"{total - len(wrong)} of {total} grades are what they must be, in {time.monotonic() - began:.0f} s.")
    return 1 if wrong else 0


def remove_others(made: dict[str, list[Handed]], out: Path) -> None:
    """Remove the submissions of an earlier run, and the results of a class that was not this one."""
    shutil.rmtree(out / "submissions", ignore_errors=True)
    results = out / "results"
    kept = {results / exercise / "students" / student_id(one.student) for exercise in made for one in made[exercise]}
    kept |= {results / exercise for exercise in made}
    for folder in [*results.glob("*/"), *results.glob("*/students/*/")]:
        if folder not in kept:
            shutil.rmtree(folder, ignore_errors=True)


def graded(exercise: str, handed: list[Handed], out: Path) -> list[str]:
    """Grade one exercise; return a line for each wrong grade."""
    submissions, results = out / "submissions" / exercise, out / "results" / exercise
    write(handed, submissions)
    kinds = Counter(one.kind for one in handed)
    described = ", ".join(f"{count} {kind}" for kind, count in kinds.most_common())
    print(f"\n{exercise}: {len(handed)} students: {described}", flush=True)
    grade(submissions, results, None, exercise=exercise)
    wrong = {one: why for one in handed if (why := wrong_with(one, results))}
    return [f"WRONG {exercise} {one.student} ({one.kind} {one.origin}): {why}" for one, why in wrong.items()]


if __name__ == "__main__":
    sys.exit(main())
