"""Names a topic that a student has probably misspelled."""

from __future__ import annotations

import difflib
import re
from collections.abc import Collection
from dataclasses import replace

from grader.checking.verdict import Finding, Verdict

TOPIC = re.compile(r"(?<![\w/])/\w[\w/]*")

#: How alike two names have to be, as difflib counts: /joint_comands and /joint_commands are 0.97.
ALIKE = 0.8


def with_spelling(verdict: Verdict, topics: Collection[str], node: str) -> Verdict:
    """Add to a finding about topics which of the exercise's `topics` a name in it is probably meant to be.

    The name of its `node` may be like that of a topic, and is no slip.
    """
    finding = verdict.finding
    if finding is None or finding.message is not None:
        return verdict
    return replace(verdict, finding=_suggest(finding, topics, node))


def _suggest(finding: Finding, topics: Collection[str], node: str) -> Finding:
    for name in dict.fromkeys(TOPIC.findall(finding.text)):
        meant = [] if name in (*topics, node) else difflib.get_close_matches(name, topics, n=1, cutoff=ALIKE)
        if meant:
            return replace(finding, text=f"{finding.text} Is {name} a misspelling of {meant[0]}?")
    return finding
