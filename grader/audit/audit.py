"""Audits one exercise: plans what to try, tries several programs at once, and collects the results."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from concurrent.futures import ThreadPoolExecutor, as_completed
from dataclasses import dataclass
from functools import partial
from typing import Any, TypeVar

from grader.audit.candidates import (
    Candidate,
    Seed,
    baselines,
    judged,
    mistakes,
    nothings,
    over_seed,
    problems_of,
    right_solutions,
    seeds_of,
)
from grader.audit.check_list import ChecksJob, problems_in_text
from grader.audit.mutants.maker import Mutant, mutants_of
from grader.audit.result import (
    LEAST_SCORE,
    Audit,
    AuditProblem,
    AuditProgress,
    MutantResult,
    RuleResult,
    Trial,
    Until,
    score_of,
)
from grader.audit.rules import problems_of_rules, rule_results
from grader.audit.store import RecordedRuns, Store, tidy
from grader.audit.survivors import listed, problems_of_survivors, result_of, stale
from grader.audit.trial import Trials
from grader.audit.worth import (
    check_results,
    messages,
    problems_of_broken,
    problems_of_checks,
    scenario_results,
    worth_running_on,
)
from grader.checking.verdict import ListedCheck
from grader.exercise.exercise import Exercise
from grader.exercise.mistakes import mistakes_of
from grader.exercise.rules import rules_of
from grader.grading.grade import Options
from grader.grading.grading import grading_of
from grader.grading.reference import solution_file
from grader.submission.reader import of_source
from grader.workers.pool import WorkerPool

#: Right solutions must get full marks with this many seeds.
SEEDS = 20

#: The number of mutants that a quick audit tries.
SAMPLE = 12


@dataclass(frozen=True)
class AuditPlan:
    """Everything that an audit tries.

    With `quick`, a trial ends as soon as its result is clear. `sampled` says that there are more mutants than these.
    """

    right: list[Candidate]
    seeds: list[Seed]
    nothings: list[Candidate]
    baselines: list[Candidate]
    mistakes: list[Candidate]
    mutants: tuple[Mutant, ...]
    quick: bool
    sampled: bool


def planned(trials: Trials, quick: bool, most: int | None, seeds: int) -> AuditPlan:
    """Choose what to try.

    A quick audit leaves out the other right solutions, the seeds and the baselines. Baselines need a task that marks
    its rules.

    Choose at most `most` mutants.
    """
    exercise = trials.grading.runner.exercise
    reference = trials.grading.references[trials.grading.runner.scenarios[0].name]
    right = right_solutions(exercise)
    every = mutants_of(solution_file(exercise).read_text(encoding="utf-8"), exercise)
    limit = SAMPLE if quick and most is None else most
    chosen = every if limit is None else sample(every, limit)
    return AuditPlan(
        right=right[:1] if quick else right,
        seeds=[] if quick else seeds_of(trials, seeds),
        nothings=nothings(exercise),
        baselines=baselines(exercise, reference) if rules_of(exercise.task) and not quick else [],
        mistakes=mistakes(exercise),
        mutants=chosen,
        quick=quick,
        sampled=len(chosen) < len(every),
    )


def sample(mutants: tuple[Mutant, ...], size: int) -> tuple[Mutant, ...]:
    """Return `size` mutants, of as many operators as possible. The choice is always the same."""
    turns: dict[str, int] = {}
    ranked: list[tuple[int, str, Mutant]] = []
    for mutant in sorted(mutants, key=lambda mutant: mutant.id):
        turns[mutant.operator] = turns.get(mutant.operator, 0) + 1
        ranked.append((turns[mutant.operator], mutant.id, mutant))
    chosen = [mutant for _, _, mutant in sorted(ranked, key=lambda entry: entry[:2])[:size]]
    return tuple(sorted(chosen, key=lambda mutant: mutant.line))


@dataclass(frozen=True)
class AuditTrials:
    """The trials: of the author's programs by name, of mutants by id, and of right solutions for each further seed."""

    programs: dict[str, Trial]
    mutants: dict[str, Trial]
    seeds: dict[int, dict[str, Trial]]

    @property
    def all(self) -> list[Trial]:
        """Every trial with the default seed."""
        return [*self.programs.values(), *self.mutants.values()]


