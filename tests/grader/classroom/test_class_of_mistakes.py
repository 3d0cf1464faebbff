"""A class in which every mistake of every exercise is made once: which names each submission gets.

The findings are recorded ones: `record_findings.py` graded each mistake.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from pathlib import Path

import pytest
from recorded_findings import Recorded, read
from unlisted_mistakes import UNLISTED

from grader.classroom.misconceptions import Signature, mistakes_in
from grader.exercise import load
from grader.exercise.mistakes import mistakes_of

ROOT = Path(__file__).parents[3]
EXERCISES = sorted(UNLISTED)

#: Listed mistakes that other listed ones describe, too: if the first were not listed, the others would be true of it.
AKIN = {
    "again_and_again": {"volatile", "waits_for_a_subscriber", "latched_and_again"},
    "awaits_in_the_default_group": {"call_in_the_callback", "spins_in_the_callback"},
    "call_in_the_callback": {"awaits_in_the_default_group"},
    "drops_without_a_server": {"counts_only_what_was_asked", "asks_without_a_server"},
    "only_one_goal_ever": {"only_the_first_goal"},
    "single_threaded": {"no_feedback"},
    "spins_in_the_callback": {"awaits_in_the_default_group"},
}


def listed(exercise: str) -> list[Recorded]:
    """Return the exercise's usual mistakes that completed and failed checks."""
    names = {mistake.name for mistake in mistakes_of(load(ROOT / "exercises" / exercise))}
    return [one for one in read(exercise) if one.name in names and one.failures]


def signatures_of(mistakes: Sequence[Recorded]) -> list[Signature]:
    """Return one signature for all that fail in the same words."""
    found: list[Signature] = []
    for one in mistakes:
        same = next((signature for signature in found if signature.failures == one.failures), None)
        if same:
            found[found.index(same)] = dataclasses.replace(same, names=(*same.names, one.name))
        else:
            found.append(Signature((one.name,), (one.name,), one.failures))
    return found


def named(one: Recorded, signatures: Sequence[Signature]) -> list[set[str]]:
    """Return the names of each signature that a submission matches."""
    return [set(signatures[i].names) for i in mistakes_in(one.failures, set(one.blocked), signatures)]


@pytest.mark.parametrize("exercise", EXERCISES)
def test_every_listed_mistake_stands_under_its_own_name_alone(exercise: str) -> None:
    signatures = signatures_of(listed(exercise))
    assert len(signatures) >= 10
    for one in listed(exercise):
        (names,) = named(one, signatures)
        assert one.name in names


@pytest.mark.parametrize("exercise", EXERCISES)
def test_a_mistake_that_is_not_listed_never_stands_under_the_name_of_another(exercise: str) -> None:
    mistakes = listed(exercise)
    for one in mistakes:
        others = signatures_of([other for other in mistakes if other.failures != one.failures])
        for names in named(one, others):
            assert names & AKIN.get(one.name, set()), f"{one.name} stands under {names}"


@pytest.mark.parametrize("exercise", EXERCISES)
def test_other_programs_stand_under_mistakes_that_they_make_or_under_other(exercise: str) -> None:
    signatures = signatures_of(listed(exercise))
    for one in read(exercise):
        if mistake := UNLISTED[exercise].get(one.name):
            for names in named(one, signatures):
                assert names & set(mistake.may_be_called), f"{one.name} stands under {names}"


def test_most_of_them_that_make_a_listed_mistake_stand_under_its_name() -> None:
    wanted = found = 0
    for exercise in EXERCISES:
        signatures = signatures_of(listed(exercise))
        for one in read(exercise):
            mistake = UNLISTED[exercise].get(one.name)
            if mistake and mistake.may_be_called and one.failures:
                wanted += 1
                found += bool(named(one, signatures))
    assert found / wanted >= 0.5, f"{found} of {wanted}"
