"""How long grading takes: `python benchmarks/grader/grade.py --runs 5`.

Prints the median over the runs of: 10 s of robot time at 10 Hz in one run, beyond the start of the program and the
discovery of the node; and a complete grade of the solution, all scenarios, sandboxed. Each is also given as a ratio
to a fixed amount of computing done beside it on the same machine, which tells a slow machine from a slow grader.
"""

from __future__ import annotations

import argparse
import statistics
import time
from pathlib import Path

from grader.exercise import load
from grader.grading import Options, grading_of
from grader.submission import read
from grader.workers import WorkerPool

ROOT = Path(__file__).parents[2]


def yardstick() -> float:
    """Seconds that a fixed computation takes here and now."""
    began = time.perf_counter()
    sum(i * i for i in range(3_000_000))
    return time.perf_counter() - began


def main() -> None:
    """Run and print."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--runs", type=int, default=5)
    runs = parser.parse_args().runs
    exercise = load(ROOT / "exercises" / "joint_velocity")
    assert exercise.solution_file
    submission = read(str(exercise.solution_file), exercise)
    lockstep, whole, measure = [], [], []
    with WorkerPool() as workers:
        grading = grading_of(exercise, Options(), workers)
        alone = grading_of(exercise, Options(parallel=1), workers)
        for _ in range(runs):
            measure.append(yardstick())
            began = time.perf_counter()
            grade = grading.grade(submission)
            whole.append(time.perf_counter() - began)
            assert grade.full_marks, grade
            chapter = alone.runner.only("chapter").run(submission)["chapter"]
            lockstep.append(chapter.lockstep_seconds)
    unit = statistics.median(measure)
    for name, values in (("10 s of robot time at 10 Hz", lockstep), ("a complete grade", whole)):
        median = statistics.median(values)
        spread = f"{min(values):.2f} to {max(values):.2f}"
        print(f"{name:30} {median:6.2f} s  ({spread} s in {runs} runs; {median / unit:.1f} yardsticks of {unit:.2f} s)")


if __name__ == "__main__":
    main()