def try_all(plan: AuditPlan, trials: Trials, store: Store, progress: AuditProgress) -> AuditTrials:
    """Try everything in the plan. Raises `HostFault` if the machine or the grader is at fault."""
    work = _Work(plan, trials, store)
    seeds: dict[Any, Job] = {seed.number: partial(over_seed, trials, store, seed, plan.right) for seed in plan.seeds}
    programs: dict[Any, Job] = {program.name: partial(work.program, program) for program in _programs(plan)}
    mutants: dict[Any, Job] = {mutant.id: partial(work.mutant, mutant) for mutant in plan.mutants}
    # The longest ones start first, so that the workers finish at about the same time.
    jobs = {**seeds, **programs, **mutants}
    progress.begin(trials.grading.runner.exercise.name, len(jobs))
    results = _done(jobs, trials, progress.done)
    return AuditTrials(
        programs={name: results[name] for name in programs},
        mutants={id_: results[id_] for id_ in mutants},
        seeds={number: results[number] for number in seeds},
    )


def run_on(plan: AuditPlan, tried: AuditTrials, trials: Trials, store: Store) -> None:
    """Run those mutants through every scenario that settle a doubt about the checks."""
    evidence = {**{mistake.name: tried.programs[mistake.name] for mistake in plan.mistakes}, **tried.mutants}
    doubtful = set(worth_running_on(trials.checks, evidence, tried.mutants))
    work = _Work(plan, trials, store)
    jobs = {mutant.id: partial(work.mutant, mutant, "the end") for mutant in plan.mutants if mutant.id in doubtful}
    tried.mutants.update(_done(jobs, trials))


Key = TypeVar("Key")
Job = Callable[[], Any]


def _done(jobs: Mapping[Key, Job], trials: Trials, progress: Callable[[], None] = lambda: None) -> dict[Key, Any]:
    """Do several jobs at once, all in the end, and return the result of each."""
    with ThreadPoolExecutor(trials.grading.runner.options.parallel) as pool:
        futures = {key: pool.submit(job) for key, job in jobs.items()}
        try:
            for future in as_completed(futures.values()):
                future.result()
                progress()
        except BaseException:
            # After Ctrl-C or a fault, do not wait for the trials in progress.
            trials.runs.stopped.set()
            raise
        finally:
            for future in futures.values():
                future.cancel()
    return {key: future.result() for key, future in futures.items()}


def _programs(plan: AuditPlan) -> list[Candidate]:
    return [*plan.right, *plan.nothings, *plan.baselines, *plan.mistakes]


@dataclass(frozen=True)
class _Work:
    plan: AuditPlan
    trials: Trials
    store: Store

    def program(self, program: Candidate) -> Trial:
        """In a quick audit, judge a mistake only by the checks that it names."""
        only = program.caught_by if self.plan.quick and program.kind == "mistake" else ()
        make: Callable[[], Trial] = lambda: self.trials.try_(program.submission, only)  # noqa: E731
        return self.store.trial({"code": program.submission.digest, "only": only}, make)

    def mutant(self, mutant: Mutant, until: Until = "a failure") -> Trial:
        """Stop at the first failure, unless the audit needs to know more."""
        submission = of_source(mutant.id, mutant.source.encode(), self.trials.grading.runner.exercise)
        make: Callable[[], Trial] = lambda: self.trials.try_(submission, until=until)  # noqa: E731
        return self.store.trial({"code": submission.digest, "until": until}, make)


