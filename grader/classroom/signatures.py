"""The signatures of an exercise's usual mistakes, as `solutions/` lists them: each is graded once, and stored."""

from __future__ import annotations

import dataclasses
import hashlib
import json
from collections.abc import Sequence, Set
from concurrent.futures import ThreadPoolExecutor

from grader.classroom.misconceptions import Failure, Signature, blocked_in, failures_of, may_explain
from grader.exercise.mistakes import Mistake, mistakes_of
from grader.grading.grade import Grade
from grader.grading.grading import Grading
from grader.grading.reference import cache_folder, reference_key
from grader.submission.reader import of_mistake
from groundwork.files import keep, read_kept

#: How many mistakes are graded at once. Each grading already runs several scenarios at once.
AT_ONCE = 2


def signatures(grading: Grading, grades: Sequence[Grade]) -> tuple[Signature, ...]:
    """Return the signatures of those of the exercise's usual mistakes that may explain one of these grades, by name.

    A mistake is graded again if anything that its grade depends on has changed. Mistakes that fail the same checks
    with the same findings are one signature. A mistake that fails no check, or does not complete, is left out.
    """
    students = [(failures_of(grade).keys(), blocked_in(grade)) for grade in grades]
    mistakes = [mistake for mistake in mistakes_of(grading.runner.exercise) if _may_explain(mistake, students)]
    with ThreadPoolExecutor(AT_ONCE) as pool:
        failures = list(pool.map(lambda mistake: _failures(mistake, grading), mistakes))
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


def _failures(mistake: Mistake, grading: Grading) -> dict[str, Failure]:
    exercise = grading.runner.exercise
    digest = hashlib.sha256(f"{reference_key(grading.runner)}{mistake.source}".encode()).hexdigest()
    kept = cache_folder().parent / "mistakes" / f"{exercise.name}-{mistake.name}-{digest[:24]}.json"
    stored = read_kept(
        kept, lambda content: {name: Failure(**failure) for name, failure in json.loads(content).items()}
    )
    if stored is not None:
        return stored
    grade = grading.grade(of_mistake(mistake, exercise))
    failures = failures_of(grade)
    if grade.has_score:
        entries = {name: dataclasses.asdict(failure) for name, failure in failures.items()}
        keep(kept, json.dumps(entries), durable=True)
    return failures
