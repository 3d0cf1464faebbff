"""What a submission costs in classes of several sizes.

    python benchmarks/class/sizes.py 10 100 200

The class is one of right solutions and mistakes alone, so that its make-up is the same in each size. What is made once
for an exercise (the solution's recordings, the signatures of known mistakes) is there already. The CPU seconds are
those of the whole machine; where a class of another size took more of them, the machine was slower, too.
"""

from __future__ import annotations

import argparse
import shutil
import sys
import tempfile
from pathlib import Path

import psutil
from grade_all import grade
from grades import wrong_with
from students import EXERCISE, ROOT, the_class, write

from grader.classroom.signatures import signatures
from grader.exercise import load
from grader.exercise.mistakes import mistakes_of
from grader.grading import Options, grading_of
from grader.submission.reader import of_mistake
from grader.workers import WorkerPool


def main() -> int:
    """Grade a class of each size, after what is made once; print a line for each."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("sizes", type=int, nargs="*", default=[10, 100, 200], help="how many students  %(default)s")
    sizes: list[int] = parser.parse_args().sizes
    base = Path(tempfile.mkdtemp(prefix="spinbook-sizes-"))
    wrong = 0
    print(
        "| class | seconds | s a submission | CPU s a submission | a minute | MB together (PSS) "
        "| MB largest process (RSS) |\n| --- |" + " --- |" * 6
    )
    with WorkerPool() as workers:
        exercise = load(ROOT / "exercises" / EXERCISE)
        grading = grading_of(exercise, Options(), workers)
        signatures(grading, [grading.grade(of_mistake(mistake, exercise)) for mistake in mistakes_of(exercise)])
    try:
        for size in sizes:
            made = the_class(size, seed=2, hostile=False)
            folder = base / str(size)
            write(made, folder / "submissions")
            before = cpu_seconds()
            seconds, memory = grade(folder / "submissions", folder / "results", None, quiet=True)
            cpu = cpu_seconds() - before
            wrong += sum(bool(wrong_with(handed, folder / "results")) for handed in made)
            each = f"{seconds / size:.2f} | {cpu / size:.2f} | {60 * size / seconds:.0f}"
            print(f"| {size} | {seconds:.1f} | {each} | {memory.together:.0f} | {memory.largest:.0f} |", flush=True)
    finally:
        shutil.rmtree(base, ignore_errors=True)
    print(f"{wrong} grades are not what they must be.")
    return 1 if wrong else 0


def cpu_seconds() -> float:
    """What all CPUs have worked since the machine was started (s)."""
    times = psutil.cpu_times()
    return float(times.user + times.nice + times.system + times.irq + times.softirq)


if __name__ == "__main__":
    sys.exit(main())
