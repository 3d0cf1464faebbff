"""Audits one exercise."""

from __future__ import annotations

import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor, as_completed
from dataclasses import dataclass, field, replace
from typing import Any, Protocol

from grader.audit.candidates import Candidate, mistakes, nothings, right_ones
from grader.audit.costs import check_results, scenario_results
from grader.audit.listing import Check, ChecksJob
from grader.audit.mutants import Mutant, mutants_of
from grader.audit.programs import judged, problems_of
from grader.audit.result import LEAST_SCORE, Audit, MutantResult, Problem
from grader.audit.seeds import Seed, over_seed, seeds_of
from grader.audit.store import Store
from grader.audit.surviving import problems_of_survivors, result_of
from grader.audit.survivors import listed, stale
from grader.audit.told import problems_in_text
from grader.audit.trial import Trial, Trials
from grader.audit.worth import messages, problems_of_checks
from grader.crew import Crew
from grader.exercise import Exercise
from grader.grading import Options, grading_of
from grader.grading.reference import solution_file
from grader.submission.reading import of_source

#: Over how many seeds right solutions have to be right.
SEEDS = 20

#: How many mutants a quick audit tries.
SAMPLE = 12


class Progress(Protocol):
    """Hears how far an audit is."""

    def begin(self, exercise: str, total: int) -> None:
        """There are `total` things to try."""

    def done(self, what: str) -> None:
        """One of them is tried."""


@dataclass
class _Tried:
    """The trials so far, by the program's name."""

    right: dict[str, Trial] = field(default_factory=dict)
    seeds: dict[int, dict[str, Trial]] = field(default_factory=dict)
    nothings: dict[str, Trial] = field(default_factory=dict)
    mistakes: dict[str, Trial] = field(default_factory=dict)
    mutants: dict[str, Trial] = field(default_factory=dict)


@dataclass(frozen=True)
class _Plan:
    """Everything that is to be tried."""

    right: list[Candidate]
    seeds: list[Seed]
    nothings: list[Candidate]
    mistakes: list[Candidate]
    mutants: tuple[Mutant, ...]


def audit(exercise: Exercise, options: Options, crew: Crew, quick: bool, progress: Progress) -> Audit:
    """Everything there is to find out about one exercise.

    A `quick` audit asks of each mistake only whether the checks that it names catch it, tries a sample of the mutants,
    and leaves out the other right solutions and the seeds. Raises what `grading_of` raises.
    """
    began = time.monotonic()
    grading = grading_of(exercise, options, crew)
    checks: tuple[Check, ...] = crew.do(ChecksJob(exercise, grading.references))
    trials = Trials(grading, checks)
    store = Store(trials)
    reasons = listed(exercise)
    plan = _planned(exercise, trials, quick)
    tried = _try_all(plan, trials, store, quick, progress)
    store.tidy()

    results = tuple(result_of(mutant, tried.mutants[mutant.id], reasons) for mutant in plan.mutants)
    different = {r.mutant.id: tried.mutants[r.mutant.id] for r in results if r.fate != "equivalent"}
    evidence = {**tried.mistakes, **{_named(r): different[r.mutant.id] for r in results if r.fate != "equivalent"}}
    problems = [
        *problems_of(
            plan.right + plan.nothings + plan.mistakes, {**tried.right, **tried.nothings, **tried.mistakes}, checks
        ),
        *(p for number, seed in tried.seeds.items() for p in problems_of(plan.right, seed, checks, number)),
        *(messages(checks, evidence) if quick else problems_of_checks(checks, evidence)),
        *problems_in_text(exercise, checks),
        *problems_of_survivors(exercise, results),
        *([] if quick else stale(exercise, reasons, {r.mutant.id: r.fate for r in results})),
    ]
    every = [*tried.right.values(), *tried.nothings.values(), *tried.mistakes.values(), *tried.mutants.values()]
    scenarios = scenario_results(grading.spinner.scenarios, checks, every)
    result = Audit(
        exercise=exercise.name,
        title=exercise.title,
        quick=quick,
        seeds=1 + len(plan.seeds) if plan.seeds else 0,
        randomised=tuple(scenario.name for scenario in plan.seeds[0].randomised) if plan.seeds else (),
        problems=tuple(problems),
        programs=tuple(
            judged(candidate, trial, checks)
            for candidates, kept in (
                (plan.right, tried.right),
                (plan.nothings, tried.nothings),
                (plan.mistakes, tried.mistakes),
            )
            for candidate in candidates
            for trial in [kept[candidate.name]]
        ),
        mutants=results,
        checks=check_results(checks, scenarios, different, tried.mistakes),
        scenarios=scenarios,
        seconds=time.monotonic() - began,
        spun=store.spun,
        kept=store.kept,
    )
    return result if quick else _with_score(result, exercise)


