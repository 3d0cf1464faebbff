"""An audit shows an author what is weak in an exercise, check by check."""

from __future__ import annotations

import re

import pytest
from quiet_audit import Auditing
from removing import remove_check
from small_exercise import SmallExercise, written

from grader.audit.result import Audit

CHECKS = "exercises/doubler/checks.py"
HIDDEN = "exercises/doubler/hidden_checks.py"


def advice(result: Audit, about: str) -> list[str]:
    """Return what the audit found about a check, a mistake or a mutant."""
    return [problem.problem for problem in result.problems if problem.about == about]


def test_a_weak_copy_is_reported_check_by_check(small: SmallExercise, audited: Auditing) -> None:
    removed = {
        (CHECKS, "test_once"): "mistakes/twice",
        (CHECKS, "test_ends_on_ctrl_c"): "mistakes/no_end",
        (HIDDEN, "test_nothing_below_zero"): "mistakes/any_number",
    }
    for file, check in removed:
        remove_check(small.course / file, check)
    small.change(
        CHECKS,
        '@check(points=1, hint="Look at the name',
        '@check(points=3, hint="It may be anything.", depends=[test_publishes])\n'
        "def test_any_answer(positive: Run) -> None:\n"
        '    """It is some answer."""\n'
        "    assert positive.received is not None, 'an answer was expected'\n\n\n"
        '@check(points=1, hint="Look at the name',
    )
    result = audited(small, quick=False, most=12)
    for (_, check), mistake in removed.items():
        assert any(mistake in found and "there is no such check" in found for found in advice(result, check)), check
    assert advice(result, "test_any_answer") == ["no mutant and no mistake fails test_any_answer: can it fail at all?"]
    survivors = [problem for problem in result.problems if problem.diff]
    assert survivors, "what the removed checks caught survives now"
    assert all("Is this a right solution? Then list it" in problem.fix for problem in survivors)
    assert any(re.search(r"^[-+] +self\.publisher", problem.diff, re.MULTILINE) for problem in survivors)


def test_a_right_solution_that_a_check_refuses_with_some_numbers_only(small: SmallExercise, audited: Auditing) -> None:
    small.change(
        HIDDEN,
        '    if any.publishers("/numbers") or',
        "    assert any.sent[0].data < 8, 'a number below 8 was expected'\n    if any.publishers(\"/numbers\") or",
    )
    result = audited(small, quick=False, seeds=6)
    assert (result.seeds, result.randomised) == (6, ("any",))
    found = advice(result, "test_leaves_other_topics_alone")
    assert found
    assert all(re.search(r"right solution solution\.py fails .* with --seed \d+", text) for text in found)


SPOILT = [
    (HIDDEN, 'rule="Publish nothing on /numbers or /clock."', "", "test_leaves_other_topics_alone",
     "does not name the sentence"),
    (HIDDEN, "Zero counts as positive", "Zero counts", "test_nothing_below_zero", "a sentence that is not in task.md"),
    (CHECKS, 'hint="Multiply."', 'hint="if message.data  >= 0:"', "test_twice_the_number", "hint of test_twice"),
    (HIDDEN, "It says nothing to a number below zero, and twice zero to zero.", "if message.data >= 0: it is doubled.",
     "test_nothing_below_zero", "title of test_nothing_below_zero"),
    (CHECKS, 'expected="/doubler", got=positive.nodes', "", "test_is_called_doubler", "not say what was expected"),
    ("solutions/doubler/mistakes.md", "Caught by: test_is_called_doubler", "", "mistakes/another_name",
     "names no check"),
]  # fmt: skip


@pytest.fixture(scope="module")
def spoilt(tmp_path_factory: pytest.TempPathFactory, audited: Auditing) -> Audit:
    """An audit of an exercise in which all of `SPOILT` and three more things are wrong."""
    small = written(tmp_path_factory.mktemp("spoilt"))
    small.change(CHECKS, "    positive.must_answer()", "    positive.must_answer()\n    positive.must_match('data')")
    small.change(HIDDEN, 'depends=["test_publishes"],\n       rule', "rule")
    # Only with the mistake any_number are there five answers to five numbers.
    small.change(HIDDEN, "    negative.must_be_silent()\n", "    [2, 0, 6][len(negative.received) - 1]\n")
    for file, old, new, _, _ in SPOILT:
        small.change(file, old, new)
    return audited(small)


def test_what_an_exercise_has_to_tell_and_what_it_may_not(spoilt: Audit) -> None:
    for _, _, _, about, words in SPOILT:
        assert any(words in found for found in advice(spoilt, about)), (about, words)


def test_a_mistake_that_fails_another_check_too(spoilt: Audit) -> None:
    (found,) = advice(spoilt, "test_once")
    assert "mistakes/adds_two (" in found
    assert "which it does not name" in found


def test_points_for_nothing(spoilt: Audit) -> None:
    found = [text for text in advice(spoilt, "test_leaves_other_topics_alone") if " passes" in text]
    assert [text.partition(" passes")[0] for text in found] == ["the starter", "a node that does nothing"]


def test_a_check_that_breaks_on_what_a_node_publishes(spoilt: Audit) -> None:
    problems = [problem for problem in spoilt.problems if "breaks on what" in problem.problem]
    assert [problem.about for problem in problems] == ["test_nothing_below_zero"]
    assert "mistakes/any_number" in problems[0].problem
    assert re.search(r"hidden_checks\.py:\d+: IndexError", problems[0].problem)


def test_two_checks_that_always_fail_together(small: SmallExercise, audited: Auditing) -> None:
    small.change(CHECKS, 'points=3, hint="Multiply', 'points=2, hint="Multiply')
    small.change(
        CHECKS,
        '@check(points=1, hint="One publish',
        '@check(points=1, hint="Twice is twice.", depends=[test_publishes])\n'
        "def test_double(positive: Run) -> None:\n"
        '    """It is the double."""\n'
        '    positive.must_match("data")\n\n\n'
        '@check(points=1, hint="One publish',
    )
    result = audited(small, quick=False, most=6)
    assert any("test_twice_the_number and test_double always fail together" in t for t in advice(result, "test_double"))


def test_what_is_known_is_not_tried_again(small: SmallExercise, audited: Auditing) -> None:
    first = audited(small, most=4)
    again = audited(small, most=4)
    assert (again.made, again.kept) == (0, first.made + first.kept)
    assert (again.problems, again.programs, again.mutants) == (first.problems, first.programs, first.mutants)
    small.change(CHECKS, "Multiply.", "Multiply it.")
    changed = audited(small, most=4)
    assert changed.made == again.kept, "another check judges everything again"
    assert [scenario.running_s for scenario in changed.scenarios] == [s.running_s for s in first.scenarios], (
        "and nothing is run again"
    )
