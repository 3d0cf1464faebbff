"""Shows an audit: on a terminal, as JSON and as a page."""

from __future__ import annotations

import dataclasses
import itertools
import json
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from rich.console import Console
from rich.padding import Padding
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TaskID, TextColumn, TimeRemainingColumn
from rich.syntax import Syntax
from rich.table import Table
from rich.text import Text

from grader.audit.result import Audit, AuditProblem, Fate, MutantResult, RuleResult
from grader.report.pages import render
from grader.report.printable import printable
from groundwork.files import write_if_changed
from groundwork.words import counted


def show(audit: Audit, console: Console) -> None:
    """Print the problems, then what each check is worth, and the score."""
    console.print(Text(printable(f"{audit.title} ({audit.exercise})"), style="bold"))
    _show_programs(audit, console)
    for problem in audit.problems:
        _show_problem(problem, console)
    if audit.rules:
        console.print(_rules(audit))
    if audit.mutants and not audit.quick:
        console.print(_checks(audit))
    _show_score(audit, console)


def _show_programs(audit: Audit, console: Console) -> None:
    counts = {kind: sum(p.kind == kind for p in audit.programs) for kind in ("solution", "right", "mistake", "nothing")}
    tried = f"tried: {counts['solution'] + counts['right']} right solutions"
    if audit.seeds:
        tried += f" (with {audit.seeds} seeds)"
    tried += f", {counts['mistake']} mistakes, {counts['nothing']} that do nothing"
    if audit.mutants:
        tried += f", {len(audit.mutants)} mutants" + (", a sample" if audit.sampled else "")
    console.print(Text(tried, style="dim"))
    if scores := [f"{p.title} {p.score:g}" for p in audit.programs if p.kind == "baseline"]:
        console.print(Text(f"points without any work: {', '.join(scores)}", style="dim"))
    elif not audit.quick:
        console.print(
            Text(
                "task.md marks no rules: these are the sentences that checks and mistakes quote, without a verdict",
                style="dim",
            )
        )


def _show_problem(problem: AuditProblem, console: Console) -> None:
    console.print(Text.assemble((" ✗ ", "red"), printable(problem.problem)), soft_wrap=True)
    console.print(Padding(Text(printable(_short(problem.place)), style="dim"), (0, 0, 0, 3)))
    if problem.diff:
        console.print(Padding(Syntax(problem.diff, "diff", background_color="default", word_wrap=True), (0, 0, 0, 3)))
    if problem.evidence:
        console.print(Padding(Text(printable(problem.evidence)), (0, 0, 0, 3)))
    console.print(Padding(Text(printable(problem.fix), style="cyan"), (0, 0, 0, 3)))


def _short(place: str) -> str:
    """Return the path relative to the current folder."""
    return place.removeprefix(f"{Path.cwd()}/")


def _rules(audit: Audit) -> Table:
    """Return the rules of the task, each with its points, and the mistakes that break it with what they cost."""
    table = Table(box=None, pad_edge=False, header_style="dim", padding=(0, 1))
    for name in ("rule", "points", "mistake", "costs", "caught by"):
        table.add_column(name, justify="right" if name in ("points", "costs") else "left", overflow="fold")
    for rule in audit.rules:
        for row in _rows(rule, rule.id):
            table.add_row(*row)
    if any(broken.costs_more for rule in audit.rules for broken in rule.mistakes):
        table.caption, table.caption_justify = f"* {_COSTS_MORE}", "left"
    return table


_COSTS_MORE = "more than its rule is worth: mistakes.md says why"


def _rows(rule: RuleResult, name: str) -> Iterator[tuple[str, ...]]:
    """Yield the rows of a rule, one per mistake: rule, points, mistake, costs and checks. The first has its `name`."""
    if not rule.mistakes:
        yield name, f"{rule.points:g}", "none", "", ""
    for number, broken in enumerate(rule.mistakes):
        first = ("", "") if number else (name, f"{rule.points:g}")
        yield *first, broken.name, f"{broken.lost:g}{'*' if broken.costs_more else ''}", " ".join(broken.caught_by)


def write_markdown(audits: list[Audit], file: Path) -> None:
    """Write the rules of each task as a table: the mistakes that break them, what these cost, and what catches them."""
    write_if_changed(file, "\n".join(line for audit in audits for line in _markdown(audit)))


def _markdown(audit: Audit) -> Iterator[str]:
    yield f"## {audit.title} ({audit.exercise})\n"
    right = [program.score for program in audit.programs if program.kind in ("solution", "right")]
    baselines = ", ".join(f"{p.title} {p.score:g}" for p in audit.programs if p.kind == "baseline")
    yield f"{len(right)} right solutions: at least {min(right):g} points. Without any work: {baselines}."
    if audit.mutants:
        yield f"Mutants: {_score(audit)}."
    yield f"A `*` marks a mistake that costs {_COSTS_MORE}.\n"
    yield "| rule | points | mistake | costs | caught by |\n| --- | ---: | --- | ---: | --- |"
    for rule in audit.rules:
        name = (f"**{rule.id}**: {rule.text}" if rule.id != rule.text else rule.text).replace("|", "\\|")
        for row in _rows(rule, name):
            yield f"| {' | '.join(row)} |"
    yield ""


