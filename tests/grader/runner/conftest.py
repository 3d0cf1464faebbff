"""What the runner's tests share: programs run in the strongest sandbox here, over the grader's own middleware."""

from __future__ import annotations

from collections.abc import Iterator

import pytest
from runner_programs import EXERCISE, RunProgram, numbers

from grader.grading.scenario_runner import ARGUMENTS
from grader.recording import Recording
from grader.runner.program import Task
from grader.runner.run import run
from grader.sandbox import ForkServer, Limits, ProgramSpec, SandboxedProgram, choose
from grader.scenario import Scenario
from grader.workers.pool import STUDENT_ENVIRONMENT
from rmw_lockstep.hub import HubLimits


@pytest.fixture(scope="session")
def fork_server() -> Iterator[ForkServer]:
    with ForkServer() as fork_server:
        yield fork_server


@pytest.fixture
def run_program(fork_server: ForkServer) -> RunProgram:
    """Run a program's source through a scenario."""
    level = choose(None)

    def run_it(source: str, scenario: Scenario | None = None, limits: HubLimits | None = None) -> Recording:
        def start(hub: int) -> SandboxedProgram:
            program = ProgramSpec("node.py", {"node.py": source.encode()}, ARGUMENTS, STUDENT_ENVIRONMENT, hub=hub)
            return fork_server.start(program, level, Limits())

        return run(Task(EXERCISE, scenario or numbers(), "node.py", source), start, limits)

    return run_it
