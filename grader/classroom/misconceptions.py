"""Known mistakes, which checks each of them fails, and which submissions fail the same way."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence, Set
from dataclasses import dataclass

from grader.checking.verdict import Finding
from grader.grading.grade import Entry, Grade


@dataclass(frozen=True)
class Failure:
    """How a check fails. `text` is the finding word for word, `kind` the finding without what is specific to a program.

    `exact` is whether the value is one that hardly any other mistake produces: a number with three or more digits.
    """

    text: str
    kind: str
    exact: bool = False

    @property
    def telling(self) -> bool:
        """Whether `kind` says what is wrong, and not only that a value differs from the expected one."""
        return not COMPARISON.fullmatch(self.kind)


@dataclass(frozen=True)
class Signature:
    """One known mistake, or several that fail in the same way.

    `names` are the names of their files, `sentences` the first lines of their docstrings. `failures` has the checks
    that they fail, by name; checks blocked by these do not count.
    """

    names: tuple[str, ...]
    sentences: tuple[str, ...]
    failures: dict[str, Failure]

    @property
    def sentence(self) -> str:
        """What the mistake is, in words."""
        return " Or: ".join(self.sentences)


#: "Message 3 of 16 (0.30 s after the start; one in three messages is lost), left_elbow: ", or the beginning of a
#: finding that is not about one of our messages: "At 2.00 s (a goal, canceled), goal 1 for /count (order 3): "
WHERE = re.compile(r"^(Message \d+ of \d+|At [\d.]+ s|Before the start) \([^)]*\)(, [^:]*)?: |^In “[^”]*”(, [^:]*)?: ")
GUESS = re.compile(r" Is \S+ a misspelling of \S+\?")
ENDED = re.compile(r"\b([A-Z]\w*(?:Error|Exception|Interrupt))\b.* in line \d+")
#: A full stop that does not end a sentence, as in header.stamp, or any other character.
INSIDE = r"(?:[^.]|\.(?=\S))*"
#: A sentence that says what was, or was not, expected. A range in it ("between") shows which rule is broken.
COMPARISON = re.compile(
    rf"(?!.* between ){INSIDE}\b(expected|must|came|got|never published|published nothing)\b{INSIDE}\."
)
NUMBER = re.compile(r"(?<![\w.])-?\d+(\.\d+)?(e[+-]?\d+)?(?![\w.]*\w)")
DIGITS = re.compile(r"[1-9](?:[\d.]*[1-9])?")
#: A value with this many significant digits is hardly ever shared by two mistakes.
ENOUGH_DIGITS = 3


def failures_of(grade: Grade) -> dict[str, Failure]:
    """Return how a graded submission fails checks, by check; nothing if its run did not complete."""
    if grade.outcome != "graded":
        return {}
    failed = [verdict for verdict in grade.verdicts if verdict.status == "failed" and verdict.finding]
    return {verdict.name: failure_of(verdict.finding) for verdict in failed if verdict.finding}


def failure_of(finding: Finding) -> Failure:
    """Return the failure that a finding describes.

    Its kind is the finding without the message and joint at which it was first seen, and without the values: "expected
    velocity ⟨expected⟩, got ⟨got⟩. Every value has the wrong sign." For a run that ended by itself, only the
    exception is left.
    """
    if ended := ENDED.search(finding.text):
        return Failure(finding.text, f"ended by {ended[1]}")
    kind = WHERE.sub("", finding.text)
    for value, name in ((finding.expected, "expected"), (finding.got, "got")):
        if value:
            count = 1 if NUMBER.match(value) else 0
            kind = re.sub(rf"(?<![\w.]){re.escape(value)}(?!\w|\.\w)", f"⟨{name}⟩", kind, count=count)
    kind = NUMBER.sub("⟨number⟩", re.sub(r" \([^)]*\)", "", GUESS.sub("", kind)))
    return Failure(finding.text, kind, _digits(finding.got) >= ENOUGH_DIGITS)


def _digits(value: str) -> int:
    """Return how many significant digits the first number in `value` has."""
    number = NUMBER.search(value)
    found = DIGITS.search(number[0].partition("e")[0]) if number else None
    return len(found[0].replace(".", "")) if found else 0


#: How well a submission's failure fits a signature's: the same specific text, or a text with a value that hardly any
#: other mistake produces; the same text; the same kind of specific text; or a comparison of two other values.
SAME, SAME_WORDS, SAME_KIND, OTHER_VALUE = 1.0, 0.8, 0.75, 0.25

#: How well a signature's failures have to fit on average: if the submission fails only those checks, and if it also
#: fails others.
FITS, FITS_AMONG_OTHERS = 0.7, 0.9


@dataclass(frozen=True)
class MisconceptionGroup:
    """Students whose submissions fail in the same way as a known mistake."""

    signature: Signature
    entries: tuple[Entry, ...]


@dataclass(frozen=True)
class Misconceptions:
    """Groups, the largest first, and the `other` students, whose failures no known mistake explains."""

    groups: tuple[MisconceptionGroup, ...]
    other: tuple[Entry, ...]

    def of(self, entry: Entry) -> tuple[Signature, ...]:
        """Return the known mistakes that a student makes."""
        return tuple(group.signature for group in self.groups if entry in group.entries)


def grouped(entries: Sequence[Entry], signatures: Sequence[Signature]) -> Misconceptions:
    """Group the graded submissions that fail checks by the known mistakes they make; one may make several."""
    found: dict[int, list[Entry]] = {}
    other: list[Entry] = []
    for entry in entries:
        failed = failures_of(entry.grade)
        made = mistakes_in(failed, blocked_in(entry.grade), signatures)
        for number in made:
            found.setdefault(number, []).append(entry)
        if failed and not made:
            other.append(entry)
    groups = [MisconceptionGroup(signatures[number], tuple(members)) for number, members in sorted(found.items())]
    return Misconceptions(tuple(sorted(groups, key=lambda group: -len(group.entries))), tuple(other))


def blocked_in(grade: Grade) -> frozenset[str]:
    """Return the checks that could not be judged because another failed."""
    return frozenset(verdict.name for verdict in grade.verdicts if verdict.status == "blocked")


def may_explain(named: Set[str], failed: Set[str], blocked: Set[str]) -> bool:
    """Return whether a mistake that fails the checks `named` can explain a submission, whatever its findings are."""
    judged = named - blocked
    return 2 * len(judged) >= len(named) and len(judged & failed) >= FITS * len(judged)


def mistakes_in(failed: Mapping[str, Failure], blocked: Set[str], signatures: Sequence[Signature]) -> list[int]:
    """Return the indices of the signatures that explain how a submission fails, the one that explains most first.

    What one signature explains is set aside, and the rest is matched again. If two explain the same failures equally
    well, neither is named. If something is left unexplained, only those are named that fit nearly word for word: most
    of the time it is a mistake that is not in the list.
    """
    left, made = set(failed), dict[int, float]()
    while left:
        scores = {number: _score(failed, left, blocked, one) for number, one in enumerate(signatures)}
        best = max(scores, key=lambda number: scores[number], default=None)
        if best is None or not scores[best][0] or _has_rival(best, scores, signatures):
            break
        made[best] = scores[best][1]
        left -= signatures[best].failures.keys()
    return [number for number, fit in made.items() if not left or _stands_alone(signatures[number], fit)]


def _has_rival(best: int, scores: Mapping[int, tuple[float, float]], signatures: Sequence[Signature]) -> bool:
    """Return whether another signature explains some of the same checks, and fits as well on the whole."""
    checks = signatures[best].failures.keys()
    equal = [number for number, score in scores.items() if score == scores[best] and number != best]
    return any(checks & signatures[number].failures.keys() for number in equal)


def _stands_alone(signature: Signature, fit: float) -> bool:
    """Return whether a signature may be named although other failures remain unexplained."""
    failures = signature.failures.values()
    return fit >= FITS_AMONG_OTHERS and (len(failures) > 1 or any(failure.telling for failure in failures))


def _score(
    failed: Mapping[str, Failure], left: Set[str], blocked: Set[str], signature: Signature
) -> tuple[float, float]:
    """Return how much of what is `left` a signature explains, and how well it fits on average; zeros if it doesn't.

    A blocked check counts neither for nor against it. Nor does one that another mistake explains, unless that is so
    for most of the signature's checks.
    """
    judged = [name for name in signature.failures if name not in blocked and (name in left or name not in failed)]
    if not judged or 2 * len(judged) < len(signature.failures):
        return 0.0, 0.0
    fits = [_fit(failed.get(name), signature.failures[name]) for name in judged]
    average = sum(fits) / len(fits)
    return (sum(fits), average) if average >= FITS else (0.0, 0.0)


def _fit(failure: Failure | None, known: Failure) -> float:
    if failure is None or failure.kind != known.kind:
        return 0.0
    if failure.text == known.text:
        return SAME if known.telling or known.exact else SAME_WORDS
    return SAME_KIND if known.telling else OTHER_VALUE
