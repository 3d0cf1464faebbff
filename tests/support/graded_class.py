"""A class of real gradings, made once for all test processes: what pages, gradebooks and groups are made from."""

from __future__ import annotations

import fcntl
import os
import pickle
from dataclasses import replace
from datetime import datetime, timedelta, timezone
from pathlib import Path

import pytest
from few_scenarios import in_scenarios
from submissions import SUBMISSIONS

from grader.exercise import Exercise, load
from grader.exercise.mistakes import mistake_of
from grader.grading import Grade, Options, grading_of
from grader.grading.grade import Adjustment, Entry, Student
from grader.submission import Submission
from grader.submission.reader import of_source
from grader.workers import WorkerPool

ROOT = Path(__file__).parents[2]
EXERCISE = ROOT / "exercises" / "joint_velocity"
SOLUTIONS = ROOT / "solutions" / "joint_velocity"

WHEN = datetime(2026, 11, 20, 23, 41, tzinfo=timezone(timedelta(hours=1)))

#: A node whose joints' names and whose output are made to break whatever shows them.
BREAKS_PAGES = """
    def publish_velocities(self, message, positions, dt):
        print('</pre><script>window.pwned = 1</script>\\x1b[2J\\u202egnp.exe' + 'x' * 1000000, flush=True)
        answer = JointState(header=message.header)
        answer.name = ['<script>window.pwned=2</script>', '"><img src=x onerror=window.pwned=3>', '\\x1b[2J', 'a' * 500]
        answer.velocity = [float('nan'), float('inf'), 1e308, 1.0]
        self.publisher.publish(answer)

    def unused(self, message, positions, dt):"""

MISTAKES = ("fixed_dt", "joints_by_index", "position_for_velocity")

#: What differs in three scenarios already, and is graded in these alone.
SHORT = ("breaks_pages", "position_for_velocity", "joints_by_index")

#: Two mistakes at once.
TWO = ("super().__init__('joint_velocity')", "super().__init__('velocity_node')")


def graded_class(factory: pytest.TempPathFactory) -> tuple[Exercise, dict[str, Grade]]:
    """Return the exercise, and a grade for each of several submissions.

    The first test process that needs them grades them.
    """
    base = factory.getbasetemp()
    shared = base.parent if "PYTEST_XDIST_WORKER" in os.environ else base
    exercise, kept = load(EXERCISE), shared / "graded-class.pickle"
    with (shared / "graded-class.lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        if not kept.exists():
            kept.write_bytes(pickle.dumps(_grades(exercise)))
    grades: dict[str, Grade] = pickle.loads(kept.read_bytes())
    return exercise, grades


def _grades(exercise: Exercise) -> dict[str, Grade]:
    submissions = _submissions(exercise)
    with WorkerPool() as workers:
        grading = grading_of(exercise, Options(parallel=1), workers)
        few = in_scenarios(grading, "chapter", "irregular", "reordered")
        grades = {
            name: (few if name in SHORT else grading).grade(submissions[name])
            for name in submissions
            if name != "solution"
        }
        grades["solution"] = grading.judge(submissions["solution"], grading.references)
    # The worker is gone by now: a fault of ours, as the grader reports it.
    grades["host_error"] = grading.grade(submissions["solution"])
    return grades


def _submissions(exercise: Exercise) -> dict[str, Submission]:
    solution = (SOLUTIONS / "solution.py").read_text(encoding="utf-8")
    hostile = solution.replace("\n    def publish_velocities(self, message, positions, dt):", BREAKS_PAGES)
    mistakes = {name: mistake_of(exercise, name).source for name in MISTAKES}
    two = mistakes["fixed_dt"].replace(*TWO)
    assert solution != hostile
    sources = {
        "solution": solution,
        **mistakes,
        **{name: SUBMISSIONS[name].source for name in ("crashes_at_message_37", "syntax_error", "never_spins")},
        "breaks_pages": hostile,
        "two_mistakes": two,
    }
    return {name: of_source(f"{name}.py", source.encode(), exercise) for name, source in sources.items()}


def entry(grade: Grade, name: str = "Ada Lovelace", **fields: object) -> Entry:
    """An entry of the class's."""
    student = Student(_id(grade), name, "ada@example.org")
    made = Entry(student, f"{student.id}/{Path(grade.submission).name}", grade, WHEN, submitted_from="the file's date")
    return replace(made, **fields)  # type: ignore[arg-type]


def _id(grade: Grade) -> str:
    return "s-unlucky" if grade.outcome == "host-error" else f"s-{Path(grade.submission).stem}"


LATE = Adjustment("late", -8.1, "handed in 1 day late")
EXTRA = Adjustment("extra", 3.0, "found a mistake in the task")