def _with_score(result: Audit, exercise: Exercise) -> Audit:
    if result.score >= LEAST_SCORE:
        return result
    told = f"{result.score:.1%} of the mutants are caught that can be told from the solution"
    mend = f"At least {LEAST_SCORE:.0%} are to be: add checks for what survives."
    low = Problem(str(exercise.folder), exercise.name, told, mend)
    return replace(result, problems=(*result.problems, low))


def _named(result: MutantResult) -> str:
    return f"the mutant {result.mutant.id} ({result.mutant.what})"


def _planned(exercise: Exercise, trials: Trials, quick: bool) -> _Plan:
    mutants = mutants_of(solution_file(exercise).read_text(encoding="utf-8"), exercise)
    right = right_ones(exercise)
    if quick:
        return _Plan(right[:1], [], nothings(exercise), mistakes(exercise), sample(mutants))
    return _Plan(right, seeds_of(trials, SEEDS), nothings(exercise), mistakes(exercise), mutants)


def sample(mutants: tuple[Mutant, ...], size: int = SAMPLE) -> tuple[Mutant, ...]:
    """A few mutants of different operators, always the same."""
    by_operator: dict[str, Mutant] = {}
    for mutant in sorted(mutants, key=lambda mutant: mutant.id):
        by_operator.setdefault(mutant.operator, mutant)
    return tuple(sorted(by_operator.values(), key=lambda mutant: mutant.id)[:size])


def _try_all(plan: _Plan, trials: Trials, store: Store, quick: bool, progress: Progress) -> _Tried:
    """Everything tried, several at once; what takes longest first."""
    tried = _Tried()
    exercise = trials.grading.spinner.exercise

    def whole(candidate: Candidate) -> Trial:
        return store.trial({"code": candidate.submission.digest}, lambda: trials.try_(candidate.submission))

    def named_only(candidate: Candidate) -> Trial:
        only = candidate.caught_by
        key = {"code": candidate.submission.digest, "only": only}
        return store.trial(key, lambda: trials.try_(candidate.submission, only))

    def mutant_of(mutant: Mutant) -> Trial:
        submission = of_source(mutant.id, mutant.source.encode(), exercise)
        key = {"code": submission.digest, "enough": quick}
        return store.trial(key, lambda: trials.try_(submission, enough=quick))

    jobs: list[tuple[dict[Any, Any], Any, str, Callable[[Any], Any], Any]] = []
    for seed in plan.seeds:
        jobs.append(
            (tried.seeds, seed.number, f"seed {seed.number}", lambda s: over_seed(trials, store, s, plan.right), seed)
        )
    for kept, candidates in ((tried.right, plan.right), (tried.nothings, plan.nothings)):
        jobs += [(kept, c.name, c.name, whole, c) for c in candidates]
    jobs += [(tried.mistakes, c.name, c.name, named_only if quick else whole, c) for c in plan.mistakes]
    jobs += [(tried.mutants, m.id, f"mutant {m.id}", mutant_of, m) for m in plan.mutants]

    progress.begin(exercise.name, len(jobs))
    with ThreadPoolExecutor(trials.grading.spinner.options.parallel) as pool:
        futures = {pool.submit(work, given): (kept, key, what) for kept, key, what, work, given in jobs}
        try:
            for future in as_completed(futures):
                kept, key, what = futures[future]
                kept[key] = future.result()
                progress.done(what)
        finally:
            for future in futures:
                future.cancel()
    return tried
