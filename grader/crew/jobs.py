"""What a worker can be asked to do."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any, Protocol

from grader.exercise import Exercise
from grader.recording import Recording
from grader.runner.task import Task
from grader.sandbox import Isolation, Limits, Middleware, Nursery, Program, Student, enter
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
    data_bytes: int = 8_000_000
    """What the program may publish in all messages together, over lockstep."""
    programs: tuple[Program, ...] = ()
    """The programs of a submission of several, in place of `program`."""
    companions: tuple[Program, ...] = ()
    """The author's own."""

    def run(self, nursery: Nursery, ready: Callable[[], None]) -> Recording:
        """The recording of the spin."""
        by = {Middleware.LOCKSTEP: self._over_lockstep, Middleware.FASTDDS: self._over_fast_dds}
        return by[self.middleware](nursery, ready)

    @property
    def _task(self) -> Task:
        return Task(self.exercise, self.scenario, self.file_name, self.source, self.pace)

    def _over_lockstep(self, nursery: Nursery, ready: Callable[[], None]) -> Recording:
        from grader.runner.run import run
        from rmw_lockstep.hub import Limits as HubLimits

        def start(program: Program, hub: Path) -> Student:
            return nursery.start(replace(program, hub=hub), self.isolation, self.limits, self.core)

        ready()
        return run(
            self._task,
            partial(start, self.program),
            HubLimits(data_bytes=self.data_bytes),
            {program.main: partial(start, program) for program in self.programs},
            [partial(start, program) for program in self.companions],
        )

    def _over_fast_dds(self, nursery: Nursery, ready: Callable[[], None]) -> Recording:
        from grader.crew.domain import domain_for
        from grader.runner.fastdds.run import run

        nursery.prepare(self.middleware)  # before, so that it stays outside of what is entered now
        enter(self.isolation)
        ready()
        domain = domain_for(self.isolation)
        program = replace(self.program, environment={**self.program.environment, "ROS_DOMAIN_ID": str(domain)})
        return run(
            replace(self._task, domain=domain),
            lambda: nursery.start(program, self.isolation, self.limits, self.core),
        )


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
