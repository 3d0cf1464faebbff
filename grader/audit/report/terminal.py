"""An audit for people, on a terminal."""

from __future__ import annotations

from pathlib import Path

from rich.console import Console
from rich.padding import Padding
from rich.syntax import Syntax
from rich.table import Table
from rich.text import Text

from grader.audit.result import Audit, Problem
from grader.audit.shadow import Shadow
from grader.report.printable import printable


def show(audit: Audit, console: Console) -> None:
    """Print what there is to mend, then what each check is worth and the score."""
    console.print(Text(printable(f"{audit.title} ({audit.exercise})"), style="bold"))
    _show_programs(audit, console)
    for problem in audit.problems:
        _show_problem(problem, console)
    if not audit.quick:
        console.print(_checks(audit))
    _show_score(audit, console)


def show_shadow(shadow: Shadow, console: Console) -> None:
    """Print each verdict on which the two middlewares disagree."""
    console.print(Text(printable(f"{shadow.title} ({shadow.exercise})"), style="bold"))
    for one in shadow.differing:
        console.print(Text.assemble((" ≠ ", "yellow"), printable(f"{one.program}, {one.check}")), soft_wrap=True)
        lines = (f"lockstep  {one.lockstep}", f"fastdds   {one.fast_dds}", one.reason or "no reason is known")
        for line in lines:
            console.print(Padding(Text(printable(line), style="dim"), (0, 0, 0, 3)))
    verdicts = shadow.equal + len(shadow.differing)
    told = f"{shadow.programs} programs over both middlewares: {len(shadow.differing)} of {verdicts} verdicts differ"
    console.print(Text(f"{told} ({shadow.seconds:.0f} s)", style="yellow" if shadow.differing else "bold green"))


def _show_programs(audit: Audit, console: Console) -> None:
    counts = {kind: sum(p.kind == kind for p in audit.programs) for kind in ("solution", "right", "mistake", "nothing")}
    tried = f"tried: {counts['solution'] + counts['right']} right solutions"
    if audit.seeds:
        tried += f" (with {audit.seeds} seeds)"
    tried += f", {counts['mistake']} mistakes, {counts['nothing']} that do nothing, {len(audit.mutants)} mutants"
    console.print(Text(tried + (", a sample" if audit.sampled else ""), style="dim"))


def _show_problem(problem: Problem, console: Console) -> None:
    console.print(Text.assemble((" ✗ ", "red"), printable(problem.found)), soft_wrap=True)
    console.print(Padding(Text(printable(_short(problem.place)), style="dim"), (0, 0, 0, 3)))
    if problem.diff:
        console.print(Padding(Syntax(problem.diff, "diff", background_color="default", word_wrap=True), (0, 0, 0, 3)))
    if problem.evidence:
        console.print(Padding(Text(printable(problem.evidence)), (0, 0, 0, 3)))
    console.print(Padding(Text(printable(problem.mend), style="cyan"), (0, 0, 0, 3)))


def _short(place: str) -> str:
    """The place from the folder in which the command was given."""
    here = f"{Path.cwd()}/"
    return place.removeprefix(here)


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
            f"{check.spinning_s + check.judging_s:.2f}",
        )
    return table


def _show_score(audit: Audit, console: Console) -> None:
    told = f"{audit.count('caught')} of {audit.different} mutants that differ are caught"
    told += f" ({audit.score:.1%}); {audit.count('equivalent')} more do not differ from the solution"
    if audit.count("listed"):
        told += f"; {audit.count('listed')} are listed as survivors"
    console.print(Text(told, style="bold"))
    many = len(audit.problems)
    verdict = "nothing to mend" if not many else f"{many} thing{'s' if many > 1 else ''} to mend"
    console.print(Text(verdict, style="bold red" if many else "bold green"))
    console.print(Text(f"{audit.seconds:.0f} s; {audit.made} tried, {audit.kept} known from before", style="dim"))
