"""How often does the same program get another recording or another grade? It should be never.

    python benchmarks/determinism/determinism.py --rounds 4 --json build/determinism.json
    python benchmarks/determinism/determinism.py --rounds 20 --exercise calibration --exercise heartbeat
    python benchmarks/determinism/determinism.py --only solution.py --only thread
    python benchmarks/determinism/determinism.py --course my-robots

Of each exercise the solution and the right ones with threads are graded in each round; of this course's joint_velocity
every program in solutions/, and those in the folder programs/, which do what makes a grader flaky: they answer from
threads, timers, processes and asyncio, they sleep, poll, and wait by the clock. Every other round runs next to busy
loops, four per core. A recording differs if any message in it does, by one bit, or the time at which it came, or the
order, or a call, goal or parameter; a grade differs if any verdict does.
"""

from __future__ import annotations

import argparse
import json
import os
import sys
import time
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field, replace
from pathlib import Path

from grader.audit.candidates import mistakes, right_solutions
from grader.exercise import Exercise, load
from grader.exercise.edits import read_edits
from grader.grading import Grade, Options
from grader.grading.grading import Grading, grading_of
from grader.recording.recording import to_json
from grader.submission.reader import of_source, read
from grader.submission.submission import Submission
from grader.workers import WorkerPool
from groundwork.files import write_if_changed
from spinbook.course.course import find_course
from spinbook.interfaces.definitions import compile_course

HERE = Path(__file__).parent
COURSE = HERE.parents[1]
PROGRAMS = HERE / "programs"

sys.path.append(str(COURSE / "tests" / "support"))
from busy_loops import busy  # noqa: E402

#: Of this one every program is graded.
HARDEST = "joint_velocity"

#: Busy loops for each core in every other round.
LOOPS_PER_CORE = 4


@dataclass
class Counts:
    """What was seen of one program."""

    spins: int = 0
    grades: int = 0
    other_recordings: int = 0
    other_grades: int = 0
    host_errors: int = 0
    first: Grade | None = field(default=None, repr=False)

    def add(self, grade: Grade) -> dict[str, tuple[str, str]]:
        """Compare a grade with the first one. Return the recordings that differ, by scenario: the first, and this."""
        self.grades += 1
        self.spins += len(grade.recordings)
        if grade.outcome == "host-error":
            self.host_errors += 1
            return {}
        self.first = first = self.first or grade
        self.other_grades += grade != first
        before, now = _texts(first), _texts(grade)
        other = {name: (before.get(name, ""), text) for name, text in now.items() if before.get(name) != text}
        self.other_recordings += len(other)
        return other

    @property
    def plain(self) -> dict[str, int]:
        """As it is written."""
        return {name: value for name, value in vars(self).items() if name != "first"}


@dataclass(frozen=True)
class Program:
    """One program, with what grades it and what was seen of it."""

    name: str
    submission: Submission
    grading: Grading
    counts: Counts = field(default_factory=Counts)

    def grade(self, keep: Path) -> None:
        """Grade it once more; what differs is written to the folder `keep`."""
        exercise = self.grading.runner.exercise
        for scenario, texts in self.counts.add(self.grading.grade(self.submission)).items():
            name = f"{exercise.name}-{Path(self.name).stem}-{scenario}-{self.counts.grades}"
            for which, text in zip(("first", "other"), texts, strict=True):
                write_if_changed(keep / f"{name}-{which}.json", text)


def _texts(grade: Grade) -> dict[str, str]:
    """Each recording as a text: two NaN are the same there. How long it took, and the log, do not count."""
    return {
        name: to_json({name: replace(recording, log="", seconds=0.0, lockstep_seconds=0.0)})
        for name, recording in grade.recordings.items()
    }


def main() -> int:
    """Run all rounds, print a line for each program, and return 1 if anything differed."""
    options = _options()
    # Workers can import the course's own interfaces only if these were there before the workers start.
    compile_course(find_course(options.course))
    exercises = [load(file.parent) for file in sorted(options.course.glob("exercises/*/exercise.toml"))]
    wanted = [one for one in exercises if not options.exercise or one.name in options.exercise]
    with WorkerPool() as workers:
        programs = [
            Program(name, submission, grading_of(exercise, Options(parallel=1), workers))
            for exercise in wanted
            for name, submission in _submissions(exercise).items()
            if not options.only or any(text in name for text in options.only)
        ]
        for number in range(options.rounds):
            _round(number, programs, options)
            # After each round, so that what a long run has seen is there if it is stopped.
            _write(programs, options.json)
    return _report(programs)


