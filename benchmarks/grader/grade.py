"""How long grading takes: `python benchmarks/grader/grade.py --runs 5`.

Prints the median over the runs of: 10 s of robot time at 10 Hz in one run, beyond the start of the program and the
discovery of the node; a complete grade of the solution, all scenarios, sandboxed; and the command `spinbook grade` from
start to result. Each is also given as a ratio to a fixed amount of computing done beside it on the same machine, which
tells a slow machine from a slow grader.
"""

from __future__ import annotations

import argparse
import statistics
import subprocess
import sys
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
    lockstep, whole, measure, command = [], [], [], []
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
    for _ in range(runs):
        began = time.perf_counter()
        words = [Path(sys.executable).with_name("spinbook"), "grade", "joint_velocity", exercise.solution_file]
        subprocess.run(list(map(str, words)), cwd=ROOT, stdout=subprocess.DEVNULL, check=True)
        command.append(time.perf_counter() - began)
    unit = statistics.median(measure)
    rows = {"10 s of robot time at 10 Hz": lockstep, "a complete grade": whole, "the command": command}
    for name, values in rows.items():
        median = statistics.median(values)
        spread = f"{min(values):.2f} to {max(values):.2f}"
        print(f"{name:30} {median:6.2f} s  ({spread} s in {runs} runs; {median / unit:.1f} yardsticks of {unit:.2f} s)")


if __name__ == "__main__":
    main()
