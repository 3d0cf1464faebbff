"""What a worker can be asked to do."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any, Protocol

from grader.exercise import Exercise
from grader.recording import Recording
from grader.sandbox import Isolation, Limits, Middleware, Nursery, Program, enter
from grader.scenario import Scenario


class Job(Protocol):
    """Something to do in a process of the crew's. `ready` is to be called once threads are allowed."""

    def run(self, nursery: Nursery, ready: Callable[[], None]) -> Any:
        """Do it."""


@dataclass(frozen=True)
class SpinJob:
    """Spin a program through one scenario. `core` is the CPU to keep the student's program on."""

    exercise: Exercise
    scenario: Scenario
    program: Program
    isolation: Isolation
    middleware: Middleware
    limits: Limits
    source: str
    file_name: str
    core: int | None = None
    pace: float | None = None

    def run(self, nursery: Nursery, ready: Callable[[], None]) -> Recording:
        """The recording of the spin."""
        from grader.crew.domain import domain_for
        from grader.rig.spin import spin
        from grader.runner.task import Task

        enter(self.isolation)
        ready()
        domain = domain_for(self.isolation)
        program = replace(self.program, environment={**self.program.environment, "ROS_DOMAIN_ID": str(domain)})
        what = Task(self.exercise, self.scenario, self.file_name, self.source, self.pace, domain)
        return spin(what, lambda: nursery.start(program, self.isolation, self.limits, self.core))


@dataclass(frozen=True)
class JudgeJob:
    """Run the exercise's checks on recordings."""

    exercise: Exercise
    recordings: dict[str, Recording]
    references: dict[str, Recording]
    titles: dict[str, str]

    def run(self, nursery: Nursery, ready: Callable[[], None]) -> Any:
        """The verdicts."""
        from grader.checking.judging import judge

        ready()
        return judge(self.exercise, self.recordings, self.references, self.titles)


@dataclass(frozen=True)
class ListJob:
    """List the exercise's checks."""

    exercise: Exercise

    def run(self, nursery: Nursery, ready: Callable[[], None]) -> Any:
        """The checks, as `Listed`."""
        from grader.checking.listing import listed

        ready()
        return listed(self.exercise)
