"""The checks of a result as a student sees them: one cause is said once, and further hints come on request."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from grader.checking.hint_texts import hints_of_ending
from grader.checking.verdict import Finding, Status, Verdict

if TYPE_CHECKING:
    from grader.grading.grade import Grade

# A public check is shown in full. A hidden one is shown with its title, its points, whether it passed, and its hints,
# which are written for students; never with its name, its scenario, or an expected number, which would reveal it.

#: A status as a sign and as a word. `error` is the grader's fault, and then there is no score.
SIGNS: dict[Status, tuple[str, str]] = {
    "passed": ("✓", "passed"),
    "failed": ("✗", "failed"),
    "blocked": ("–", "waits for another check"),
    "error": ("!", "not judged"),
}

#: The sign and the word for a check that passed, but whose rule the public scenarios do not test.
UNTESTED = ("○", "not tested here")

_ENDED = ("did-not-start", "crashed", "timed-out", "over-limit")

#: What comes before the second and the third step of a hint.
LABELS = ("Where to look", "What to do")


@dataclass(frozen=True)
class ShownCheck:
    """One check as a student sees it; hidden ones have no `finding`.

    `hints` are where to look and what to do. If an earlier check has failed for the same reason, `same_as` is its
    title, and finding and hints are only there. `waiting` is how many more checks fail for the same reason or can't be
    judged before, and `needs` are the titles of the checks that it waits for itself. `untested` says what a check that
    passed could not show in a self-check.
    """

    title: str
    status: Status
    sign: str
    word: str
    earned: float
    points: float
    hidden: bool
    finding: Finding | None = None
    hints: tuple[str, ...] = ()
    same_as: str = ""
    waiting: int = 0
    needs: tuple[str, ...] = ()
    untested: str = ""

    @property
    def labelled_hints(self) -> tuple[tuple[str, str], ...]:
        """Return each hint with what comes before it."""
        return tuple(zip(LABELS, self.hints, strict=False))

    @property
    def note(self) -> str:
        """Return how it depends on other checks, or what it could not test; "" if there is nothing to say."""
        if self.untested:
            return f"Not tested here: {self.untested} It is tested when your work is graded."
        if self.same_as:
            return f"The same cause as: {self.same_as}"
        several = self.waiting > 1
        return f"{self.waiting} more check{'s' * several} wait{'s' * (not several)} for this." if self.waiting else ""

    @property
    def text(self) -> str:
        """Return the same in a few lines of plain text, without title and points, for where it stands alone."""
        lines = [self.finding.text if self.finding else "", self.note]
        lines.append(f"Can't be judged until this is right: {' '.join(self.needs)}" if self.needs else "")
        lines += [f"{label}: {hint}" for label, hint in self.labelled_hints]
        return "\n".join(filter(None, lines))


def shown_checks(grade: Grade) -> tuple[ShownCheck, ...]:
    """Return every check of a grade, in order, with what a student may know about it."""
    return shown_verdicts(grade.verdicts, telling=grade.outcome == "graded", self_check=grade.self_check)


def first_hints(grade: Grade) -> tuple[str, tuple[tuple[str, str], ...]]:
    """Return the title of the first check that fails, and its hints, each with what comes before it.

    If the program ended early, there is no such check: then the hints are about that.
    """
    if grade.outcome in _ENDED:
        steps = hints_of_ending(grade.outcome, grade.message if grade.line else "", grade.line)
        return "Your program ended early.", tuple(zip(LABELS, steps, strict=True))
    first = next((check for check in shown_checks(grade) if check.hints), None)
    return (first.title, first.labelled_hints) if first else ("", ())


def public_total(verdicts: Sequence[Verdict]) -> str:
    """Return how many of the checks that can be judged here passed: "8 of 8 public checks, 50 of 50 points".

    A check that passed, but whose rule is not tested here, does not count, nor do its points.
    """
    counted = [verdict for verdict in verdicts if not (verdict.untested and verdict.status == "passed")]
    passed = sum(verdict.status == "passed" for verdict in counted)
    earned, points = sum(verdict.earned for verdict in counted), sum(verdict.points for verdict in counted)
    return f"{passed} of {len(counted)} public checks, {earned:g} of {points:g} points"


def shown_verdicts(verdicts: Sequence[Verdict], telling: bool, self_check: bool) -> tuple[ShownCheck, ...]:
    """Return every check, in order, with what a student may know about it.

    It is not `telling` if the first scenario broke off: the result's message says so, and each check would repeat it.
    """
    first = _first_of_each_cause(verdicts)
    return tuple(_shown(verdict, verdicts, first, telling, self_check) for verdict in verdicts)


def _first_of_each_cause(verdicts: Sequence[Verdict]) -> dict[str, Verdict]:
    first: dict[str, Verdict] = {}
    for verdict in verdicts:
        if verdict.status == "failed":
            first.setdefault(_cause(verdict), verdict)
    return first


def _cause(verdict: Verdict) -> str:
    """Return what makes a check fail: two that fail for one reason have the same text."""
    finding = verdict.finding
    return (finding.cause or finding.text) if finding else verdict.name


def _shown(
    verdict: Verdict, verdicts: Sequence[Verdict], first: dict[str, Verdict], telling: bool, self_check: bool
) -> ShownCheck:
    untested = verdict.untested if self_check and verdict.status == "passed" else ""
    sign, word = UNTESTED if untested else SIGNS[verdict.status]
    failed = verdict.status == "failed" and telling
    said_by = first[_cause(verdict)] if failed else verdict
    says_it = failed and said_by is verdict
    titles = {other.name: other.title for other in verdicts}
    return ShownCheck(
        verdict.title,
        verdict.status,
        sign,
        word,
        verdict.earned,
        verdict.points,
        verdict.hidden,
        finding=verdict.finding if says_it and not verdict.hidden else None,
        hints=_hints(verdict) if says_it else (),
        same_as="" if said_by is verdict else said_by.title,
        waiting=_waiting(verdict, verdicts) if says_it else 0,
        needs=tuple(titles.get(name, name) for name in verdict.blocked_by) if telling else (),
        untested=untested,
    )


def _hints(verdict: Verdict) -> tuple[str, ...]:
    """Return where to look and what to do: of the cause, if one was observed, otherwise of the check."""
    finding = verdict.finding
    steps = (finding.where, finding.todo) if finding and finding.where else (verdict.hint, verdict.todo)
    return tuple(filter(None, steps))


def _waiting(verdict: Verdict, verdicts: Sequence[Verdict]) -> int:
    """Return how many other checks fail for the same reason, or wait for one that does."""
    same = {other.name for other in verdicts if other.status == "failed" and _cause(other) == _cause(verdict)}
    waiting = [other for other in verdicts if other.blocked_by and other.blocked_by[0] in same]
    return len(same) - 1 + len(waiting)
