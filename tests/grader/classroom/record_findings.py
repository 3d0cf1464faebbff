"""Grade every mistake of every exercise once, and store how each of them fails: `recorded/EXERCISE.json`.

    .venv/bin/python tests/grader/classroom/record_findings.py [EXERCISE ...]

Run it after changing the words of checks. It takes about 3 s of CPU time per mistake.
"""

from __future__ import annotations

import json
import sys
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from pathlib import Path

from recorded_findings import FOLDER, Recorded, as_json
from unlisted_mistakes import UNLISTED

from grader.exercise import Exercise, load
from grader.exercise.mistakes import mistakes_of
from grader.grading import Options, grading_of
from grader.grading.grading import Grading
from grader.submission.reading import of_source
from grader.workers import WorkerPool
from spinbook.course.course import find_course
from spinbook.interfaces.definitions import compile_course

ROOT = Path(__file__).parents[3]


def programs(exercise: Exercise) -> Iterator[tuple[str, str]]:
    """Yield name and source: first the mistakes that `solutions/` lists, then the others."""
    assert exercise.solution_file
    for mistake in mistakes_of(exercise):
        yield mistake.name, mistake.source
    for name, mistake in UNLISTED[exercise.name].items():
        source = exercise.solution_file.read_text(encoding="utf-8")
        for old, new in mistake.replaced:
            if old not in source:
                raise SystemExit(f"{name} of {exercise.name}: the solution has no {old!r}")
            source = source.replace(old, new)
        yield name, source


def recorded(grading: Grading, mistake: tuple[str, str]) -> Recorded:
    """Return how one mistake fails."""
    name, source = mistake
    grade = grading.grade(of_source(f"{name}.py", source.encode(), grading.runner.exercise))
    failed = [verdict for verdict in grade.verdicts if verdict.status == "failed" and verdict.finding]
    findings = {v.name: (v.finding.text, v.finding.expected, v.finding.got) for v in failed if v.finding}
    blocked = tuple(verdict.name for verdict in grade.verdicts if verdict.status == "blocked")
    return Recorded(name, grade.outcome, findings, blocked)


def main(names: list[str]) -> None:
    """Record exercises by name; all of them, if none is named."""
    compile_course(find_course(ROOT))
    for name in names or sorted(UNLISTED):
        exercise = load(ROOT / "exercises" / name)
        with WorkerPool() as workers, ThreadPoolExecutor(2) as pool:
            grading = grading_of(exercise, Options(), workers)
            found = list(pool.map(partial(recorded, grading), list(programs(exercise))))
        (FOLDER / f"{name}.json").write_text(json.dumps(as_json(found), indent=0, ensure_ascii=False), encoding="utf-8")
        print(name, len(found), flush=True)


if __name__ == "__main__":
    main(sys.argv[1:])
