"""However large a class, one student's recordings are released before the next student's."""

from __future__ import annotations

import gc
from pathlib import Path

import pytest
from small_class import SmallClass

from grader.classroom.collector import collect
from grader.classroom.deadline import Adjuster
from grader.classroom.local import LocalBackend
from grader.classroom.results import ClassGrading, Results
from grader.exercise import load
from grader.grading import Options, grading_of
from grader.recording import Recording
from grader.submission import read
from grader.workers import WorkerPool


def test_recordings_of_graded_students_do_not_stay_in_memory(
    small_class: SmallClass, cache: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("SPINBOOK_CACHE", str(cache))
    for student in ("dora", "emil", "fay"):
        (small_class.submissions / f"{student}.py").unlink()
    exercise = load(small_class.exercise)
    collected = collect(small_class.submissions, exercise, tmp_path)
    submissions = {one.student.id: (read(str(one.file.path), exercise),) for one in collected.handed_in}
    with Results(small_class.folder / "results") as results, WorkerPool() as workers:
        grading = grading_of(exercise, Options(), workers)
        class_grading = ClassGrading(exercise, LocalBackend(grading, 2), results, Adjuster())
        plan = class_grading.plan(collected, submissions, lambda who: True)
        before = recordings()
        graded = list(class_grading.run(plan, submissions))
        assert len(graded) == len(class_grading.entries) == 3
        assert recordings() == before


def recordings() -> int:
    gc.collect()
    return sum(isinstance(one, Recording) for one in gc.get_objects())
