"""Right solutions are right whatever the numbers of the randomised scenarios are."""

from __future__ import annotations

from dataclasses import dataclass, replace

from grader.audit.candidates import Candidate
from grader.audit.store import Store
from grader.audit.trial import Trial, Trials
from grader.recording import Recording
from grader.scenario import Scenario
from grader.scenario.declared import declared
from grader.submission import Submission


@dataclass(frozen=True)
class Seed:
    """One seed, with the scenarios that are not as with the audit's own."""

    number: int
    scenarios: tuple[Scenario, ...]
    randomised: tuple[Scenario, ...]


def seeds_of(trials: Trials, count: int) -> list[Seed]:
    """The seeds beside the audit's own that make `count` with it; none where no scenario has chance in it."""
    spinner = trials.grading.spinner
    usual = {scenario.digest for scenario in spinner.scenarios}
    found = []
    for number in range(1, count + 1):
        if number != spinner.options.seed:
            scenarios = declared(spinner.exercise, number)
            changed = tuple(scenario for scenario in scenarios if scenario.digest not in usual)
            if changed:
                found.append(Seed(number, scenarios, changed))
    return found


def over_seed(trials: Trials, store: Store, seed: Seed, candidates: list[Candidate]) -> dict[str, Trial]:
    """The trial of each candidate (the solution is the first) with this seed, by name."""
    made: dict[str, Recording] = {}

    def references() -> dict[str, Recording]:
        if not made:
            solution = candidates[0].submission
            made.update(trials.grading.references)
            made.update(_spun(trials, solution, seed.randomised))
        return made

    def trial_of(candidate: Candidate) -> Trial:
        grading = trials.grading
        spinner = replace(grading.spinner, scenarios=seed.scenarios)
        with_seed = replace(trials, grading=replace(grading, spinner=spinner, references=references()))
        if candidate is candidates[0]:
            return with_seed.trial_of_recordings(references())
        spun = _spun(trials, candidate.submission, seed.randomised)
        return with_seed.trial_of_recordings({**references(), **spun})

    digests = [scenario.digest for scenario in seed.randomised]
    return {
        candidate.name: store.trial(
            {"code": candidate.submission.digest, "seed": seed.number, "randomised": digests},
            lambda candidate=candidate: trial_of(candidate),  # type: ignore[misc]
        )
        for candidate in candidates
    }


def _spun(trials: Trials, submission: Submission, scenarios: tuple[Scenario, ...]) -> dict[str, Recording]:
    """The recordings, by scenario.

    What has the very same messages and steps as another is not spun a second time: here only the numbers are in question.
    """
    spun: list[Scenario] = []
    made: dict[str, Recording] = {}
    for scenario in scenarios:
        like = next((one for one in spun if _content(one) == _content(scenario)), None)
        if like:
            made[scenario.name] = replace(made[like.name], scenario=scenario.name)
        else:
            made[scenario.name] = trials.spin(submission, scenario)
            spun.append(scenario)
    return made


def _content(scenario: Scenario) -> Scenario:
    """All that matters to which numbers there are."""
    return replace(scenario, name="", title="", computer_time="apart")
