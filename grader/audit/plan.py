"""What an audit tries."""

from __future__ import annotations

from dataclasses import dataclass

from grader.audit.candidates import Candidate, mistakes, nothings, right_ones
from grader.audit.mutants import Mutant, mutants_of
from grader.audit.seeds import Seed, seeds_of
from grader.audit.trial import Trials
from grader.grading.reference import solution_file

#: Over how many seeds right solutions have to be right.
SEEDS = 20

#: How many mutants a quick audit tries.
SAMPLE = 12


@dataclass(frozen=True)
class Plan:
    """Everything that is to be tried. `quick` is whether a trial ends as soon as it is clear.

    `sampled` is whether there are more mutants than these.
    """

    right: list[Candidate]
    seeds: list[Seed]
    nothings: list[Candidate]
    mistakes: list[Candidate]
    mutants: tuple[Mutant, ...]
    quick: bool
    sampled: bool


def planned(trials: Trials, quick: bool, most: int | None, seeds: int = SEEDS) -> Plan:
    """All there is; in a quick audit without the other right solutions and the seeds. At most `most` mutants."""
    exercise = trials.grading.spinner.exercise
    right = right_ones(exercise)
    every = mutants_of(solution_file(exercise).read_text(encoding="utf-8"), exercise)
    limit = SAMPLE if quick and most is None else most
    chosen = every if limit is None else sample(every, limit)
    return Plan(
        right=right[:1] if quick else right,
        seeds=[] if quick else seeds_of(trials, seeds),
        nothings=nothings(exercise),
        mistakes=mistakes(exercise),
        mutants=chosen,
        quick=quick,
        sampled=len(chosen) < len(every),
    )


def sample(mutants: tuple[Mutant, ...], size: int) -> tuple[Mutant, ...]:
    """So many mutants, of as many operators as there are; always the same."""
    turns: dict[str, int] = {}
    ranked: list[tuple[int, str, Mutant]] = []
    for mutant in sorted(mutants, key=lambda mutant: mutant.id):
        turns[mutant.operator] = turns.get(mutant.operator, 0) + 1
        ranked.append((turns[mutant.operator], mutant.id, mutant))
    chosen = [mutant for _, _, mutant in sorted(ranked, key=lambda entry: entry[:2])[:size]]
    return tuple(sorted(chosen, key=lambda mutant: mutant.line))
