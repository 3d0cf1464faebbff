"""Audits one exercise: plans what to try, tries several programs at once, and collects the results."""

from __future__ import annotations

import time
from collections.abc import Callable
from concurrent.futures import Future, ThreadPoolExecutor, as_completed
from dataclasses import dataclass, field

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
from grader.audit.check_list import AuditedCheck, ChecksJob, problems_in_text
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


def planned(trials: Trials, quick: bool, most: int | None, seeds: int = SEEDS) -> AuditPlan:
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

    programs: dict[str, Trial] = field(default_factory=dict)
    mutants: dict[str, Trial] = field(default_factory=dict)
    seeds: dict[int, dict[str, Trial]] = field(default_factory=dict)

    @property
    def all(self) -> list[Trial]:
        """Every trial with the default seed."""
        return [*self.programs.values(), *self.mutants.values()]


def try_all(plan: AuditPlan, trials: Trials, store: Store, progress: AuditProgress) -> AuditTrials:
    """Try everything in the plan. Raises `HostFault` if the machine or the grader is at fault."""
    tried = AuditTrials()
    work = _Work(plan, trials, store)
    progress.begin(trials.grading.runner.exercise.name, len(plan.seeds) + len(plan.mutants) + len(_programs(plan)))
    with ThreadPoolExecutor(trials.grading.runner.options.parallel) as pool:
        # The longest ones start first, so that the workers finish at about the same time.
        seeds = {pool.submit(over_seed, trials, store, seed, plan.right): seed for seed in plan.seeds}
        programs = {pool.submit(work.program, program): program for program in _programs(plan)}
        mutants = {pool.submit(work.mutant, mutant): mutant for mutant in plan.mutants}
        every: list[Future[object]] = [*seeds, *programs, *mutants]  # type: ignore[list-item]
        try:
            for future in as_completed(every):
                future.result()
                progress.done()
        except BaseException:
            # After Ctrl-C or a fault, do not wait for the trials in progress.
            trials.runs.stopped.set()
            raise
        finally:
            for future in every:
                future.cancel()
        tried.seeds.update({seed.number: future.result() for future, seed in seeds.items()})
        tried.programs.update({program.name: future.result() for future, program in programs.items()})
        tried.mutants.update({mutant.id: future.result() for future, mutant in mutants.items()})
    return tried


def run_on(plan: AuditPlan, tried: AuditTrials, trials: Trials, store: Store) -> None:
    """Run those mutants through every scenario that settle a doubt about the checks."""
    evidence = {**{mistake.name: tried.programs[mistake.name] for mistake in plan.mistakes}, **tried.mutants}
    doubtful = set(worth_running_on(trials.checks, evidence, tried.mutants))
    work = _Work(plan, trials, store)
    with ThreadPoolExecutor(trials.grading.runner.options.parallel) as pool:
        futures = {m.id: pool.submit(work.mutant, m, "the end") for m in plan.mutants if m.id in doubtful}
        try:
            tried.mutants.update({id_: future.result() for id_, future in futures.items()})
        except BaseException:
            trials.runs.stopped.set()
            raise
        finally:
            for future in futures.values():
                future.cancel()


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
    checks: tuple[AuditedCheck, ...] = workers.do(ChecksJob(exercise, grading.references))
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
