"""The signatures of an exercise's usual mistakes, as `solutions/` lists them: each is graded once, and stored."""

from __future__ import annotations

import dataclasses
import hashlib
import json
from collections.abc import Sequence, Set
from concurrent.futures import ThreadPoolExecutor

from grader.classroom.misconceptions import Failure, Signature, failures_of
from grader.exercise.mistakes import Mistake, mistakes_of
from grader.grading.grading import Grading
from grader.grading.reference import cache_folder, reference_key
from grader.submission.reader import of_source
from groundwork.files import keep, read_kept

#: How many mistakes are graded at once. Each grading already runs several scenarios at once.
AT_ONCE = 2


def signatures(grading: Grading, failing: Sequence[Set[str]] | None = None) -> tuple[Signature, ...]:
    """Return the signatures of the exercise's usual mistakes, sorted by name.

    `failing` has the checks that each student fails: a mistake whose own checks explain none of these is left out
    without being graded. Without `failing`, all mistakes are graded.

    A mistake is graded again if anything that its grade depends on has changed. Mistakes that fail the same checks
    with the same findings are one signature. A mistake that fails no check, or does not complete, is left out.
    """
    mistakes = mistakes_of(grading.runner.exercise)
    if failing is not None:
        mistakes = tuple(mistake for mistake in mistakes if _may_explain(mistake, failing))
    with ThreadPoolExecutor(AT_ONCE) as pool:
        failures = list(pool.map(lambda mistake: _failures(mistake, grading), mistakes))
    found: list[Signature] = []
    for mistake, failed in zip(mistakes, failures, strict=True):
        if failed:
            same = next((one for one in found if one.failures == failed), None)
            alone = Signature((mistake.name,), (mistake.summary,), failed)
            if same:
                found[found.index(same)] = dataclasses.replace(
                    same, names=same.names + alone.names, sentences=same.sentences + alone.sentences
                )
            else:
                found.append(alone)
    return tuple(found)


def _may_explain(mistake: Mistake, failing: Sequence[Set[str]]) -> bool:
    """Return whether a student fails half of the checks that the mistake names; otherwise no signature fits."""
    named = set(mistake.caught_by)
    return not named or any(2 * len(named & failed) >= len(named) for failed in failing)


def _failures(mistake: Mistake, grading: Grading) -> dict[str, Failure]:
    code = mistake.source.encode()
    exercise = grading.runner.exercise
    digest = hashlib.sha256(reference_key(grading.runner).encode() + code).hexdigest()
    kept = cache_folder().parent / "mistakes" / f"{exercise.name}-{mistake.name}-{digest[:24]}.json"
    stored = read_kept(
        kept, lambda content: {name: Failure(**failure) for name, failure in json.loads(content).items()}
    )
    if stored is not None:
        return stored
    grade = grading.grade(of_source(f"{mistake.name}.py", code, exercise))
    failures = failures_of(grade)
    if grade.has_score:
        entries = {name: dataclasses.asdict(failure) for name, failure in failures.items()}
        keep(kept, json.dumps(entries), durable=True)
    return failures
