"""What of a check's verdict may be told to a student.

Of a public check everything. Of a hidden one its title, its points, whether it was passed, and its hint, which its
author wrote for students; never its name, its scenario, or a number that was expected: those would give it away.
"""

from __future__ import annotations

from dataclasses import dataclass

from grader.checking.verdict import Status, Verdict
from grader.checking.wrong import Finding
from grader.grading import Grade

#: A status as a sign and as a word. `error` is our fault, and then there is no score.
SIGNS: dict[Status, tuple[str, str]] = {
    "passed": ("✓", "passed"),
    "failed": ("✗", "failed"),
    "blocked": ("–", "can't be judged yet"),
    "error": ("!", "not judged"),
}


@dataclass(frozen=True)
class Told:
    """One check as a student sees it; hidden ones without `finding`. `needs` are titles of checks to mend first."""

    title: str
    status: Status
    sign: str
    word: str
    earned: float
    points: float
    hidden: bool
    finding: Finding | None
    hint: str
    needs: tuple[str, ...]

    @property
    def text(self) -> str:
        """The same in a few lines of plain text, without title and points."""
        lines = [self.finding.text] if self.finding else []
        if self.needs:
            lines.append("Can't be judged before this is right: " + " ".join(self.needs))
        if self.hint:
            lines.append(f"Hint: {self.hint}")
        return "\n".join(lines)


def told(grade: Grade) -> tuple[Told, ...]:
    """Every check of `grade`, in order, with what a student may know of it."""
    titles = {verdict.name: verdict.title for verdict in grade.verdicts}
    return tuple(_told(verdict, grade, titles) for verdict in grade.verdicts)


def _told(verdict: Verdict, grade: Grade, titles: dict[str, str]) -> Told:
    # Where the first scenario broke off, that is the story; each check would repeat it.
    telling = grade.outcome == "graded"
    sign, word = SIGNS[verdict.status]
    failed = verdict.status == "failed" and telling
    return Told(
        title=verdict.title,
        status=verdict.status,
        sign=sign,
        word=word,
        earned=verdict.earned,
        points=verdict.points,
        hidden=verdict.hidden,
        finding=verdict.finding if failed and not verdict.hidden else None,
        hint=verdict.hint if failed else "",
        needs=tuple(titles.get(name, name) for name in verdict.blocked_by) if telling else (),
    )
