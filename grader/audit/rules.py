"""The rules of a task one by one: which mistakes break them, what catches these, and what they cost."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

from grader.audit.result import AuditProblem, BrokenRule, JudgedProgram, RuleResult, Trial
from grader.checking.verdict import ListedCheck
from grader.exercise.exercise import Exercise
from grader.exercise.mistakes import Mistake
from grader.exercise.rules import Rule, ids_used_twice, named_by, rules_of, without_markup

#: How many mistakes break each rule, at least.
FEWEST = 2

#: A mistake may cost at most this many times the points of the rules that it breaks.
DEAREST = 2.0

#: The largest share of the points that a program without work in it may get.
LARGEST = 0.15


def rule_results(
    exercise: Exercise, checks: tuple[ListedCheck, ...], mistakes: tuple[Mistake, ...], trials: dict[str, Trial]
) -> tuple[RuleResult, ...]:
    """Return every rule of the task with the mistakes that break it; `trials` are those of mistakes, by name."""
    rules = rules_of(exercise.task) or _quoted(exercise.task, checks, mistakes)
    broken = {mistake.name: _ids(mistake.breaks, rules) for mistake in mistakes}
    results = []
    for rule in rules:
        mine = tuple(check for check in checks if rule.id in _ids(check.rules, rules))
        result = RuleResult(rule.id, rule.text, rule.line, sum(c.points for c in mine), tuple(c.name for c in mine))
        breaking = [mistake for mistake in mistakes if rule.id in broken[mistake.name]]
        details = tuple(_broken(m, trials[m.name], broken[m.name], checks) for m in breaking)
        results.append(replace(result, mistakes=details))
    return tuple(results)


def _quoted(task: str, checks: tuple[ListedCheck, ...], mistakes: tuple[Mistake, ...]) -> tuple[Rule, ...]:
    """Return the sentences that checks and mistakes quote from a task that marks no rules; each is its own id."""
    lines = task.splitlines()
    parts = [without_markup("\n".join(lines[:number])) for number in range(1, len(lines) + 1)]
    quotes = (*(check.rules for check in checks), *(mistake.breaks for mistake in mistakes))
    texts = {without_markup(quote) for each in quotes for quote in each}
    ends = {text: next((number for number, part in enumerate(parts, start=1) if text in part), 0) for text in texts}
    whole = [t for t in texts if ends[t] and not any(t in other for other in texts - {t})]
    return tuple(Rule(text, text, ends[text]) for text in sorted(whole, key=lambda text: (ends[text], text)))


def _ids(names: tuple[str, ...], rules: tuple[Rule, ...]) -> tuple[str, ...]:
    return tuple(dict.fromkeys(rule for name in names for rule in named_by(name, rules)))


def _broken(mistake: Mistake, trial: Trial, rules: tuple[str, ...], checks: tuple[ListedCheck, ...]) -> BrokenRule:
    lost = round(sum(check.points for check in checks) - trial.score, 1)
    return BrokenRule(mistake.name, mistake.summary, rules, trial.failed, lost, trial.score, mistake.costs_more)


def problems_of_rules(
    exercise: Exercise,
    results: tuple[RuleResult, ...],
    mistakes: tuple[Mistake, ...],
    programs: tuple[JudgedProgram, ...],
) -> list[AuditProblem]:
    """Return what is wrong with the rules, their mistakes and the points; nothing if the task marks no rules."""
    if not rules_of(exercise.task):
        return []
    task = exercise.folder / "task.md"
    found = [_twice(task, rule) for rule in ids_used_twice(rules_of(exercise.task))]
    for result in results:
        found += _of_rule(task, result)
    files = {mistake.name: (mistake.file, mistake.line) for mistake in mistakes}
    points = {result.id: result.points for result in results}
    best = max((program for program in programs if program.kind == "baseline"), key=lambda p: p.score, default=None)
    for broken in {each.name: each for result in results for each in result.mistakes}.values():
        found += _of_mistake(*files[broken.name], broken, sum(points[rule] for rule in broken.rules), best)
    named = {each.name for result in results for each in result.mistakes}
    found += [_names_none(mistake) for mistake in mistakes if mistake.name not in named]
    return found + list(_of_baselines(exercise, programs))


def _twice(task: Path, rule: Rule) -> AuditProblem:
    return AuditProblem(
        task, rule.line, f"there are two rules with the id {rule.id}", "Give each its own.", about=rule.id
    )


def _of_rule(task: Path, result: RuleResult) -> Iterator[AuditProblem]:
    subject = f"the rule {result.id} (“{result.text}”)"
    if not result.checks:
        fix = 'Name it in the check that judges it, with rule="…", or take it out of the task.'
        yield AuditProblem(task, result.line, f"no check is based on {subject}", fix, about=result.id)
    caught = [mistake for mistake in result.mistakes if mistake.caught_by]
    if len(caught) < FEWEST:
        text = f"{len(caught)} of the mistakes in mistakes.md break {subject} and are caught; there must be {FEWEST}"
        yield AuditProblem(task, result.line, text, "Write mistakes that break it and nothing else.", about=result.id)


def _of_mistake(
    file: Path, line: int, broken: BrokenRule, points: float, best: JudgedProgram | None
) -> Iterator[AuditProblem]:
    subject = f"the mistake mistakes/{broken.name} (“{broken.title}”)"
    costs = f"costs {broken.lost:g} points"
    dear, poor = broken.lost > DEAREST * points, bool(best and broken.score < best.score)
    if broken.costs_more:
        if not dear and not poor:
            text = (
                f"{subject} has a reason to cost more than {DEAREST:g} times the {points:g} of its rules, and {costs}"
            )
            yield AuditProblem(file, line, text, "Remove the paragraph “Costs more:”.", about=broken.name)
        return
    if dear:
        text = f"{subject} {costs}, more than {DEAREST:g} times the {points:g} of its rules"
        fix = (
            "Let fewer checks depend on what it fails, or let checks judge only their own rule. If nothing else can be "
            "judged without it, write “Costs more:” and why in its section."
        )
        yield AuditProblem(file, line, text, fix, about=broken.name)
    if best and poor:
        text = f"{subject} gets {broken.score:g} points, fewer than {best.score:g} for {best.title}"
        fix = "Let the checks that that program passes depend on one that it fails."
        yield AuditProblem(file, line, text, fix, about=broken.name)


def _names_none(mistake: Mistake) -> AuditProblem:
    text = f"the mistake mistakes/{mistake.name} (“{mistake.summary}”) names no rule of the task that it breaks"
    fix = "Write “Breaks:” and the id of a rule, or words of it in quotation marks."
    return AuditProblem(mistake.file, mistake.line, text, fix, about=mistake.name)


def _of_baselines(exercise: Exercise, programs: tuple[JudgedProgram, ...]) -> Iterator[AuditProblem]:
    for program in programs:
        if program.kind == "baseline" and program.score > LARGEST * exercise.points:
            text = f"{program.title} gets {program.score:g} of {exercise.points:g} points, more than {LARGEST:.0%}"
            fix = "Let the checks that it passes depend on one that looks at what the messages hold."
            yield AuditProblem(exercise.folder, None, text, fix, about=program.name)
