"""What an audit found, as plain data."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal, Protocol

from grader.audit.mutants.maker import Mutant
from grader.checking.verdict import Finding, Status
from groundwork.problem import Problem

#: The share of the mutants that must be caught, of those that differ from the solution.
LEAST_SCORE = 0.95

#: `caught`: a check failed. `equivalent`: it does not differ from the solution. `listed`: no check failed, and
#: the author has judged it in survivors.toml. `survived`: no check failed, and nobody has said why.
Fate = Literal["caught", "equivalent", "listed", "survived"]


@dataclass(frozen=True)
class RecordingDifference:
    """One thing that differs in one scenario, in words."""

    scenario: str
    what: str


#: Where a trial may stop early.
Until = Literal["a failure", "the end"]


@dataclass(frozen=True)
class Trial:
    """The result of one program. `statuses` has the status of each check that could be judged, `findings` the findings
    of those that failed or crashed. `spun` are the scenarios that were needed; `differences` are the differences from
    the solution there, and `messages` is the number of messages that arrived. `seconds` is the duration of each run.
    """

    message: str
    statuses: dict[str, Status]
    findings: dict[str, Finding]
    spun: tuple[str, ...]
    messages: int
    differences: tuple[RecordingDifference, ...]
    seconds: dict[str, float] = field(default_factory=dict, compare=False)

    @property
    def failed(self) -> tuple[str, ...]:
        """The checks that failed, in their order."""
        return tuple(name for name, status in self.statuses.items() if status == "failed")

    @property
    def caught(self) -> bool:
        """Whether any check failed."""
        return bool(self.failed)


@dataclass(frozen=True)
class AuditProblem(Problem):
    """Something for the exercise's author to fix. `about` names the check, the mistake or the mutant. For a mutant,
    `diff` is the change, and `evidence` says what differs.
    """

    about: str = ""
    diff: str = ""
    evidence: str = ""


@dataclass(frozen=True)
class Judged:
    """A program of the author's, and its result. `failed` are the checks that it did not pass, `score` its points."""

    name: str
    kind: Literal["solution", "right", "mistake", "nothing"]
    title: str
    failed: tuple[str, ...]
    score: float


@dataclass(frozen=True)
class MutantResult:
    """The result of one mutant. `evidence` says how it was caught, or in what it does not differ."""

    mutant: Mutant
    fate: Fate
    failed: tuple[str, ...]
    evidence: str
    reason: str = ""


@dataclass(frozen=True)
class CheckResult:
    """What one check is worth. `kills` are the mutants that it catches, `score` is their share of all that differ from
    the solution, between 0 and 1; `alone` are those that no other check catches, as far as they were run. `mistakes`
    are those of the author's that it catches. `judging_s` is how long it takes to judge the solution, `spinning_s` is
    how long its scenarios run, `alone_s` the same for those that no other check uses; all in seconds.
    """

    name: str
    title: str
    points: float
    hidden: bool
    rule: str
    kills: int
    score: float
    alone: int
    mistakes: tuple[str, ...]
    scenarios: tuple[str, ...]
    judging_s: float
    spinning_s: float
    alone_s: float


@dataclass(frozen=True)
class ScenarioResult:
    """What one scenario costs: `spinning_s` is the median duration of its runs, `simulated_s` how long it lasts for a
    node."""

    name: str
    title: str
    messages: int
    simulated_s: float
    spinning_s: float
    checks: int


@dataclass(frozen=True)
class Audit:
    """The audit of one exercise.

    `sampled` is whether not all mutants were tried, `seeds` is the number of seeds with which the randomised scenarios
    were run, `made` and `kept` are the numbers of programs that were tried now and reused from earlier runs.
    """

    exercise: str
    title: str
    quick: bool
    sampled: bool
    seeds: int
    randomised: tuple[str, ...]
    problems: tuple[AuditProblem, ...]
    programs: tuple[Judged, ...]
    mutants: tuple[MutantResult, ...]
    checks: tuple[CheckResult, ...]
    scenarios: tuple[ScenarioResult, ...]
    seconds: float
    made: int
    kept: int

    def count(self, fate: Fate) -> int:
        """The number of mutants with this result."""
        return sum(result.fate == fate for result in self.mutants)

    @property
    def different(self) -> int:
        """The number of mutants that differ from the solution."""
        return different(self.mutants)

    @property
    def score(self) -> float:
        """The part of those that is caught, between 0 and 1."""
        return score_of(self.mutants)


def different(mutants: tuple[MutantResult, ...]) -> int:
    """The number of mutants that differ from the solution."""
    return sum(result.fate != "equivalent" for result in mutants)


def score_of(mutants: tuple[MutantResult, ...]) -> float:
    """The part of those that is caught, between 0 and 1; 1 where there are none."""
    many = different(mutants)
    return sum(result.fate == "caught" for result in mutants) / many if many else 1.0


class AuditProgress(Protocol):
    """Shows the progress of an audit."""

    def begin(self, exercise: str, total: int) -> None:
        """There are `total` things to try."""

    def done(self) -> None:
        """One of them is tried."""
