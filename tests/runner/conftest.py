"""What the runner's tests share: programs run in the strongest sandbox here, over the grader's own middleware."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest
from runner_programs import EXERCISE, RunProgram, numbers

from grader.crew.environment import STUDENTS
from grader.grading.spinning import ARGUMENTS
from grader.recording import Recording
from grader.runner.run import run
from grader.runner.task import Task
from grader.sandbox import Limits, Middleware, Nursery, Program, Student, choose
from grader.scenario import Scenario
from rmw_lockstep.hub import Limits as HubLimits


@pytest.fixture(scope="session")
def nursery() -> Iterator[Nursery]:
    with Nursery([Middleware.LOCKSTEP]) as nursery:
        yield nursery


@pytest.fixture
def run_program(nursery: Nursery) -> RunProgram:
    """Run a program's source through a scenario."""
    level = choose(None)

    def run_it(source: str, scenario: Scenario | None = None, limits: HubLimits | None = None) -> Recording:
        def start(hub: Path) -> Student:
            program = Program("node.py", {"node.py": source.encode()}, ARGUMENTS, STUDENTS, hub=hub)
            return nursery.start(program, level, Limits())

        return run(Task(EXERCISE, scenario or numbers(), "node.py", source), start, limits)

    return run_it
