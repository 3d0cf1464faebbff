"""Students are grouped by the known mistakes that their failures match; the rest is in the group "other"."""

from __future__ import annotations

from itertools import combinations, product

import plain_grades as plain

from grader.checking.verdict import Finding, Verdict
from grader.classroom.misconceptions import Signature, failure_of, failures_of, grouped, may_explain, mistakes_in
from grader.grading.grade import Entry, Student


def finding(text: str, expected: str = "0.489 rad/s", got: str = "0.978 rad/s") -> Finding:
    return Finding(text, "lossy", 3, 0.3, "left_elbow", expected, got)


HALF_AS_LARGE = finding(
    "Message 3 of 16 (0.30 s after the start; one in three messages is lost), left_elbow: expected velocity "
    "0.489 rad/s, got 0.978 rad/s. All values are 2 times as large."
)
OTHER_JOINT = finding(
    "Message 7 of 16 (0.90 s after the start; one in three messages is lost), right_elbow: expected velocity "
    "0.1 rad/s, got 0.2 rad/s. All values are 2 times as large.",
    "0.1 rad/s",
    "0.2 rad/s",
)
BARE = finding("Message 3 of 16 (0.30 s), left_elbow: expected velocity 0.489 rad/s, got 0.978 rad/s.")
SILENT = Finding("Nothing came.", "lossy")


def entry(name: str, **failing: Finding) -> Entry:
    verdicts = [Verdict(check, check, "failed", 1.0, finding=found) for check, found in failing.items()]
    return plain.entry(plain.grade(plain.PUBLIC, *verdicts), Student(name))


def signature(name: str, **failing: Finding) -> Signature:
    return Signature((name,), (f"{name} in words.",), failures_of(entry(name, **failing).grade))


LOST = signature("fixed_dt", test_lost=HALF_AS_LARGE, test_gap=HALF_AS_LARGE)
MUTE = signature("mute", test_first=SILENT)


def groups(*entries: Entry) -> tuple[dict[str, list[str]], list[str]]:
    found = grouped(entries, [LOST, MUTE])
    members = {group.signature.names[0]: [entry.student.id for entry in group.entries] for group in found.groups}
    return members, [entry.student.id for entry in found.other]


def test_another_message_joint_and_number_is_the_same_mistake() -> None:
    assert failure_of(HALF_AS_LARGE).kind == failure_of(OTHER_JOINT).kind
    assert groups(entry("ada", test_lost=OTHER_JOINT, test_gap=OTHER_JOINT)) == ({"fixed_dt": ["ada"]}, [])


def test_another_moment_of_a_goal_is_the_same_mistake() -> None:
    message = "it was expected to end as canceled, got succeeded. Your node accepted the request to cancel."
    kinds = {
        failure_of(Finding(f"{where}: {message}", "cancelled", None, 2.0, "", "canceled", "succeeded")).kind
        for where in (
            "At 2.00 s (a goal, canceled), goal 1 for /count (order 3)",
            "At 4.50 s (two goals), goal 2 for /count (order 7)",
            "In “two goals”",
        )
    }
    assert len(kinds) == 1


def test_who_makes_two_mistakes_stands_under_both() -> None:
    both = entry("ada", test_lost=HALF_AS_LARGE, test_gap=HALF_AS_LARGE, test_first=SILENT)
    assert groups(both) == ({"fixed_dt": ["ada"], "mute": ["ada"]}, [])


def test_the_largest_group_comes_first() -> None:
    members, _ = groups(
        entry("a", test_lost=HALF_AS_LARGE, test_gap=HALF_AS_LARGE), *(entry(n, test_first=SILENT) for n in "bc")
    )
    assert list(members) == ["mute", "fixed_dt"]


def test_what_no_known_mistake_does_is_other() -> None:
    assert groups(entry("ada", test_new=HALF_AS_LARGE)) == ({}, ["ada"])


def test_the_same_check_failed_in_another_way_is_no_match() -> None:
    assert groups(entry("ada", test_first=BARE)) == ({}, ["ada"])


def test_who_fails_nothing_or_did_not_come_through_is_in_no_group() -> None:
    crashed = plain.entry(plain.CRASHED, Student("ben"))
    assert groups(entry("ada"), crashed) == ({}, [])


def test_two_mistakes_that_fail_alike_are_told_apart_or_neither_is_named() -> None:
    twins = [signature(name, test_first=SILENT) for name in ("mute", "deaf")]
    assert mistakes_in({"test_first": failure_of(SILENT)}, set(), twins) == []


def test_a_value_that_came_is_distinguished_from_another_one() -> None:
    mistake = signature("late", test_first=BARE)
    other = finding(
        "Message 3 of 16 (0.30 s), left_elbow: expected velocity 0.489 rad/s, got 0.611 rad/s.", got="0.611 rad/s"
    )
    assert mistakes_in({"test_first": failure_of(BARE)}, set(), [mistake]) == [0]
    assert mistakes_in({"test_first": failure_of(other)}, set(), [mistake]) == []


def test_what_only_half_explains_a_submission_is_not_named_on_one_comparison() -> None:
    failed = {"test_first": failure_of(BARE), "test_new": failure_of(SILENT)}
    assert mistakes_in(failed, set(), [signature("late", test_first=BARE)]) == []


def test_a_check_that_can_not_be_judged_speaks_for_nothing() -> None:
    both = signature("fixed_dt", test_lost=HALF_AS_LARGE, test_gap=HALF_AS_LARGE)
    failed = {"test_lost": failure_of(HALF_AS_LARGE)}
    assert mistakes_in(failed, {"test_gap"}, [both]) == [0]
    assert mistakes_in(failed, set(), [both]) == []


def test_numbers_and_guessed_names_are_no_part_of_a_kind() -> None:
    kinds = {
        failure_of(
            Finding(f"Your node does not publish on /a. It publishes on: {name}.{guess}", expected="/a", got=name)
        ).kind
        for name, guess in (("/b", ""), ("/aa", " Is /aa a misspelling of /a?"))
    }
    assert len(kinds) == 1


def test_a_mistake_that_is_not_a_candidate_is_never_named() -> None:
    """A mistake that can't explain anybody is not graded: each way in which three checks fail, pass or are blocked."""
    checks = {"test_a": HALF_AS_LARGE, "test_b": OTHER_JOINT, "test_c": SILENT}
    subsets = [frozenset(each) for size in range(4) for each in combinations(checks, size)]
    known = {names: signature("known", **{name: checks[name] for name in names}) for names in subsets if names}
    ways = [(failed, blocked) for failed in subsets for blocked in subsets if not failed & blocked]
    for (names, mistake), (failed, blocked) in product(known.items(), ways):
        if mistakes_in(failures_of(entry("ada", **{name: checks[name] for name in failed}).grade), blocked, [mistake]):
            assert may_explain(names, failed, blocked)
    assert not may_explain(frozenset(checks), frozenset({"test_a"}), frozenset())
    assert may_explain(frozenset(checks), frozenset({"test_a", "test_b"}), frozenset({"test_c"}))