def _checks(audit: Audit) -> Table:
    table = Table(box=None, pad_edge=False, header_style="dim", padding=(0, 1))
    table.add_column("check", overflow="fold")
    for name in ("points", "mutants", "score", "alone", "mistakes", "seconds"):
        table.add_column(name, justify="right")
    for check in audit.checks:
        table.add_row(
            check.name,
            f"{check.points:g}",
            str(check.kills),
            f"{check.score:.0%}",
            str(check.alone),
            str(len(check.mistakes)),
            f"{check.running_s + check.judging_s:.2f}",
        )
    return table


def _show_score(audit: Audit, console: Console) -> None:
    if audit.mutants:
        console.print(Text(_score(audit), style="bold"))
    many = len(audit.problems)
    verdict = f"{counted(many, 'thing')} to fix" if many else "nothing to fix"
    console.print(Text(verdict, style="bold red" if many else "bold green"))
    console.print(
        Text(f"{audit.seconds:.0f} s; {audit.made} tried, {audit.kept} reused from earlier runs", style="dim")
    )


def _score(audit: Audit) -> str:
    text = f"{audit.count('caught')} of {audit.different} mutants that differ are caught"
    text += f" ({audit.score:.1%}); {audit.count('equivalent')} more do not differ from the solution"
    if audit.count("listed"):
        text += f"; {audit.count('listed')} are listed as survivors"
    return text


class ProgressBar:
    """A bar on a terminal. Elsewhere, such as in a log, it is one line for each tenth."""

    def __init__(self, console: Console, bar: Progress) -> None:
        self._console, self._bar = console, bar
        self._task: TaskID | None = None
        self._exercise = ""
        self._done, self._total = 0, 0

    def begin(self, exercise: str, total: int) -> None:
        """Start to count to `total`."""
        self._exercise, self._done, self._total = exercise, 0, total
        if self._console.is_terminal:
            self._task = self._bar.add_task(exercise, total=total)

    def done(self) -> None:
        """Count one more."""
        self._done += 1
        if self._task is not None:
            self._bar.update(self._task, advance=1)
        elif self._done * 10 // self._total > (self._done - 1) * 10 // self._total:
            self._console.print(f"{self._exercise}: {self._done} of {self._total}")


@contextmanager
def on(console: Console) -> Iterator[ProgressBar]:
    """Show a bar on this console, and remove it afterwards."""
    columns = (TextColumn("{task.description:<40.40}"), BarColumn(), MofNCompleteColumn(), TimeRemainingColumn())
    with Progress(*columns, console=console, transient=True, disable=not console.is_terminal) as bar:
        yield ProgressBar(console, bar)


def write_json(audits: list[Audit], faults: list[AuditProblem], file: Path) -> None:
    """Write everything that the audits found, and the `faults` because of which exercises could not be audited."""
    entries = {"audits": [_entries(audit) for audit in audits], "faults": [_problem_entries(fault) for fault in faults]}
    write_if_changed(file, json.dumps(entries, indent=2, ensure_ascii=False) + "\n")


def _entries(audit: Audit) -> dict[str, Any]:
    entries = dataclasses.asdict(audit)
    entries["problems"] = [_problem_entries(problem) for problem in audit.problems]
    for mutant in entries["mutants"]:
        del mutant["mutant"]["source"]
    counts = {fate: audit.count(fate) for fate in ("caught", "equivalent", "listed", "survived")}
    return {**entries, "score": audit.score, "different": audit.different, **counts}


def _problem_entries(problem: AuditProblem) -> dict[str, str]:
    return {name: getattr(problem, name) for name in ("place", "about", "problem", "fix", "diff", "evidence")}


#: Result of a mutant -> its name on the page, and its colour.
FATES: dict[Fate, tuple[str, str]] = {
    "survived": ("not caught", "bad"),
    "listed": ("not caught, with a reason", "wait"),
    "caught": ("caught", "good"),
    "equivalent": ("no difference", ""),
}


def write_html(audits: list[Audit], faults: list[AuditProblem], file: Path) -> None:
    """Write a page about these audits, and the `faults` because of which exercises could not be audited.

    It is one file, needs no network and runs no script.
    """
    write_if_changed(
        file,
        render(
            "audit/audit.html",
            audits=audits,
            faults=faults,
            fates=FATES,
            mutants={audit.exercise: _by_operator(audit) for audit in audits},
            most={audit.exercise: max([check.kills for check in audit.checks] or [1]) or 1 for audit in audits},
            short=_short,
            lines=_lines,
        ),
    )


def _by_operator(audit: Audit) -> list[tuple[str, list[MutantResult]]]:
    """Return the mutants, grouped by kind; those that no check catches come first."""
    order = list(FATES)
    by_operator = sorted(audit.mutants, key=lambda result: (result.mutant.operator, order.index(result.fate)))
    groups = itertools.groupby(by_operator, key=lambda result: result.mutant.operator)
    return [(operator, list(results)) for operator, results in groups]


def _lines(diff: str) -> list[tuple[str, str]]:
    """Return a diff's lines, without its header, each with its kind: `added`, `removed` or nothing."""
    kinds = {"+": "added", "-": "removed"}
    return [(line, kinds.get(line[:1], "")) for line in diff.splitlines()[2:]]
