"""The jobs that a worker can do."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from functools import partial
from typing import TYPE_CHECKING, Any, Protocol

from grader.exercise.data_files import data_files
from grader.exercise.exercise import Exercise
from grader.exercise.imported_files import importable
from grader.recording.places import is_launcher
from grader.recording.recording import Recording
from grader.runner.program import Task
from grader.sandbox.program import Isolation, Limits, ProgramSpec
from grader.scenario.scenario import Scenario

if TYPE_CHECKING:
    from grader.checking.run import Run
    from grader.sandbox.fork_server import ForkServer, SandboxedProgram


class Job(Protocol):
    """A job for a process of the worker pool. It calls `ready` as soon as other threads may start."""

    def run(self, fork_server: ForkServer, ready: Callable[[], None]) -> Any:
        """Do the job, and return its result."""


@dataclass(frozen=True)
class RunJob:
    """Run a program through one scenario. `core` is the CPU to keep the student's program on."""

    exercise: Exercise
    scenario: Scenario
    program: ProgramSpec
    isolation: Isolation
    limits: Limits
    source: str
    file_name: str
    core: int | None = None
    pace: float | None = None
    data_bytes: int = 8_000_000
    """What the program may publish in all messages together."""
    hub_cpu_s: float = 5.0
    """What reading all that it sends may cost the grader."""
    programs: Mapping[str, ProgramSpec] = field(default_factory=dict)
    """The programs of a scenario with several, by their names, instead of `program`."""
    companions: tuple[ProgramSpec, ...] = ()
    """The author's own programs."""

    @property
    def _task(self) -> Task:
        python = {name: data for name, data in self.program.files.items() if name.endswith(".py")}
        texts = {name: data.decode(errors="replace") for name, data in python.items()}
        files = {name: text for name, text in texts.items() if not is_launcher(text)}
        return Task(self.exercise, self.scenario, self.file_name, self.source, self.pace, files)

    def run(self, fork_server: ForkServer, ready: Callable[[], None]) -> Recording:
        """Return the recording of the run."""
        from grader.runner.run import run
        from rmw_lockstep.hub import HubLimits

        data = data_files(self.exercise)

        def start(program: ProgramSpec, hub: int) -> SandboxedProgram:
            with_data = replace(program, hub=hub, files={**program.files, **data})
            return fork_server.start(with_data, self.isolation, self.limits, self.core)

        ready()
        with importable(self.exercise.folder):  # for what a world imports when it is used
            return run(
                self._task,
                partial(start, self.program),
                HubLimits(data_bytes=self.data_bytes, cpu_s=self.hub_cpu_s),
                {name: partial(start, program) for name, program in self.programs.items()},
                [partial(start, program) for program in self.companions],
            )


@dataclass(frozen=True)
class JudgeJob:
    """Run the exercise's checks on recordings."""

    exercise: Exercise
    recordings: dict[str, Recording]
    references: dict[str, Recording]
    titles: dict[str, str]
    seed: int = 1
    partly: bool = False
    """Whether only the checks judge that need no other scenarios."""

    def run(self, fork_server: ForkServer, ready: Callable[[], None]) -> Any:
        """Return the verdicts."""
        from grader.checking.judge import judge

        ready()
        return judge(self.exercise, self.runs(), self.partly)

    def runs(self) -> dict[str, Run]:
        """Return what is judged, for a process that has collected the checks."""
        from grader.checking.judge import runs_of

        return runs_of(self.exercise, self.recordings, self.references, self.titles, self.seed)


@dataclass(frozen=True)
class ListJob:
    """List the exercise's checks."""

    exercise: Exercise

    def run(self, fork_server: ForkServer, ready: Callable[[], None]) -> Any:
        """Return the checks, as `ListedCheck`."""
        from grader.checking.judge import listed

        ready()
        return listed(self.exercise)
