"""What a check found, and how a table shows it."""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import dataclass
from enum import Enum
from pathlib import Path

from rich.console import Console
from rich.table import Table
from rich.text import Text


class State(str, Enum):
    """How grave a finding is."""

    OK = "ok"
    """It works."""
    WARNING = "warning"
    """Something is weaker, or surprising; courses are built and graded all the same."""
    MISSING = "missing"
    """Without it courses are not built or not graded."""


@dataclass(frozen=True)
class Finding:
    """One thing that was looked at.

    `found` tells what is there, with versions and places. `fix` tells what to do where it is not well.
    """

    name: str
    state: State
    found: str
    fix: str = ""


def ok(name: str, found: str) -> Finding:
    """It works."""
    return Finding(name, State.OK, found)


def warning(name: str, found: str, fix: str) -> Finding:
    """It works, but not as well as it could."""
    return Finding(name, State.WARNING, found, fix)


def missing(name: str, found: str, fix: str) -> Finding:
    """Something that is needed does not work."""
    return Finding(name, State.MISSING, found, fix)


SIGNS = {State.OK: ("✓", "green"), State.WARNING: ("!", "yellow"), State.MISSING: ("✗", "red")}


def show(console: Console, findings: Sequence[Finding]) -> None:
    """Print every finding, then what to do about those that are not well, then a line that sums up."""
    table = Table(box=None, show_header=False, pad_edge=False, padding=(0, 1))
    table.add_column(width=1)
    table.add_column(no_wrap=True)
    table.add_column(overflow="fold")
    for finding in findings:
        sign, colour = SIGNS[finding.state]
        table.add_row(Text(sign, style=colour), Text(finding.name), Text(_with_tilde(finding.found)))
    console.print(table)
    for finding in findings:
        if finding.fix:
            sign, colour = SIGNS[finding.state]
            console.print()
            console.print(Text.assemble((f"{sign} {finding.name}", f"bold {colour}")))
            console.print(Text("\n".join(f"  {line}" for line in finding.fix.splitlines())), soft_wrap=True)
    console.print()
    console.print(_summary(findings), soft_wrap=True)


def is_able(findings: Sequence[Finding]) -> bool:
    """Whether everything that is needed to build and grade works."""
    return all(finding.state is not State.MISSING for finding in findings)


def _summary(findings: Sequence[Finding]) -> str:
    amiss = sum(finding.state is State.MISSING for finding in findings)
    warnings = sum(finding.state is State.WARNING for finding in findings)
    also = f" ({warnings} {'warning' if warnings == 1 else 'warnings'})" if warnings else ""
    if amiss:
        return f"Courses can't be built or graded here until what has a ✗ is fixed: {amiss} of {len(findings)}{also}."
    return f"Courses can be built and graded here{also}."


def _with_tilde(text: str) -> str:
    home = os.environ.get("HOME", "")
    return text.replace(f"{home}/", "~/") if Path(home).is_absolute() and home != "/" else text
