"""Tries everything of a plan, several programs at once."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import Future, ThreadPoolExecutor, as_completed
from dataclasses import dataclass, field
from typing import Protocol

from grader.audit.candidates import Candidate
from grader.audit.mutants import Mutant
from grader.audit.plan import Plan
from grader.audit.seeds import over_seed
from grader.audit.store import Store
from grader.audit.trial import Trial, Trials, Until
from grader.submission.reading import of_source


class Progress(Protocol):
    """Hears how far an audit is."""

    def begin(self, exercise: str, total: int) -> None:
        """There are `total` things to try."""

    def done(self) -> None:
        """One of them is tried."""


@dataclass(frozen=True)
class Tried:
    """The trials: of the author's programs by name, of mutants by id, of right solutions with each further seed."""

    programs: dict[str, Trial] = field(default_factory=dict)
    mutants: dict[str, Trial] = field(default_factory=dict)
    seeds: dict[int, dict[str, Trial]] = field(default_factory=dict)

    @property
    def all(self) -> list[Trial]:
        """Every trial with the usual seed."""
        return [*self.programs.values(), *self.mutants.values()]


def try_all(plan: Plan, trials: Trials, store: Store, progress: Progress) -> Tried:
    """The trial of everything in the plan. Raises `HostFault` where the machine or we are at fault."""
    tried = Tried()
    work = _Work(plan, trials, store)
    progress.begin(trials.grading.spinner.exercise.name, len(plan.seeds) + len(plan.mutants) + len(_programs(plan)))
    with ThreadPoolExecutor(trials.grading.spinner.options.parallel) as pool:
        # What takes longest first, so that nothing is left over at the end.
        seeds = {pool.submit(over_seed, trials, store, seed, plan.right): seed for seed in plan.seeds}
        programs = {pool.submit(work.program, program): program for program in _programs(plan)}
        mutants = {pool.submit(work.mutant, mutant): mutant for mutant in plan.mutants}
        every: list[Future[object]] = [*seeds, *programs, *mutants]  # type: ignore[list-item]
        try:
            for future in as_completed(every):
                future.result()
                progress.done()
        except BaseException:
            # Ctrl-C, or a fault: nobody wants to wait for what is under way.
            trials.spins.stopped.set()
            raise
        finally:
            for future in every:
                future.cancel()
        tried.seeds.update({seed.number: future.result() for future, seed in seeds.items()})
        tried.programs.update({program.name: future.result() for future, program in programs.items()})
        tried.mutants.update({mutant.id: future.result() for future, mutant in mutants.items()})
    return tried


def _programs(plan: Plan) -> list[Candidate]:
    return [*plan.right, *plan.nothings, *plan.mistakes]


@dataclass(frozen=True)
class _Work:
    plan: Plan
    trials: Trials
    store: Store

    def program(self, program: Candidate) -> Trial:
        """In a quick audit, of a mistake only what the checks that it names say."""
        only = program.caught_by if self.plan.quick and program.kind == "mistake" else ()
        make: Callable[[], Trial] = lambda: self.trials.try_(program.submission, only)  # noqa: E731
        return self.store.trial({"code": program.submission.digest, "only": only}, make)

    def mutant(self, mutant: Mutant) -> Trial:
        """Most are caught in the first scenario, and need no other; in a quick audit any failure is enough."""
        submission = of_source(mutant.id, mutant.source.encode(), self.trials.grading.spinner.exercise)
        until: Until = "a failure" if self.plan.quick else "a failure in the first"
        make: Callable[[], Trial] = lambda: self.trials.try_(submission, until=until)  # noqa: E731
        return self.store.trial({"code": submission.digest, "until": until}, make)
