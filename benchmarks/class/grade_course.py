"""`make course`: makes a class that hands in every exercise of the course, grades all, and checks every grade.

    python benchmarks/class/grade_course.py --count 12 --seed 7 --out build/class

Ends with 1 if a single grade is not what it must be. Submissions are in OUT/submissions/EXERCISE, the page of the
course is OUT/results/index.html, and each exercise has a page of its own next to it.
"""

from __future__ import annotations

import argparse
import shutil
import subprocess
import sys
import time
from collections import Counter
from pathlib import Path

from grade_all import grade
from grades import wrong_with
from students import ROOT, Handed, course_class, write

from spinbook.course.course import find_course
from spinbook.gradebook import exercises_in_order


def main() -> int:
    """Make the class, grade exercise by exercise, write the gradebook, and check every grade."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--count", type=int, default=12, help="how many students")
    parser.add_argument("--seed", type=int, default=7, help="which class: the same seed makes the same one")
    parser.add_argument("--out", type=Path, default=ROOT / "build" / "class", help="a folder, made anew")
    parser.add_argument("--exercise", action="append", help="only this one; may be given several times")
    wanted = parser.parse_args()
    exercises = wanted.exercise or exercises_in_order(find_course(ROOT))
    made = course_class(exercises, wanted.count, wanted.seed)
    shutil.rmtree(wanted.out, ignore_errors=True)
    began = time.monotonic()
    wrong = [line for exercise, handed in made.items() for line in graded(exercise, handed, wanted.out)]
    command = [sys.executable, "-m", "spinbook", "gradebook", str(wanted.out / "results")]
    subprocess.run(command, cwd=ROOT, check=True)
    total = sum(len(handed) for handed in made.values())
    # Last, so that nobody has to look for it among everybody's points.
    print("".join(f"{line}\n" for line in wrong), end="")
    print(f"{total - len(wrong)} of {total} grades are what they must be, in {time.monotonic() - began:.0f} s.")
    return 1 if wrong else 0


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
