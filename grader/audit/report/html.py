"""Audits as a page."""

from __future__ import annotations

from pathlib import Path

from grader.audit.report.as_json import write
from grader.audit.result import Audit, Fate, MutantResult, Problem
from grader.pages import render

#: Fate -> what it is called, and the page's colour for it.
FATES: dict[Fate, tuple[str, str]] = {
    "survived": ("not caught", "bad"),
    "listed": ("not caught, with a reason", "wait"),
    "caught": ("caught", "good"),
    "equivalent": ("no difference", ""),
}


def write_html(audits: list[Audit], faults: list[Problem], file: Path) -> None:
    """Write a page about these audits, and the `faults` for which an exercise could not be audited.

    It is one file, needs no network and runs no script.
    """
    here = f"{Path.cwd()}/"
    write(
        file,
        render(
            "audit/report/audit.html",
            audits=audits,
            faults=faults,
            fates=FATES,
            mutants={audit.exercise: _by_operator(audit) for audit in audits},
            most={audit.exercise: max([check.kills for check in audit.checks] or [1]) or 1 for audit in audits},
            short=lambda place: place.removeprefix(here),
            lines=_lines,
        ),
    )


def _by_operator(audit: Audit) -> list[tuple[str, list[MutantResult]]]:
    """The mutants, those first that no check catches, each kind together."""
    order = list(FATES)
    groups: dict[str, list[MutantResult]] = {}
    for result in sorted(audit.mutants, key=lambda result: (result.mutant.operator, order.index(result.fate))):
        groups.setdefault(result.mutant.operator, []).append(result)
    return list(groups.items())


def _lines(diff: str) -> list[tuple[str, str]]:
    """A diff's lines, without its header, each with what it is: `added`, `removed` or nothing."""
    kinds = {"+": "added", "-": "removed"}
    return [(line, kinds.get(line[:1], "")) for line in diff.splitlines()[2:]]
