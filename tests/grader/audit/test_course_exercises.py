"""The course's own exercises pass their audit.

Every `make test` grades the course's solutions and beginners' mistakes (tests/grader/grading), and every mistake in the
exercise of a new course (tests/spinbook/new/test_new.py).
"""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest
from quiet_audit import Silence
from removing import remove_check

from grader.audit.audit import audit
from grader.audit.result import Audit
from grader.exercise import load
from grader.grading import Options
from grader.workers import WorkerPool

ROOT = Path(__file__).parents[3]

#: Every exercise of the course, and the one that a new course begins with.
COURSES = (ROOT, ROOT / "spinbook" / "new" / "template")
EXERCISES = [file.parent for course in COURSES for file in sorted(course.glob("exercises/*/exercise.toml"))]


def to_fix(result: Audit) -> str:
    """Return what there is to fix, as text."""
    return "\n".join(f"{problem.problem}\n    {problem.place}\n    {problem.fix}" for problem in result.problems)


@pytest.mark.soak
@pytest.mark.timeout(3600)
@pytest.mark.parametrize("folder", EXERCISES, ids=lambda folder: folder.name)
def test_the_whole_audit_finds_nothing_to_fix(folder: Path, workers_with_interfaces: WorkerPool, cache: Path) -> None:
    """Right solutions get full marks, the starter nothing, and each mistake loses exactly the checks that it names."""
    result = audit(load(folder), Options(), workers_with_interfaces, Silence())
    assert not result.problems, to_fix(result)
    assert result.score >= 0.95
    assert result.different >= (150 if folder.name == "joint_velocity" else 1)


#: Check of joint_velocity -> its file, and a mistake that no other check catches.
REMOVED = {
    "test_names_in_the_order_of_the_message": ("checks.py", "sorted_names"),
    "test_frame_is_copied": ("hidden_checks.py", "forgets_the_frame"),
    "test_publisher_restarts": ("hidden_checks.py", "leaves_out_jumps"),
}

CAN_NOT_FAIL = '''

@check(points=7, hint="Publish joints.", depends=[test_publishes_velocities])
def test_some_joints(chapter: Run) -> None:
    """There are some joints in it."""
    assert len(chapter.sent) >= len(chapter.received) - 1000, "some joints were expected"
'''


@pytest.mark.soak
@pytest.mark.timeout(3600)
def test_a_weak_copy_of_joint_velocity_is_reported_check_by_check(
    tmp_path: Path, workers_with_interfaces: WorkerPool, cache: Path
) -> None:
    for name in ("exercises", "solutions"):
        shutil.copytree(ROOT / name / "joint_velocity", tmp_path / name / "joint_velocity")
    folder = tmp_path / "exercises" / "joint_velocity"
    for check, (file, _) in REMOVED.items():
        remove_check(folder / file, check)
    with (folder / "checks.py").open("a", encoding="utf-8") as checks:
        checks.write(CAN_NOT_FAIL)
    reported = to_fix(audit(load(folder), Options(), workers_with_interfaces, Silence()))
    for check, (_, mistake) in REMOVED.items():
        assert f"the mistake mistakes/{mistake} (" in reported
        assert f"is to be caught by {check}: there is no such check" in reported
    assert "no mutant and no mistake fails test_some_joints: can it fail at all?" in reported
    assert "leaves out answer.header = message.header" in reported or "drops the frame" in reported, (
        "a mutant that survives now"
    )
