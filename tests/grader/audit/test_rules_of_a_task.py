"""An audit shows rule by rule which mistakes break it, what catches them, and what they cost."""

from __future__ import annotations

from pathlib import Path

import pytest
from quiet_audit import Auditing
from small_exercise import SmallExercise

from grader.audit.report import write_markdown
from grader.audit.result import Audit
from grader.exercise.rules import named_by, rules_of

TASK = "exercises/doubler/task.md"
CHECKS = "exercises/doubler/checks.py"
HIDDEN = "exercises/doubler/hidden_checks.py"
MISTAKES = "solutions/doubler/mistakes.md"

MARKED = """# Twice each number

Write the class `Doubler`. It hears `/numbers` and publishes twice each number on
`/doubled`, <!-- rule: twice --> once. <!-- rule: once -->

- **Say nothing to a number below zero.** Zero counts as positive. <!-- rule: sign -->
- Publish nothing on `/numbers` or `/clock`. <!-- rule: topics -->
- Your node is called `doubler`, and ends on Ctrl-C.
"""


@pytest.fixture
def marked(small: SmallExercise) -> SmallExercise:
    """The small exercise with four rules, two of which two mistakes break."""
    (small.course / TASK).write_text(MARKED, encoding="utf-8")
    for old, new in (
        ('points=2, hint="Call publish() in the callback."', 'points=2, hint="Call publish().", rule="twice"'),
        ('hint="Multiply.", depends', 'hint="Multiply.", rule=["twice"], partial=True, depends'),
        ('hint="One publish().", depends', 'hint="One publish().", rule="once", depends'),
    ):
        small.change(CHECKS, old, new)
    small.change(
        MISTAKES, "It publishes nothing.\n", "It publishes nothing.\n\nBreaks: twice\n\nCosts more: it is silent.\n"
    )
    small.change(MISTAKES, "It adds two.\n", "It adds two.\n\nBreaks: “twice each number”\n")
    small.change(MISTAKES, "It doubles negative numbers, too.\n", "It doubles negative numbers, too.\n\nBreaks: sign\n")
    return small


def advice(result: Audit, about: str) -> list[str]:
    """Return what the audit found about a rule, a mistake or a baseline."""
    return [problem.problem for problem in result.problems if problem.about == about]


def fully(audited: Auditing, small: SmallExercise) -> Audit:
    """Return a full audit without mutants."""
    return audited(small, quick=False, seeds=1)


def test_a_rule_is_the_text_before_its_comment() -> None:
    rules = rules_of(MARKED)
    assert [(rule.id, rule.line) for rule in rules] == [("twice", 4), ("once", 4), ("sign", 6), ("topics", 7)]
    assert rules[1].text == "once."
    assert rules[2].text == "- Say nothing to a number below zero. Zero counts as positive."
    row = rules_of("| a | b |\n| --- | --- |\n| `x` | first <!-- rule: x --> |\n| `y` | second <!-- rule: y --> |\n")
    assert [rule.text for rule in row] == ["| x | first", "| y | second"]


def test_a_rule_is_named_by_its_id_or_by_words() -> None:
    rules = rules_of(MARKED)
    assert named_by("sign", rules) == ("sign",)
    assert named_by("Zero counts\nas positive", rules) == ("sign",)
    assert named_by("Publish nothing on `/clock`", rules) == ()


def test_each_rule_has_its_points_and_what_breaks_it_costs(
    marked: SmallExercise, audited: Auditing, tmp_path: Path
) -> None:
    audit = fully(audited, marked)
    rules = {rule.id: rule for rule in audit.rules}
    assert (rules["twice"].points, rules["twice"].checks) == (5, ("test_publishes", "test_twice_the_number"))
    assert [mistake.name for mistake in rules["twice"].mistakes] == ["adds_two", "says_nothing"]
    adds_two, says_nothing = rules["twice"].mistakes
    assert adds_two.caught_by == ("test_twice_the_number",)
    # One of its four numbers is 2, so half of them or fewer are right, and the sign can't be judged.
    assert (adds_two.lost, adds_two.score) == (4, 6)
    assert (says_nothing.lost, says_nothing.costs_more) == (10, "it is silent.")

    write_markdown([audit], tmp_path / "rules.md")
    rows = [[cell.strip() for cell in line.split(" | ")] for line in (tmp_path / "rules.md").read_text().split("\n")]
    number = rows.index(["| **twice**: " + rules["twice"].text, "5", "adds_two", "4", "test_twice_the_number |"])
    assert rows[number + 1][2:4] == ["says_nothing", "10*"]


def test_rules_that_nobody_checks_or_breaks_twice(marked: SmallExercise, audited: Auditing) -> None:
    small = marked
    small.change(HIDDEN, 'rule="Publish nothing on /numbers or /clock."', 'rule="sign"')
    result = fully(audited, small)
    assert any("no check is based on the rule topics" in text for text in advice(result, "topics"))
    assert any("1 of the mistakes in mistakes.md break the rule once" in text for text in advice(result, "once"))
    assert advice(result, "twice") == []
    assert any("names no rule of the task" in text for text in advice(result, "no_end"))


def test_a_mistake_that_costs_much_more_than_its_rule(marked: SmallExercise, audited: Auditing) -> None:
    marked.change(MISTAKES, "It adds two.\n", "It adds two.\n\nCosts more: no number is right.\n")
    for hint in ("Look at the name in __init__.", "Catch what Ctrl-C raises."):
        marked.change(CHECKS, f'hint="{hint}", depends=[test_publishes]', f'hint="{hint}", depends=[test_once]')
    result = fully(audited, marked)
    assert advice(result, "twice") == [
        "the mistake mistakes/twice (“It says it twice.”) costs 3 points, more than 2 times the 1 of its rules"
    ]
    assert advice(result, "says_nothing") == [], "its reason is written"
    reason = "the mistake mistakes/adds_two (“It adds two.”) has a reason to cost more than 2 times the 5 of its rules"
    assert advice(result, "adds_two") == [f"{reason}, and costs 4 points"]


def test_programs_without_any_work_must_get_little(marked: SmallExercise, audited: Auditing) -> None:
    result = fully(audited, marked)
    scores = {program.name: program.score for program in result.programs if program.kind == "baseline"}
    assert set(scores) == {"echo", "zeros", "a constant", "random values"}
    assert scores["echo"] == 6, "it answers once, has the right name and topics, and ends on Ctrl-C"
    assert advice(result, "echo") == ["echo gets 6 of 10 points, more than 15%"]


def test_an_id_that_is_used_twice(marked: SmallExercise, audited: Auditing) -> None:
    marked.change(TASK, "rule: topics", "rule: sign")
    assert advice(fully(audited, marked), "sign")[0] == "there are two rules with the id sign"
