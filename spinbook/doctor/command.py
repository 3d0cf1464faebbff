"""`spinbook doctor`: what works on this machine, and how to fix what does not."""

from __future__ import annotations

import dataclasses
import json
import sys

import click
from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn

from spinbook.doctor.diagnosis import CHECKS, Check, diagnose
from spinbook.doctor.finding import Finding, is_able, show


@click.command()
@click.argument("checks", nargs=-1, type=click.Choice([check.word for check in CHECKS]), metavar="[CHECK]...")
@click.option("--json", "as_json", is_flag=True, help="Print the findings as JSON, for programs and bug reports.")
def doctor(checks: tuple[str, ...], as_json: bool) -> None:
    """Say what works on this machine, and how to fix what does not.

    Each CHECK really tries the thing: a message goes from one process to another, a kernel starts, colcon builds a
    package, a program runs in each sandbox. Nothing is changed. Without CHECK all are made, in a few seconds:

    \b
      python       folder       libraries    ros
      middleware   logs         message      environment
      memory       kernel       colcon       compiler
      namespaces   sandbox      bubblewrap   lockstep
      ros2         browser

    \b
      ✓  works
      !  courses are built and graded, but something is weaker or surprising
      ✗  courses can't be built or graded until this is fixed

    Exit code: 0 everything that is needed works (there may be warnings), 1 something needed does not.
    """
    chosen = [check for check in CHECKS if not checks or check.word in checks]
    findings = _with_progress(chosen)
    if as_json:
        rows = [dataclasses.asdict(finding) for finding in findings]
        click.echo(json.dumps({"able": is_able(findings), "findings": rows}, indent=2, ensure_ascii=False))
    else:
        show(Console(highlight=False), findings)
    sys.exit(0 if is_able(findings) else 1)


def _with_progress(chosen: list[Check]) -> list[Finding]:
    """Make the checks under a bar on stderr, which goes away at the end."""
    columns = (TextColumn("Examining"), BarColumn(), MofNCompleteColumn(), TextColumn("{task.description}"))
    console = Console(stderr=True)
    with Progress(*columns, console=console, transient=True, disable=not console.is_terminal) as bar:
        task = bar.add_task("", total=len(chosen))
        return diagnose(chosen, lambda finding: bar.update(task, advance=1, description=finding.name))
