"""Which known mistakes a submission makes, as far as its failures tell."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from grader.classroom.entry import Entry
from grader.misconception.signature import Failure, Signature, failures_of

#: How well a submission's failure fits a signature's: the same words, the same kind, another value where one was
#: expected, or only the same check.
SAME, SAME_KIND, ANOTHER_VALUE, SAME_CHECK = 1.0, 0.75, 0.5, 0.25

#: How well all of a signature's failures have to fit, on average. Less will do where the submission fails just those
#: checks, two at least.
FITS, FITS_ALL = 0.6, 0.5


@dataclass(frozen=True)
class Group:
    """Students whose submissions fail as a known mistake does."""

    signature: Signature
    entries: tuple[Entry, ...]


@dataclass(frozen=True)
class Misconceptions:
    """Groups, the largest first; and under `other` who fails checks in ways that no known mistake does."""

    groups: tuple[Group, ...]
    other: tuple[Entry, ...]

    def of(self, entry: Entry) -> tuple[Signature, ...]:
        """The known mistakes that a student makes."""
        return tuple(group.signature for group in self.groups if entry in group.entries)


def grouped(entries: Sequence[Entry], signatures: Sequence[Signature]) -> Misconceptions:
    """Group the graded submissions that fail checks by the known mistakes they make; one may make several."""
    found: dict[int, list[Entry]] = {}
    other: list[Entry] = []
    for entry in entries:
        failed = failures_of(entry.grade)
        made = _mistakes(failed, signatures)
        for number in made:
            found.setdefault(number, []).append(entry)
        if failed and not made:
            other.append(entry)
    groups = [Group(signatures[number], tuple(members)) for number, members in sorted(found.items())]
    return Misconceptions(tuple(sorted(groups, key=lambda group: -len(group.entries))), tuple(other))


def _mistakes(failed: dict[str, Failure], signatures: Sequence[Signature]) -> list[int]:
    """Numbers of the signatures that explain `failed`.

    The one that explains most comes first; then what it explains is set aside, and the rest is looked at again.
    """
    left, made = dict(failed), []
    while left:
        scores = {number: _score(left, signature) for number, signature in enumerate(signatures) if number not in made}
        best = max(scores, key=lambda number: scores[number], default=None)
        if best is None or scores[best] == 0:
            break
        made.append(best)
        for name in signatures[best].failures:
            left.pop(name, None)
    return made


def _score(failed: dict[str, Failure], signature: Signature) -> float:
    """How much of `failed` a signature explains, 0 where it does not fit."""
    fits = [_fit(failed.get(name), failure) for name, failure in signature.failures.items()]
    enough = FITS_ALL if len(fits) > 1 and failed.keys() == signature.failures.keys() else FITS
    return sum(fits) if sum(fits) / len(fits) >= enough else 0.0


def _fit(failure: Failure | None, known: Failure) -> float:
    if failure is None:
        return 0.0
    if failure.text == known.text:
        return SAME
    if failure.kind == known.kind:
        return ANOTHER_VALUE if known.bare else SAME_KIND
    return SAME_CHECK
