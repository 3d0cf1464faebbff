"""A class in which every mistake in an exercise is made once: which names each submission gets.

Only `make soak` grades them: that takes about a second of CPU time per mistake. What is compared, such as values, is
tested without grading in test_misconception.py.
"""

from __future__ import annotations

import dataclasses
import functools
from collections.abc import Callable, Mapping
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest
from unlisted_mistakes import UNLISTED

from grader.classroom.misconceptions import Signature, failures_of, mistakes_in
from grader.classroom.signatures import signatures as signatures_for
from grader.exercise import load
from grader.exercise.mistakes import mistakes_of
from grader.grading import Grade, Options, grading_of
from grader.submission.reader import of_source
from grader.workers import WorkerPool

ROOT = Path(__file__).parents[3]
EXERCISES = sorted(UNLISTED)

pytestmark = [pytest.mark.soak, pytest.mark.timeout(900)]

#: Listed mistakes that other listed ones describe, too: if the first were not listed, the others would be true of it.
AKIN = {
    "a_publisher_on_urdf": {"publishes_its_state"},
    "a_publisher_per_text": {"two_publishers"},
    "again_and_again": {"volatile", "waits_for_a_subscriber", "latched_and_again"},
    "another_name": {"namespace"},
    "awaits_in_the_default_group": {"call_in_the_callback", "spins_in_the_callback"},
    "best_effort": {"volatile", "waits_for_a_subscriber"},
    "call_in_the_callback": {"awaits_in_the_default_group"},
    "drops_without_a_server": {"counts_only_what_was_asked", "asks_without_a_server"},
    "namespace": {"another_name"},
    "only_one_goal_ever": {"only_the_first_goal"},
    "publishes_its_state": {"a_publisher_on_urdf"},
    "single_threaded": {"no_feedback"},
    "spins_in_the_callback": {"awaits_in_the_default_group"},
    "volatile": {"best_effort"},
    "waits_for_a_subscriber": {"best_effort"},
}

#: Grade by the mistake's name.
Grades = Mapping[str, Grade]


@dataclasses.dataclass(frozen=True)
class Mistakes:
    """The mistakes in an exercise: those that `solutions/` lists, as far as they fail checks, and the others."""

    listed: Grades
    unlisted: Grades


@pytest.fixture(scope="module")
def mistakes(workers_with_interfaces: WorkerPool) -> Callable[[str], Mistakes]:
    """Grades the mistakes in an exercise, once."""
    return functools.cache(lambda exercise: _graded(exercise, workers_with_interfaces))


def _graded(name: str, workers: WorkerPool) -> Mistakes:
    exercise = load(ROOT / "exercises" / name)
    assert exercise.solution_file
    solution = exercise.solution_file.read_text(encoding="utf-8")
    listed = {mistake.name: mistake.source for mistake in mistakes_of(exercise)}
    unlisted = {unlisted: mistake.applied_to(solution) for unlisted, mistake in UNLISTED[name].items()}
    grading = grading_of(exercise, Options(), workers)
    with ThreadPoolExecutor(2) as pool:
        submissions = [of_source(source, code.encode(), exercise) for source, code in (listed | unlisted).items()]
        grades = {grade.submission: grade for grade in pool.map(grading.grade, submissions)}
    return Mistakes(
        {mistake: grades[mistake] for mistake in listed if failures_of(grades[mistake])},
        {mistake: grades[mistake] for mistake in unlisted},
    )


def signatures_of(grades: Grades) -> list[Signature]:
    """Return one signature for all that fail in the same words."""
    signatures: list[Signature] = []
    for name, grade in grades.items():
        same = next((one for one in signatures if one.failures == failures_of(grade)), None)
        if same:
            signatures[signatures.index(same)] = dataclasses.replace(same, names=(*same.names, name))
        else:
            signatures.append(Signature((name,), (name,), failures_of(grade)))
    return signatures


def named(grade: Grade, signatures: list[Signature]) -> list[set[str]]:
    """Return the names of each signature that a submission matches."""
    blocked = {verdict.name for verdict in grade.verdicts if verdict.status == "blocked"}
    return [set(signatures[i].names) for i in mistakes_in(failures_of(grade), blocked, signatures)]


@pytest.mark.parametrize("exercise", EXERCISES)
def test_a_signature_from_few_scenarios_is_that_of_a_whole_grade(
    exercise: str, mistakes: Callable[[str], Mistakes], workers_with_interfaces: WorkerPool
) -> None:
    grades = mistakes(exercise).listed
    grading = grading_of(load(ROOT / "exercises" / exercise), Options(), workers_with_interfaces)
    found = {name: one.failures for one in signatures_for(grading, list(grades.values())) for name in one.names}
    assert found == {name: failures_of(grade) for name, grade in grades.items()}


@pytest.mark.parametrize("exercise", EXERCISES)
def test_every_listed_mistake_stands_under_its_own_name_alone(
    exercise: str, mistakes: Callable[[str], Mistakes]
) -> None:
    listed = mistakes(exercise).listed
    signatures = signatures_of(listed)
    assert len(signatures) >= 10
    for name, grade in listed.items():
        (names,) = named(grade, signatures)
        assert name in names


@pytest.mark.parametrize("exercise", EXERCISES)
def test_a_mistake_that_is_not_listed_never_stands_under_the_name_of_another(
    exercise: str, mistakes: Callable[[str], Mistakes]
) -> None:
    listed = mistakes(exercise).listed
    for name, grade in listed.items():
        others = {other: one for other, one in listed.items() if failures_of(one) != failures_of(grade)}
        for names in named(grade, signatures_of(others)):
            assert names & AKIN.get(name, set()), f"{name} stands under {names}"


@pytest.mark.parametrize("exercise", EXERCISES)
def test_other_programs_stand_under_mistakes_that_they_make_or_under_other(
    exercise: str, mistakes: Callable[[str], Mistakes]
) -> None:
    signatures = signatures_of(mistakes(exercise).listed)
    for name, grade in mistakes(exercise).unlisted.items():
        for names in named(grade, signatures):
            assert names & set(UNLISTED[exercise][name].may_be_called), f"{name} stands under {names}"


def test_most_of_them_that_make_a_listed_mistake_stand_under_its_name(mistakes: Callable[[str], Mistakes]) -> None:
    stand = [
        bool(named(grade, signatures_of(mistakes(exercise).listed)))
        for exercise in EXERCISES
        for name, grade in mistakes(exercise).unlisted.items()
        if UNLISTED[exercise][name].may_be_called and failures_of(grade)
    ]
    assert sum(stand) / len(stand) >= 0.5, f"{sum(stand)} of {len(stand)}"
