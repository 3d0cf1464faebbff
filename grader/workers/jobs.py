"""What a worker can do, and the ROS domain that it uses for it."""

from __future__ import annotations

import os
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cache, partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol

from grader.exercise.exercise import Exercise
from grader.recording.recording import Recording
from grader.runner.student import Task
from grader.sandbox.isolation import Isolation
from grader.sandbox.namespaces import enter
from grader.sandbox.program import Limits, Middleware, Program
from grader.scenario.scenario import Scenario
from groundwork.files import claim_number

if TYPE_CHECKING:
    from grader.checking.run import Run
    from grader.sandbox.fork_server import (
        ForkServer,  # the worker hands it in
        Student,
    )

#: Inside network namespaces of its own a runner is alone in every domain.
ALONE = 42

#: Domains whose UDP ports are above those that Linux gives to programs which request no particular one
#: (7400 + 250 x domain > 60999), and which no ROS user chooses by hand.
SHARED = range(215, 233)


@cache
def domain_for(isolation: Isolation) -> int:
    """Return the domain of this process; it is reserved until the process ends. Raises OSError when none is left."""
    if isolation in (Isolation.BUBBLEWRAP, Isolation.NAMESPACES):
        return ALONE
    # This machine's: a worker has a temporary folder of its own.
    folder = Path("/tmp", f"spinbook-domains-{os.getuid()}")
    folder.mkdir(mode=0o700, exist_ok=True)
    # Never closed: the lock ends with the process.
    claimed = claim_number(folder, SHARED)
    if claimed is None:
        raise OSError("all ROS domains for grading are in use by other gradings on this machine")
    return claimed[0]


class Job(Protocol):
    """Something to do in a process of the worker pool. `ready` is to be called once threads are allowed."""

    def run(self, fork_server: ForkServer, ready: Callable[[], None]) -> Any:
        """Do it."""


@dataclass(frozen=True)
class RunJob:
    """Run a program through one scenario. `core` is the CPU to keep the student's program on."""

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
    """The programs of a submission with several, instead of `program`."""
    companions: tuple[Program, ...] = ()
    """The author's own programs."""

    def run(self, fork_server: ForkServer, ready: Callable[[], None]) -> Recording:
        """Return the recording of the run."""
        by = {Middleware.LOCKSTEP: self._over_lockstep, Middleware.FASTDDS: self._over_fast_dds}
        return by[self.middleware](fork_server, ready)

    @property
    def _task(self) -> Task:
        return Task(self.exercise, self.scenario, self.file_name, self.source, self.pace)

    def _over_lockstep(self, fork_server: ForkServer, ready: Callable[[], None]) -> Recording:
        from grader.runner.run import run
        from rmw_lockstep.hub import Limits as HubLimits

        def start(program: Program, hub: Path) -> Student:
            return fork_server.start(replace(program, hub=hub), self.isolation, self.limits, self.core)

        ready()
        return run(
            self._task,
            partial(start, self.program),
            HubLimits(data_bytes=self.data_bytes),
            {program.main: partial(start, program) for program in self.programs},
            [partial(start, program) for program in self.companions],
        )

    def _over_fast_dds(self, fork_server: ForkServer, ready: Callable[[], None]) -> Recording:
        from grader.runner.fastdds.run import run

        fork_server.prepare(self.middleware)  # before, so that it stays outside the namespaces entered now
        enter(self.isolation)
        ready()
        domain = domain_for(self.isolation)
        program = replace(self.program, environment={**self.program.environment, "ROS_DOMAIN_ID": str(domain)})
        return run(
            replace(self._task, domain=domain),
            lambda: fork_server.start(program, self.isolation, self.limits, self.core),
        )


@dataclass(frozen=True)
class JudgeJob:
    """Run the exercise's checks on recordings."""

    exercise: Exercise
    recordings: dict[str, Recording]
    references: dict[str, Recording]
    titles: dict[str, str]

    def run(self, fork_server: ForkServer, ready: Callable[[], None]) -> Any:
        """Return the verdicts."""
        from grader.checking.judging import judge

        ready()
        return judge(self.exercise, self.recordings, self.references, self.titles)

    def runs(self) -> dict[str, Run]:
        """Return what is judged, for a process that has collected the checks."""
        from grader.checking.judging import runs_of

        return runs_of(self.exercise, self.recordings, self.references, self.titles)


@dataclass(frozen=True)
class ListJob:
    """List the exercise's checks."""

    exercise: Exercise

    def run(self, fork_server: ForkServer, ready: Callable[[], None]) -> Any:
        """Return the checks, as `Listed`."""
        from grader.checking.judging import listed

        ready()
        return listed(self.exercise)
