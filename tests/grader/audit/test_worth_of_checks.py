"""What a check is worth is known only if it was judged; mutants run further scenarios if a doubt is left."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from grader.audit.result import Trial
from grader.audit.worth import problems_of_checks, worth_running_on
from grader.checking.verdict import Finding, ListedCheck, Status


def check(name: str, depends: tuple[str, ...] = ()) -> ListedCheck:
    """Return a check of its own scenario."""
    place: dict[str, Any] = {"file": Path("checks.py"), "line": 1}
    return ListedCheck(1.0, "", depends, "", name=name, title=name, hidden=False, scenarios=(name,), **place)


def trial(**statuses: Status) -> Trial:
    """Return the trial of a program for which these checks were judged."""
    findings = {name: Finding("1 was expected") for name, status in statuses.items() if status == "failed"}
    return Trial("", dict(statuses), findings, tuple(statuses), 3, ())


A, B = check("a"), check("b")


def test_two_checks_that_look_alike_are_told_apart_by_mutants_that_only_one_of_them_has_seen() -> None:
    mistake = {"both.py": trial(a="failed", b="failed")}
    mutants = {"1": trial(a="passed", b="passed"), "2": trial(a="failed"), "3": trial(b="failed")}
    assert [one.about for one in problems_of_checks((A, B), {**mistake, **mutants})] == ["b"]
    assert worth_running_on((A, B), {**mistake, **mutants}, mutants) == ["2", "3"]
    settled = {**mistake, **mutants, "2": trial(a="failed", b="passed")}
    assert problems_of_checks((A, B), settled) == []
    assert worth_running_on((A, B), settled, mutants) == []


def test_a_check_that_has_not_failed_yet_gets_mutants_that_did_not_come_as_far_as_to_it() -> None:
    mutants = {"1": trial(a="passed", b="passed"), "2": trial(a="failed"), "3": trial(a="passed", b="failed")}
    some = {id_: mutants[id_] for id_ in ("1", "2")}
    assert worth_running_on((A, B), some, some) == ["2"]
    assert worth_running_on((A, B), mutants, mutants) == [], "it fails for the third"
    depending = check("b", depends=("a",))
    assert worth_running_on((A, depending), some, some) == [], "the second one never comes as far as to it"


def test_for_each_doubt_a_few_mutants_are_enough() -> None:
    mutants = {str(number): trial(a="failed") for number in range(100)}
    assert len(worth_running_on((A, B), mutants, mutants)) == 4
