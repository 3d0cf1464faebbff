"""The signatures of an exercise's usual mistakes, as `solutions/` lists them: each is graded once, and stored.

It is graded by the checks that it names, as an audit reports a mistake that fails others.
"""

from __future__ import annotations

import dataclasses
import hashlib
import json
from collections.abc import Callable, Sequence, Set
from concurrent.futures import ThreadPoolExecutor
from functools import cached_property

from grader.checking.verdict import ListedCheck, with_dependencies
from grader.classroom.misconceptions import Failure, Signature, blocked_in, failures_of, may_explain
from grader.exercise.mistakes import Mistake, mistakes_of
from grader.grading.grade import Grade
from grader.grading.grading import Grading
from grader.grading.reference import cache_folder, reference_key
from grader.submission.reader import of_mistake
from grader.workers.jobs import ListJob
from groundwork.files import keep, read_kept

#: How many mistakes are graded at once. Each grading already runs several scenarios at once.
AT_ONCE = 2


def signatures(
    grading: Grading, grades: Sequence[Grade], announce: Callable[[str], object] = lambda text: None
) -> tuple[Signature, ...]:
    """Return the signatures of those of the exercise's usual mistakes that may explain one of these grades, by name.

    A mistake is graded again if anything that its grade depends on has changed, which `announce` is told before.
    Mistakes that fail the same checks with the same findings are one signature. A mistake that fails no check, or does
    not complete, is left out.
    """
    students = [(failures_of(grade).keys(), blocked_in(grade)) for grade in grades]
    mistakes = [mistake for mistake in mistakes_of(grading.runner.exercise) if _may_explain(mistake, students)]
    known = _Mistakes(grading, announce)
    with ThreadPoolExecutor(AT_ONCE) as pool:
        failures = list(pool.map(known.failures, mistakes))
    alike: dict[tuple[tuple[str, Failure], ...], list[Mistake]] = {}
    for mistake, failed in zip(mistakes, failures, strict=True):
        if failed:
            alike.setdefault(tuple(failed.items()), []).append(mistake)
    return tuple(
        Signature(tuple(mistake.name for mistake in same), tuple(mistake.summary for mistake in same), dict(failed))
        for failed, same in alike.items()
    )


def _may_explain(mistake: Mistake, students: Sequence[tuple[Set[str], Set[str]]]) -> bool:
    """Return whether a mistake may explain what a student fails; one that names no checks may explain anything."""
    named = set(mistake.caught_by)
    return not named or any(may_explain(named, failed, blocked) for failed, blocked in students)


class _Mistakes:
    def __init__(self, grading: Grading, announce: Callable[[str], object]) -> None:
        self._grading, self._runner, self._announce = grading, grading.runner, announce
        self._key = reference_key(grading.runner)

    def failures(self, mistake: Mistake) -> dict[str, Failure]:
        """Return how a mistake fails, stored or found out now."""
        digest = hashlib.sha256(f"{self._key}{mistake.caught_by}{mistake.source}".encode()).hexdigest()
        file = f"{self._runner.exercise.name}-{mistake.name}-{digest[:24]}.json"
        kept = cache_folder().parent / "mistakes" / file
        stored = read_kept(
            kept, lambda content: {name: Failure(**failure) for name, failure in json.loads(content).items()}
        )
        if stored is not None:
            return stored
        self._announce(f"Grading a usual mistake, once: {mistake.name}.")
        grade = self._grade(mistake)
        failures = failures_of(grade)
        if grade.has_score:
            entries = {name: dataclasses.asdict(failure) for name, failure in failures.items()}
            keep(kept, json.dumps(entries), durable=True)
        return failures

    def _grade(self, mistake: Mistake) -> Grade:
        runner = dataclasses.replace(self._runner, needed=self._needed(mistake), partly=True)
        return dataclasses.replace(self._grading, runner=runner).grade(of_mistake(mistake, runner.exercise))

    def _needed(self, mistake: Mistake) -> frozenset[str]:
        """Return the scenarios of the checks that a mistake names; none, for all, if it names none or others."""
        names = with_dependencies(mistake.caught_by, self._checks)
        known = names.issuperset(mistake.caught_by)
        return frozenset(name for check in self._checks if known and check.name in names for name in check.scenarios)

    @cached_property
    def _checks(self) -> tuple[ListedCheck, ...]:
        checks: tuple[ListedCheck, ...] = self._runner.workers.do(ListJob(self._runner.exercise))
        return checks
