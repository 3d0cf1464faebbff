"""The course's own exercises prove themselves."""

from __future__ import annotations

from pathlib import Path

import pytest
from quiet_audit import Silence

from grader.audit.audit import audit
from grader.audit.result import Audit
from grader.crew import Crew
from grader.exercise import load
from grader.grading import Options

EXERCISES = sorted(file.parent for file in (Path(__file__).parents[2] / "exercises").glob("*/exercise.toml"))


def to_mend(result: Audit) -> str:
    """What there is to mend, as text."""
    return "\n".join(f"{problem.found}\n    {problem.place}\n    {problem.mend}" for problem in result.problems)


@pytest.mark.parametrize("folder", EXERCISES, ids=lambda folder: folder.name)
def test_every_mistake_is_caught_by_the_checks_that_it_names(folder: Path, crew: Crew, cache: Path) -> None:
    result = audit(load(folder), Options(), crew, Silence(), quick=True)
    assert not result.problems, to_mend(result)


@pytest.mark.soak
@pytest.mark.timeout(3600)
@pytest.mark.parametrize("folder", EXERCISES, ids=lambda folder: folder.name)
def test_the_whole_audit_finds_nothing_to_mend(folder: Path, crew: Crew, cache: Path) -> None:
    result = audit(load(folder), Options(), crew, Silence())
    assert not result.problems, to_mend(result)
    assert result.score >= 0.95


@pytest.mark.soak
def test_joint_velocity_has_enough_mutants(crew: Crew, cache: Path) -> None:
    result = audit(load(EXERCISES[0].parent / "joint_velocity"), Options(), crew, Silence())
    assert result.different >= 150