def _options() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument(
        "--rounds", type=int, default=2, help="how often each program is graded  (default: %(default)s)"
    )
    parser.add_argument("--course", type=_folder, default=COURSE, help="a course's folder  (default: this course)")
    parser.add_argument("--exercise", action="append", help="only this one; may be given several times")
    parser.add_argument("--only", action="append", help="only programs whose name contains this, or another such text")
    parser.add_argument(
        "--parallel",
        type=int,
        default=2 * len(os.sched_getaffinity(0)),
        help="how many are graded at once  (default: %(default)s)",
    )
    parser.add_argument("--nice", type=int, default=0, help="how nice the busy loops are  (default: %(default)s)")
    parser.add_argument(
        "--keep",
        type=Path,
        default=Path("build/determinism"),
        help="where recordings that differ go  (default: %(default)s)",
    )
    parser.add_argument("--json", type=Path, help="write the counts to this file, too")
    return parser.parse_args()


def _folder(path: str) -> Path:
    return Path(path).resolve()


def _submissions(exercise: Exercise) -> dict[str, Submission]:
    """Return what is graded of an exercise, by a name such as `heartbeat/right/two_threads.py`."""
    candidates = right_solutions(exercise)
    if exercise.folder != COURSE / "exercises" / HARDEST:
        few = [one for one in candidates if one.kind == "solution" or "thread" in one.name]
        return {f"{exercise.name}/{one.name}": one.submission for one in few}
    programs = {f"programs/{file.name}": read(str(file), exercise) for file in sorted(PROGRAMS.glob("*.py"))}
    for edit in read_edits(PROGRAMS / "edits.md"):
        source = edit.applied_to(PROGRAMS / "relay.py")
        programs[f"programs/{edit.name}"] = of_source(f"{edit.name}.py", source.encode(), exercise)
    return programs | {f"{exercise.name}/{one.name}": one.submission for one in [*candidates, *mistakes(exercise)]}


def _round(number: int, programs: list[Program], options: argparse.Namespace) -> None:
    """Grade each program once, every other time next to busy loops."""
    began = time.monotonic()
    loops = LOOPS_PER_CORE * len(os.sched_getaffinity(0)) if number % 2 == 1 else 0
    with busy(loops, options.nice), ThreadPoolExecutor(options.parallel) as pool:
        for done in [pool.submit(program.grade, options.keep) for program in programs]:
            done.result()
    how = "next to busy loops" if loops else "alone"
    summary = f"round {number + 1}, {how}: {time.monotonic() - began:.0f} s, {_total(programs).plain}"
    print(summary, file=sys.stderr, flush=True)


def _total(programs: list[Program]) -> Counts:
    total = Counts()
    for program in programs:
        for name, value in program.counts.plain.items():
            setattr(total, name, getattr(total, name) + value)
    return total


def _report(programs: list[Program]) -> int:
    print("| program | spins | other recordings | grades | other grades | faults of the machine |")
    print("| --- | --- | --- | --- | --- | --- |")
    for program in programs:
        _print(program.name, program.counts)
    total = _total(programs)
    _print("**all**", total)
    return 1 if total.other_recordings or total.other_grades or total.host_errors else 0


def _write(programs: list[Program], file: Path | None) -> None:
    if not file:
        return
    file.parent.mkdir(parents=True, exist_ok=True)
    each = {program.name: program.counts.plain for program in programs}
    file.write_text(json.dumps({"all": _total(programs).plain, "programs": each}, indent=2) + "\n")


def _print(name: str, count: Counts) -> None:
    cells = (name, count.spins, count.other_recordings, count.grades, count.other_grades, count.host_errors)
    print("| " + " | ".join(map(str, cells)) + " |")


if __name__ == "__main__":
    sys.exit(main())
