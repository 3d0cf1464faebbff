"""The runner's task, the student's program as the runner sees it, and the exception that ends a run."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass, field
from typing import Protocol

from grader.exercise.exercise import Exercise
from grader.recording.recording import RunOutcome
from grader.scenario.scenario import Scenario
from groundwork.process_exit import ProcessExit


class RunningProgram(Protocol):
    """A student's running program."""

    @property
    def pid(self) -> int: ...
    def pids(self) -> Collection[int]: ...
    def output(self) -> str: ...
    def poll(self) -> ProcessExit | None: ...
    def wait(self, timeout_s: float) -> ProcessExit | None: ...
    def interrupt(self) -> None: ...
    def cpu_seconds(self) -> float: ...
    def at_limit(self) -> bool: ...
    def kill(self) -> ProcessExit: ...


@dataclass(frozen=True)
class Task:
    """One program, to be run through one scenario.

    `file_name` and `source` are the student's; `files` has all files of several. Messages quote lines of them. `pace`
    is 1.0 for real time, and None for as fast as possible.
    """

    exercise: Exercise
    scenario: Scenario
    file_name: str
    source: str
    pace: float | None = None
    files: Mapping[str, str] = field(default_factory=dict)

    @property
    def sources(self) -> Mapping[str, str]:
        """The student's files: path -> text."""
        return self.files or {self.file_name: self.source}


class AuthorFault(Exception):
    """Raised from the error if the author's code, which runs inside the grader, fails; the text names it."""


class CannotContinue(Exception):
    """Raised inside a runner if the student's program can't continue; `message` is for the student."""

    def __init__(self, outcome: RunOutcome, message: str) -> None:
        super().__init__(message)
        self.outcome = outcome
        self.message = message
