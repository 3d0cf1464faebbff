"""Audits one exercise."""

from __future__ import annotations

import time

from grader.audit.costs import check_results, scenario_results
from grader.audit.listing import Check, ChecksJob
from grader.audit.plan import SEEDS, planned
from grader.audit.programs import judged, problems_of
from grader.audit.result import LEAST_SCORE, Audit, MutantResult, Problem, score_of
from grader.audit.spins import Spins, tidy
from grader.audit.store import Store
from grader.audit.surviving import problems_of_survivors, result_of
from grader.audit.survivors import listed, stale
from grader.audit.told import problems_in_text
from grader.audit.trial import Trials
from grader.audit.trying import Progress, try_all
from grader.audit.worth import messages, problems_of_broken, problems_of_checks
from grader.crew import Crew
from grader.exercise import Exercise
from grader.grading import Options, grading_of


def audit(
    exercise: Exercise,
    options: Options,
    crew: Crew,
    progress: Progress,
    quick: bool = False,
    most: int | None = None,
    seeds: int = SEEDS,
) -> Audit:
    """Everything there is to find out about one exercise.

    A `quick` audit asks of each mistake only whether the checks that it names catch it, tries a sample of the mutants,
    and leaves out the other right solutions and the seeds. With `most`, no more mutants than that are tried. Otherwise
    right solutions have to be right over so many `seeds`.
    Raises what `grading_of` raises.
    """
    began = time.monotonic()
    crew.prepare_to_judge()
    grading = grading_of(exercise, options, crew)
    checks: tuple[Check, ...] = crew.do(ChecksJob(exercise, grading.references))
    trials = Trials(grading, checks, Spins(grading))
    store = Store(trials)
    reasons = listed(exercise)
    plan = planned(trials, quick, most, seeds)
    tried = try_all(plan, trials, store, progress)
    tidy(exercise.name)

    mutants = tuple(result_of(mutant, tried.mutants[mutant.id], reasons) for mutant in plan.mutants)
    different = {r.mutant.id: tried.mutants[r.mutant.id] for r in mutants if r.fate != "equivalent"}
    mistakes = {mistake.name: tried.programs[mistake.name] for mistake in plan.mistakes}
    evidence = {**mistakes, **{f"the mutant {id_}": trial for id_, trial in different.items()}}
    programs = [*plan.right, *plan.nothings, *plan.mistakes]
    problems = problems_of(programs, tried.programs, checks)
    for number, with_seed in tried.seeds.items():
        problems += problems_of(plan.right, with_seed, checks, number)
    problems += problems_of_broken(checks, {**tried.programs, **evidence})
    problems += messages(checks, evidence) if quick else problems_of_checks(checks, evidence)
    problems += problems_in_text(exercise, checks)
    problems += problems_of_survivors(exercise, mutants)
    if not plan.sampled:
        problems += stale(exercise, reasons, {r.mutant.id: r.fate for r in mutants})
        problems += _low_score(exercise, mutants)

    scenarios = scenario_results(grading.spinner.scenarios, checks, tried.all)
    return Audit(
        exercise=exercise.name,
        title=exercise.title,
        quick=quick,
        sampled=plan.sampled,
        seeds=1 + len(plan.seeds) if plan.seeds else 0,
        randomised=tuple(scenario.name for scenario in plan.seeds[0].randomised) if plan.seeds else (),
        problems=tuple(problems),
        programs=tuple(judged(program, tried.programs[program.name], checks) for program in programs),
        mutants=mutants,
        checks=check_results(checks, scenarios, different, mistakes),
        scenarios=scenarios,
        seconds=time.monotonic() - began,
        made=store.made,
        kept=store.kept,
    )


def _low_score(exercise: Exercise, mutants: tuple[MutantResult, ...]) -> list[Problem]:
    score = score_of(mutants)
    if score >= LEAST_SCORE:
        return []
    told = f"{score:.1%} of the mutants that can be told from the solution are caught"
    mend = f"At least {LEAST_SCORE:.0%} are to be: add checks for what survives."
    return [Problem(str(exercise.folder), exercise.name, told, mend)]
