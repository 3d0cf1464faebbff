"""`make class`: makes a class, grades it with the command that instructors use, and checks every grade.

    python benchmarks/class/grade_all.py --count 200 --seed 1 --out build/class

Ends with 1 if a single grade is not what it must be. The submissions, the pages and the gradebook stay in --out.
"""

from __future__ import annotations

import argparse
import os
import shutil
import subprocess
import sys
import time
from collections import Counter
from pathlib import Path

from grades import wrong_with
from memory import Memory, Watched
from students import EXERCISE, ROOT, Handed, the_class, write

from grader.classroom.local import at_once


def main() -> int:
    """Make, grade, check, tell."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--count", type=int, default=200, help="how many students")
    parser.add_argument("--seed", type=int, default=1, help="which class: the same seed makes the same one")
    parser.add_argument("--out", type=Path, default=ROOT / "build" / "class", help="a folder, made anew")
    parser.add_argument(
        "--jobs", type=int, default=_jobs(), help="how many submissions at once  (default: %(default)s)"
    )
    wanted = parser.parse_args()
    made = the_class(wanted.count, wanted.seed)
    shutil.rmtree(wanted.out, ignore_errors=True)
    submissions, results = wanted.out / "submissions", wanted.out / "results"
    write(made, submissions)
    kinds = Counter(handed.kind for handed in made)
    print(f"{len(made)} students: " + ", ".join(f"{count} {kind}" for kind, count in kinds.most_common()), flush=True)
    seconds, memory = grade(submissions, results, wanted.jobs)
    return tell(made, results, seconds, memory, wanted.jobs)


def _jobs() -> int:
    """Return how many submissions the grader runs at once if nobody says otherwise."""
    return at_once()


def grade(
    submissions: Path, results: Path, jobs: int | None, quiet: bool = False, exercise: str = EXERCISE
) -> tuple[float, Memory]:
    """Grade with the real command; how long it took in seconds, and its memory. Ends this program where it fails."""
    command = [sys.executable, "-m", "grader", exercise, str(submissions), "--out", str(results)]
    began = time.monotonic()
    process = subprocess.Popen(
        [*command, *(["--jobs", str(jobs)] if jobs else [])], cwd=ROOT, stdout=subprocess.DEVNULL if quiet else None
    )
    try:
        with Watched(process.pid) as watched:
            status = process.wait()
    finally:
        process.terminate()
        process.wait()
    if status:
        sys.exit(f"The command ended with {status}.")
    return time.monotonic() - began, watched.memory


def tell(made: list[Handed], results: Path, seconds: float, memory: Memory, jobs: int) -> int:
    """Say which grades are wrong; returns the exit code."""
    wrong = {handed: problem for handed in made if (problem := wrong_with(handed, results))}
    for handed, problem in wrong.items():
        print(f"WRONG {handed.student} ({handed.kind} {handed.origin}): {problem}")
    print(f"{seconds:.0f} s, {60 * len(made) / seconds:.1f} submissions a minute, load {os.getloadavg()[0]:.1f}")
    print(
        f"memory: {memory.together:.0f} MB together at most (PSS of {memory.processes} processes), "
        f"{memory.together / jobs:.0f} MB for each of {jobs} gradings at once, "
        f"{memory.largest:.0f} MB the largest process (RSS)"
    )
    print(f"{len(made) - len(wrong)} of {len(made)} grades are what they must be.")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
