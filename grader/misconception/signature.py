"""A mistake's signature: which checks it fails, and how."""

from __future__ import annotations

import re
from dataclasses import dataclass

from grader.checking.wrong import Finding
from grader.grading import Grade


@dataclass(frozen=True)
class Failure:
    """How a check fails. `text` is the finding word for word, `kind` the same without what is each program's own."""

    text: str
    kind: str

    @property
    def bare(self) -> bool:
        """Whether `kind` says no more than that some value is not the expected one."""
        return bool(BARE.fullmatch(self.kind))


@dataclass(frozen=True)
class Signature:
    """One or several known mistakes that nothing tells apart.

    `names` are their files' names, `sentences` the first lines of their docstrings. `failures` are the checks that
    they fail, by name; what is blocked by these does not count.
    """

    names: tuple[str, ...]
    sentences: tuple[str, ...]
    failures: dict[str, Failure]

    @property
    def sentence(self) -> str:
        """What the mistake is, in words."""
        return " Or: ".join(self.sentences)


#: "Message 3 of 16 (0.30 s after the start; one in three messages is lost), left_elbow: ", or what stands before a
#: finding that is about no message of ours: "At 2.00 s (a goal, canceled), goal 1 for /count (order 3): "
WHERE = re.compile(r"^(Message \d+ of \d+|At [\d.]+ s|Before the start) \([^)]*\)(, [^:]*)?: |^In “[^”]*”(, [^:]*)?: ")
ENDED = re.compile(r"\b([A-Z]\w*(?:Error|Exception|Interrupt))\b.* in line \d+")
BARE = re.compile(r"expected \S+ ⟨expected⟩( \S+)?, got ⟨got⟩( \S+)?\.|no \S+ was expected, got ⟨got⟩\.")


def failures_of(grade: Grade) -> dict[str, Failure]:
    """The checks that a graded submission fails, and how; empty for one that did not come through."""
    if grade.outcome != "graded":
        return {}
    failed = [verdict for verdict in grade.verdicts if verdict.status == "failed" and verdict.finding]
    return {verdict.name: failure_of(verdict.finding) for verdict in failed if verdict.finding}


def failure_of(finding: Finding) -> Failure:
    """The failure that a finding tells of.

    Its kind is the finding without the message and joint at which it was seen first, and without the values: "expected
    velocity ⟨expected⟩, got ⟨got⟩. Every value has the wrong sign." Of a run that ended by itself the
    exception is left.
    """
    if ended := ENDED.search(finding.text):
        return Failure(finding.text, f"ended by {ended[1]}")
    kind = WHERE.sub("", finding.text)
    for value, name in ((finding.expected, "expected"), (finding.got, "got")):
        if value:
            kind = re.sub(rf"(?<![\w.]){re.escape(value)}(?![\w.]\w)", f"⟨{name}⟩", kind, count=1)
    return Failure(finding.text, re.sub(r" \([^)]*\)", "", kind))