def audit(
    exercise: Exercise,
    options: Options,
    workers: WorkerPool,
    progress: AuditProgress,
    quick: bool = False,
    most: int | None = None,
    seeds: int = SEEDS,
) -> Audit:
    """Audit one exercise.

    A `quick` audit judges each mistake only by the checks that it names, tries a sample of the mutants, and leaves out
    the other right solutions and the seeds. `most` limits the number of mutants; without mutants (0), the audit does
    not say what each check is worth. A full audit tries the right solutions with this many `seeds`. Raises what
    `grading_of` raises.
    """
    began = time.monotonic()
    workers.prepare_to_judge()
    grading = grading_of(exercise, options, workers)
    checks: tuple[ListedCheck, ...] = workers.do(ChecksJob(exercise, grading.references))
    trials = Trials(grading, checks, RecordedRuns(grading))
    store = Store(grading.runner)
    reasons = listed(exercise)
    plan = planned(trials, quick, most, seeds)
    tried = try_all(plan, trials, store, progress)
    if not plan.quick:
        run_on(plan, tried, trials, store)
    tidy(exercise.name)

    mutants = tuple(
        result_of(mutant, tried.mutants[mutant.id], reasons, exercise.many_answers) for mutant in plan.mutants
    )
    different = {r.mutant.id: tried.mutants[r.mutant.id] for r in mutants if r.fate != "equivalent"}
    trials_of_mistakes = {mistake.name: tried.programs[mistake.name] for mistake in plan.mistakes}
    evidence = {**trials_of_mistakes, **{f"the mutant {id_}": trial for id_, trial in different.items()}}
    programs = _programs(plan)
    problems = problems_of(programs, tried.programs, checks)
    for number, with_seed in tried.seeds.items():
        problems += problems_of(plan.right, with_seed, checks, number)
    problems += problems_of_broken(checks, {**tried.programs, **evidence})
    # Only mutants show what a check is worth.
    worth = problems_of_checks if mutants and not quick else messages
    problems += worth(checks, evidence)
    problems += problems_in_text(exercise, checks)
    problems += problems_of_survivors(exercise, mutants)
    if not plan.sampled:
        problems += stale(exercise, reasons, {r.mutant.id: r.fate for r in mutants})
        problems += _low_score(exercise, mutants)

    results = tuple(judged(program, tried.programs[program.name]) for program in programs)
    rules: tuple[RuleResult, ...] = ()
    if not quick:
        # The author may have written another mistake since the audit began.
        edits = tuple(m for m in mistakes_of(exercise) if f"mistakes/{m.name}" in tried.programs)
        rules = rule_results(exercise, checks, edits, {m.name: tried.programs[f"mistakes/{m.name}"] for m in edits})
        problems += problems_of_rules(exercise, rules, edits, results)

    scenarios = scenario_results(grading.runner.scenarios, checks, tried.all)
    return Audit(
        exercise=exercise.name,
        title=exercise.title,
        quick=quick,
        sampled=plan.sampled,
        seeds=1 + len(plan.seeds) if plan.seeds else 0,
        randomised=tuple(scenario.name for scenario in plan.seeds[0].randomised) if plan.seeds else (),
        problems=tuple(problems),
        programs=results,
        mutants=mutants,
        checks=check_results(checks, scenarios, different, trials_of_mistakes),
        scenarios=scenarios,
        seconds=time.monotonic() - began,
        made=store.made,
        kept=store.kept,
        rules=rules,
    )


def _low_score(exercise: Exercise, mutants: tuple[MutantResult, ...]) -> list[AuditProblem]:
    score = score_of(mutants)
    if score >= LEAST_SCORE:
        return []
    text = f"{score:.1%} of the mutants that differ from the solution are caught"
    fix = f"At least {LEAST_SCORE:.0%} must be caught. Add checks that catch the survivors."
    return [AuditProblem(exercise.folder, None, text, fix, about=exercise.name)]
