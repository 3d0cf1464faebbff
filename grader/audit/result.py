"""What an audit found, as plain data."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal, Protocol

from grader.audit.mutants.making import Mutant
from grader.checking.verdict import Finding, Status
from grader.problem import Problem

#: The part of the mutants that must be caught, of those that can be told from the solution.
LEAST_SCORE = 0.95

#: `caught`: a check failed. `equivalent`: nothing of it can be told from the solution. `listed`: no check failed, and
#: the author has judged it in survivors.toml. `survived`: no check failed, and nobody has said why.
Fate = Literal["caught", "equivalent", "listed", "survived"]


@dataclass(frozen=True)
class Difference:
    """One thing that differs in one scenario, in words."""

    scenario: str
    what: str


#: Where a trial may end before its end.
Until = Literal["a failure", "the end"]


@dataclass(frozen=True)
class Trial:
    """What became of one program.

    `statuses` is how each check that could be judged ended, `findings` what those that failed or broke tell.
    `spun` are the scenarios that were needed; in `differences` stands what differs from the solution there, and
    `messages` is how many messages came. `seconds` is how long each spin took.
    """

    story: str
    statuses: dict[str, Status]
    findings: dict[str, Finding]
    spun: tuple[str, ...]
    messages: int
    differences: tuple[Difference, ...]
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
    """Something for the exercise's author to fix.

    `about` names the check, the mistake or the mutant that it is about. `diff` is there for a mutant, and `evidence`
    for what it is that differs.
    """

    about: str = ""
    diff: str = ""
    evidence: str = ""


@dataclass(frozen=True)
class Judged:
    """A program of the author's, and how it did. `failed` are the checks it did not pass, `score` its points."""

    name: str
    kind: Literal["solution", "right", "mistake", "nothing"]
    title: str
    failed: tuple[str, ...]
    score: float


@dataclass(frozen=True)
class MutantResult:
    """What became of one mutant. `evidence` tells how it was caught, or in what it does not differ."""

    mutant: Mutant
    fate: Fate
    failed: tuple[str, ...]
    evidence: str
    reason: str = ""


@dataclass(frozen=True)
class CheckResult:
    """What one check is worth.

    `kills` are the mutants that it catches, `score` their part of all that can be told from the solution, between 0
    and 1; `alone` are those that no other check catches, as far as they were spun. `mistakes` are those of the author's
    that it catches. `judging_s` is how long it takes to judge the solution, `spinning_s` how long its scenarios are
    spun, `alone_s` those of them that no other check asks for; all in seconds.
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
    """What one scenario costs: `spinning_s` is the median of its spins, `simulated_s` how long it lasts for a node."""

    name: str
    title: str
    messages: int
    simulated_s: float
    spinning_s: float
    checks: int


@dataclass(frozen=True)
class Audit:
    """The audit of one exercise.

    `sampled` is whether not all mutants were tried, `seeds` is over how many seeds the randomised scenarios were spun,
    `made` and `kept` are how many programs were tried now and were known from before.
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
        """How many mutants met with this fate."""
        return sum(result.fate == fate for result in self.mutants)

    @property
    def different(self) -> int:
        """How many mutants can be told from the solution."""
        return different(self.mutants)

    @property
    def score(self) -> float:
        """The part of those that is caught, between 0 and 1."""
        return score_of(self.mutants)


def different(mutants: tuple[MutantResult, ...]) -> int:
    """How many of the mutants can be told from the solution."""
    return sum(result.fate != "equivalent" for result in mutants)


def score_of(mutants: tuple[MutantResult, ...]) -> float:
    """The part of those that is caught, between 0 and 1; 1 where there are none."""
    many = different(mutants)
    return sum(result.fate == "caught" for result in mutants) / many if many else 1.0


@dataclass(frozen=True)
class Opinion:
    """What one middleware led to: a check's status or a grade's outcome, and the words for the student."""

    verdict: str
    text: str = ""

    def __str__(self) -> str:
        """Both."""
        return f"{self.verdict}: {self.text}" if self.text else self.verdict


@dataclass(frozen=True)
class Differing:
    """A verdict on which the two disagree. `reason` is why, where the recordings show it; else it is empty."""

    program: str
    check: str
    lockstep: Opinion
    fast_dds: Opinion
    reason: str


@dataclass(frozen=True)
class Shadow:
    """All of one exercise. `equal` and `differing` are its verdicts, outcomes included."""

    exercise: str
    title: str
    programs: int
    equal: int
    differing: tuple[Differing, ...]
    seconds: float


class Progress(Protocol):
    """Hears how far an audit is."""

    def begin(self, exercise: str, total: int) -> None:
        """There are `total` things to try."""

    def done(self) -> None:
        """One of them is tried."""
