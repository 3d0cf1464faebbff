"""What an audit found, as plain data."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from grader.audit.mutants.making import Mutant

#: The part of the mutants that must be caught, of those that can be told from the solution.
LEAST_SCORE = 0.95

#: `caught`: a check failed. `equivalent`: nothing of it can be told from the solution. `listed`: no check failed, and
#: the author has judged it in survivors.toml. `survived`: no check failed, and nobody has said why.
Fate = Literal["caught", "equivalent", "listed", "survived"]


@dataclass(frozen=True)
class Problem:
    """Something for the exercise's author to fix.

    `place` is a file, with a line where there is one. `about` names the check, the mistake or the mutant that it is
    about. `diff` is there for a mutant, and `evidence` for what it is that differs.
    """

    place: str
    about: str
    found: str
    fix: str
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
    and 1; `alone` are those that no other check catches. `mistakes` are those of the author's that it catches.
    `judging_s` is how long it takes to judge the solution, `spinning_s` how long its scenarios are spun, `alone_s`
    those of them that no other check asks for; all in seconds.
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
    problems: tuple[Problem, ...]
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
