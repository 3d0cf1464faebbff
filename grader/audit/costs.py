"""What each check catches and costs, and what each scenario costs."""

from __future__ import annotations

from statistics import median

from grader.audit.listing import Check
from grader.audit.result import CheckResult, ScenarioResult
from grader.audit.trial import Trial
from grader.scenario import Scenario


def scenario_results(
    scenarios: tuple[Scenario, ...], checks: tuple[Check, ...], trials: list[Trial]
) -> tuple[ScenarioResult, ...]:
    """What each scenario costs, over all its spins in these trials."""
    return tuple(
        ScenarioResult(
            name=scenario.name,
            title=scenario.title,
            messages=len(scenario.messages),
            simulated_s=scenario.seconds,
            spinning_s=median([t.seconds[scenario.name] for t in trials if scenario.name in t.seconds] or [0.0]),
            checks=sum(scenario.name in check.scenarios for check in checks),
        )
        for scenario in scenarios
    )


def check_results(
    checks: tuple[Check, ...],
    scenarios: tuple[ScenarioResult, ...],
    mutants: dict[str, Trial],
    mistakes: dict[str, Trial],
) -> tuple[CheckResult, ...]:
    """What each check is worth; `mutants` are the trials of those that can be told from the solution."""
    seconds = {scenario.name: scenario.spinning_s for scenario in scenarios}
    asked_by_one = {scenario.name for scenario in scenarios[1:] if scenario.checks == 1}
    kills = {check.name: sum(check.name in trial.failed for trial in mutants.values()) for check in checks}
    return tuple(
        CheckResult(
            name=check.name,
            title=check.title,
            points=check.points,
            hidden=check.hidden,
            rule=check.rule,
            kills=kills[check.name],
            score=kills[check.name] / len(mutants) if mutants else 0.0,
            alone=sum(trial.failed == (check.name,) for trial in mutants.values()),
            mistakes=tuple(name for name, trial in mistakes.items() if check.name in trial.failed),
            scenarios=check.scenarios,
            judging_s=check.seconds,
            spinning_s=sum(seconds[name] for name in check.scenarios),
            alone_s=sum(seconds[name] for name in check.scenarios if name in asked_by_one),
        )
        for check in checks
    )
