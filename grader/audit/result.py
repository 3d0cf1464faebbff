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
#: survivors.toml gives the author's reason. `survived`: no check failed, and there is no reason in the file.
Fate = Literal["caught", "equivalent", "listed", "survived"]


@dataclass(frozen=True)
class RecordingDifference:
    """One difference from the solution in one scenario, in words."""

    scenario: str
    description: str


#: When a trial ends.
Until = Literal["a failure", "the end"]


@dataclass(frozen=True)
class Trial:
    """The result of one program.

    `statuses` has the status of each check that could be judged, `findings` those of the checks that failed or crashed.
    `run_in` are the scenarios that were needed. `differences` are the differences from the solution there, and
    `messages` is the number of messages that arrived. `earned` has the points by check, `seconds` the duration of each
    run.
    """

    message: str
    statuses: dict[str, Status]
    findings: dict[str, Finding]
    run_in: tuple[str, ...]
    messages: int
    differences: tuple[RecordingDifference, ...]
    earned: dict[str, float] = field(default_factory=dict)
    seconds: dict[str, float] = field(default_factory=dict, compare=False)

    @property
    def failed(self) -> tuple[str, ...]:
        """Return the checks that failed, in their order."""
        return tuple(name for name, status in self.statuses.items() if status == "failed")

    @property
    def score(self) -> float:
        """Return the points of all checks that were judged."""
        return round(sum(self.earned.values()), 1)

    @property
    def caught(self) -> bool:
        """Return whether any check failed."""
        return bool(self.failed)


@dataclass(frozen=True)
class AuditProblem(Problem):
    """Something for the exercise's author to fix.

    `about` names the check, the mistake or the mutant. For a mutant, `diff` is the change, and `evidence` says what
    differs.
    """

    about: str = ""
    diff: str = ""
    evidence: str = ""


@dataclass(frozen=True)
class JudgedProgram:
    """One of the author's programs, and its result. `failed` are the checks that it did not pass, `score` is its
    points.
    """

    name: str
    kind: Literal["solution", "right", "mistake", "nothing", "baseline"]
    title: str
    failed: tuple[str, ...]
    score: float


@dataclass(frozen=True)
class BrokenRule:
    """One mistake, which breaks these `rules`: the checks that catch it, and the points that it costs.

    `costs_more` is the author's reason why these may be more than its rules are worth; empty if they may not.
    """

    name: str
    title: str
    rules: tuple[str, ...]
    caught_by: tuple[str, ...]
    lost: float
    score: float
    costs_more: str = ""


@dataclass(frozen=True)
class RuleResult:
    """One rule of the task: its line in task.md, the checks that are based on it and their points, and the mistakes
    that break it.
    """

    id: str
    text: str
    line: int
    points: float
    checks: tuple[str, ...]
    mistakes: tuple[BrokenRule, ...] = ()


@dataclass(frozen=True)
class MutantResult:
    """The result of one mutant. `evidence` says how it was caught, or why it counts as equal to the solution."""

    mutant: Mutant
    fate: Fate
    failed: tuple[str, ...]
    evidence: str
    reason: str = ""


@dataclass(frozen=True)
class CheckResult:
    """What one check is worth.

    `kills` are the mutants that it catches, and `score` is their share of all that differ from the solution, between 0
    and 1. `alone` are those that no other check catches, as far as they were run. `mistakes` are the author's mistakes
    that it catches. All times are in seconds: `judging_s` to judge the solution, `running_s` to run its scenarios,
    `alone_s` to run those that no other check uses.
    """

    name: str
    title: str
    points: float
    hidden: bool
    rules: tuple[str, ...]
    kills: int
    score: float
    alone: int
    mistakes: tuple[str, ...]
    scenarios: tuple[str, ...]
    judging_s: float
    running_s: float
    alone_s: float


@dataclass(frozen=True)
class ScenarioResult:
    """What one scenario costs: `running_s` is the median duration of a run, `simulated_s` its simulated time."""

    name: str
    title: str
    messages: int
    simulated_s: float
    running_s: float
    checks: int


@dataclass(frozen=True)
class Audit:
    """The audit of one exercise.

    `sampled` says that not all mutants were tried. `seeds` is the number of seeds that the randomised scenarios were
    run with. `made` and `kept` count the programs tried now and those reused from earlier audits. `rules` are those of
    the task; a quick audit has none, because it does not know what a mistake costs.
    """

    exercise: str
    title: str
    quick: bool
    sampled: bool
    seeds: int
    randomised: tuple[str, ...]
    problems: tuple[AuditProblem, ...]
    programs: tuple[JudgedProgram, ...]
    mutants: tuple[MutantResult, ...]
    checks: tuple[CheckResult, ...]
    scenarios: tuple[ScenarioResult, ...]
    seconds: float
    made: int
    kept: int
    rules: tuple[RuleResult, ...] = ()

    def count(self, fate: Fate) -> int:
        """Return the number of mutants with this result."""
        return sum(result.fate == fate for result in self.mutants)

    @property
    def different(self) -> int:
        """Return the number of mutants that differ from the solution."""
        return different(self.mutants)

    @property
    def score(self) -> float:
        """Return the share of those that is caught, between 0 and 1."""
        return score_of(self.mutants)


def different(mutants: tuple[MutantResult, ...]) -> int:
    """Return the number of mutants that differ from the solution."""
    return sum(result.fate != "equivalent" for result in mutants)


def score_of(mutants: tuple[MutantResult, ...]) -> float:
    """Return the share of those that is caught, between 0 and 1; 1 if there are none."""
    many = different(mutants)
    return sum(result.fate == "caught" for result in mutants) / many if many else 1.0


class AuditProgress(Protocol):
    """Shows the progress of an audit."""

    def begin(self, exercise: str, total: int) -> None:
        """Start to count to `total`."""

    def done(self) -> None:
        """Count one more."""
