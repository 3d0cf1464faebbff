"""The rules of a task: parts of task.md that have an id, in a comment that students never see.

    3. **The frame** is `torso` in every beat. <!-- rule: frame -->

A rule is the text before the comment: from the beginning of its paragraph, list item or table row, or from the rule
before it there.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass

_MARK = re.compile(r"<!-- rule: (.*?) -->")
_COMMENT = re.compile(r"<!--.*?-->", re.DOTALL)

#: Where a paragraph, a list item or a table row begins.
_BLOCK = re.compile(r"\n\s*\n|\n(?=\s*(?:[-*+]|\d+[.)])\s|\s*\|)")


@dataclass(frozen=True)
class Rule:
    """One rule: its `id`, its text without markup, and its line in task.md, counted from 1."""

    id: str
    text: str
    line: int


def rules_of(task: str) -> tuple[Rule, ...]:
    """Return the rules that `task`, the text of task.md, marks, in their order."""
    return tuple(_rules(task))


def ids_used_twice(rules: tuple[Rule, ...]) -> list[Rule]:
    """Return the later ones of rules that have the same id."""
    seen: Counter[str] = Counter()
    twice = []
    for rule in rules:
        seen[rule.id] += 1
        twice += [rule] if seen[rule.id] > 1 else []
    return twice


def named_by(name: str, rules: tuple[Rule, ...]) -> tuple[str, ...]:
    """Return the ids of the rules that `name` names: by an id, by words of a rule, or by the words of several."""
    if any(rule.id == name for rule in rules):
        return (name,)
    words = without_markup(name)
    inside = tuple(rule.id for rule in rules if words in rule.text)
    return inside or tuple(rule.id for rule in rules if rule.text in words)


def without_markup(text: str) -> str:
    """Return a text of task.md without comments and Markdown markup, with whitespace reduced to single spaces."""
    return " ".join(re.sub(r"[*`]", "", _COMMENT.sub("", text)).split())


def _rules(task: str) -> Iterator[Rule]:
    before = 0
    for mark in _MARK.finditer(task):
        begin = max([before, *(block.end() for block in _BLOCK.finditer(task, before, mark.start()))])
        yield Rule(mark[1].strip(), without_markup(task[begin : mark.start()]), task.count("\n", 0, mark.start()) + 1)
        before = mark.end()
