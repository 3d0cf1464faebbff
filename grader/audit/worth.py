"""What the checks are worth: whether each can fail on its own, what it catches and what it costs."""

from __future__ import annotations

import re
from itertools import combinations
from statistics import median

from grader.audit.check_list import problem_of
from grader.audit.result import AuditProblem, CheckResult, ScenarioResult, Trial
from grader.checking.verdict import Finding, ListedCheck
from grader.scenario.scenario import Scenario

#: A message without an expected value must say in words what was expected.
WORDS = re.compile(r"expect|must|should|has to|have to|was to|were to|instead of|may not", re.IGNORECASE)

#: How many mutants are run through all scenarios for each check that has not failed yet, and for each two that look
#: alike.
EACH = 4


def problems_of_checks(checks: tuple[ListedCheck, ...], trials: dict[str, Trial]) -> list[AuditProblem]:
    """Return the problems of checks; `trials` are those of mistakes and of mutants that differ from the solution, by
    name.
    """
    return [*_that_never_fail(checks, trials), *_that_fail_together(checks, trials), *messages(checks, trials)]


def never_failing(checks: tuple[ListedCheck, ...], trials: dict[str, Trial]) -> list[ListedCheck]:
    """Return the checks that failed in none of these trials."""
    failed = {name for trial in trials.values() for name in trial.failed}
    return [check for check in checks if check.name not in failed]


def alike(checks: tuple[ListedCheck, ...], trials: dict[str, Trial]) -> list[tuple[ListedCheck, ListedCheck, int]]:
    """Return pairs of checks that always failed together, with the number of times."""
    pairs_alike = []
    for check, other in combinations(checks, 2):
        # If only one of them was judged, nothing is known about the other.
        pairs = [(trial.statuses.get(check.name), trial.statuses.get(other.name)) for trial in trials.values()]
        judged = [pair for pair in pairs if set(pair) <= {"passed", "failed"}]
        many = judged.count(("failed", "failed"))
        if many and all(first == second for first, second in judged):
            pairs_alike.append((check, other, many))
    return pairs_alike


def worth_running_on(checks: tuple[ListedCheck, ...], trials: dict[str, Trial], mutants: dict[str, Trial]) -> list[str]:
    """Return the mutants that may show that a check can fail, or that two are not alike: a few for each such doubt.

    They were run until a check caught them, so nothing is known yet about the checks of other scenarios.
    """
    chosen: set[str] = set()
    for check in never_failing(checks, trials):
        chosen.update([id_ for id_, trial in mutants.items() if _undecided(check, trial)][:EACH])
    for check, other, _ in alike(checks, trials):
        tells = [
            id_
            for id_, trial in mutants.items()
            for failed, open_ in ((check, other), (other, check))
            if failed.name in trial.failed and _undecided(open_, trial)
        ]
        chosen.update(tells[:EACH])
    return [id_ for id_ in mutants if id_ in chosen]


def _undecided(check: ListedCheck, trial: Trial) -> bool:
    return check.name not in trial.statuses and not set(check.depends) & set(trial.failed)


def _that_never_fail(checks: tuple[ListedCheck, ...], trials: dict[str, Trial]) -> list[AuditProblem]:
    return [
        problem_of(
            check,
            f"no mutant and no mistake fails {check.name}: can it fail at all?",
            "Write a mistake that it must catch, or remove it.",
        )
        for check in never_failing(checks, trials)
    ]


def _that_fail_together(checks: tuple[ListedCheck, ...], trials: dict[str, Trial]) -> list[AuditProblem]:
    fix = "Write a mistake that fails only one, let one depend on the other, or make them one check."
    return [
        problem_of(
            other,
            f"{check.name} and {other.name} always fail together ({many} times): do both judge the same thing?",
            fix,
        )
        for check, other, many in alike(checks, trials)
    ]


def problems_of_broken(checks: tuple[ListedCheck, ...], trials: dict[str, Trial]) -> list[AuditProblem]:
    """Return the checks that crashed on what some program published; `trials` are those of all programs, by name."""
    problems = []
    for check in checks:
        for name, trial in trials.items():
            if trial.statuses.get(check.name) == "error":
                text = f"{check.name} breaks on what {name} publishes: {trial.findings[check.name].text}"
                fix = "A check must pass or fail, whatever a student's node publishes. Look before you use an element."
                problems.append(problem_of(check, text, fix))
                break
    return problems


def _broke_off(finding: Finding) -> bool:
    """Return whether the program did not complete the scenario.

    The finding's text then says why, not what a check expected.
    """
    return bool(finding.scenario) and finding.message is None


def messages(checks: tuple[ListedCheck, ...], trials: dict[str, Trial]) -> list[AuditProblem]:
    """Return the checks that failed and did not say what they expected."""
    problems = []
    for check in checks:
        for name, trial in trials.items():
            finding = trial.findings.get(check.name) if check.name in trial.failed else None
            if finding and not _broke_off(finding) and not finding.expected and not WORDS.search(finding.text):
                message = f"{check.name} fails for {name} and does not say what was expected: “{finding.text}”"
                problems.append(problem_of(check, message, "Name it in the message."))
                break
    return problems


def scenario_results(
    scenarios: tuple[Scenario, ...], checks: tuple[ListedCheck, ...], trials: list[Trial]
) -> tuple[ScenarioResult, ...]:
    """Return what each scenario costs, over all its runs in these trials."""
    return tuple(
        ScenarioResult(
            name=scenario.name,
            title=scenario.title,
            messages=len(scenario.messages),
            simulated_s=scenario.seconds,
            running_s=median([t.seconds[scenario.name] for t in trials if scenario.name in t.seconds] or [0.0]),
            checks=sum(scenario.name in check.scenarios for check in checks),
        )
        for scenario in scenarios
    )


def check_results(
    checks: tuple[ListedCheck, ...],
    scenarios: tuple[ScenarioResult, ...],
    mutants: dict[str, Trial],
    mistakes: dict[str, Trial],
) -> tuple[CheckResult, ...]:
    """Return what each check is worth; `mutants` are the trials of those that differ from the solution."""
    seconds = {scenario.name: scenario.running_s for scenario in scenarios}
    asked_by_one = {scenario.name for scenario in scenarios[1:] if scenario.checks == 1}
    kills = {check.name: sum(check.name in trial.failed for trial in mutants.values()) for check in checks}
    return tuple(
        CheckResult(
            name=check.name,
            title=check.title,
            points=check.points,
            hidden=check.hidden,
            rules=check.rules,
            kills=kills[check.name],
            score=kills[check.name] / len(mutants) if mutants else 0.0,
            alone=sum(trial.failed == (check.name,) for trial in mutants.values()),
            mistakes=tuple(name for name, trial in mistakes.items() if check.name in trial.failed),
            scenarios=check.scenarios,
            judging_s=check.seconds,
            running_s=sum(seconds[name] for name in check.scenarios),
            alone_s=sum(seconds[name] for name in check.scenarios if name in asked_by_one),
        )
        for check in checks
    )
