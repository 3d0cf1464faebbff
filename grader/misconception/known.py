"""The signatures of an exercise's known mistakes: each is graded once, then its signature is kept."""

from __future__ import annotations

import ast
import contextlib
import dataclasses
import hashlib
import json
import re
from collections.abc import Sequence, Set
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from grader.classroom.writing import write
from grader.grading.grading import Grading
from grader.grading.reference import cache_folder, key_of
from grader.misconception.signature import Failure, Signature, failures_of
from grader.submission.reading import of_source

#: Gradings at once. Each has several spins at once already.
AT_ONCE = 2

#: A check that a mistake's docstring names, under "Caught by:".
NAMED = re.compile(r"^- (test_\w+)\s*$", re.MULTILINE)


def signatures(grading: Grading, failing: Sequence[Set[str]] | None = None) -> tuple[Signature, ...]:
    """The signatures of the exercise's `solutions/NAME/mistakes/*.py`, in the order of their names.

    `failing` has the checks that each student fails: mistakes that explain none of these, by the checks that they name,
    are left out without being graded. Without it, all are looked at.

    A mistake is graded when anything that its grade depends on has changed since it was last. Mistakes that fail the
    same checks with the same words are one signature; one that fails no check, or does not come through, is none.
    """
    folder = grading.spinner.exercise.solution_folder
    files = sorted((folder / "mistakes").glob("*.py")) if folder else []
    if failing is not None:
        files = [file for file in files if _may_explain(file, failing)]
    with ThreadPoolExecutor(AT_ONCE) as pool:
        failures = list(pool.map(lambda file: _failures(file, grading), files))
    found: list[Signature] = []
    for file, failed in zip(files, failures, strict=True):
        if failed:
            same = next((one for one in found if one.failures == failed), None)
            alone = Signature((file.stem,), (_sentence(file),), failed)
            if same:
                found[found.index(same)] = dataclasses.replace(
                    same, names=same.names + alone.names, sentences=same.sentences + alone.sentences
                )
            else:
                found.append(alone)
    return tuple(found)


def _may_explain(file: Path, failing: Sequence[Set[str]]) -> bool:
    """Whether a student fails half of the checks that the file names, without which no signature fits."""
    named = set(NAMED.findall(_header(file)))
    return not named or any(2 * len(named & failed) >= len(named) for failed in failing)


def _failures(file: Path, grading: Grading) -> dict[str, Failure]:
    code = file.read_bytes()
    exercise = grading.spinner.exercise
    digest = hashlib.sha256(key_of(grading.spinner).encode() + code).hexdigest()
    kept = cache_folder().parent / "mistakes" / f"{exercise.name}-{file.stem}-{digest[:24]}.json"
    try:
        entries = json.loads(kept.read_text(encoding="utf-8"))
        return {name: Failure(**failure) for name, failure in entries.items()}
    except (OSError, ValueError, TypeError, AttributeError):
        pass
    grade = grading.grade(of_source(file.name, code, exercise))
    failures = failures_of(grade)
    if grade.outcome != "host-error":
        with contextlib.suppress(OSError):  # where nothing can be kept, it is graded anew each time
            write(kept, json.dumps({name: dataclasses.asdict(failure) for name, failure in failures.items()}))
    return failures


def _sentence(file: Path) -> str:
    """The first line of the file's docstring, else its name in words."""
    return next(iter(_header(file).splitlines()), file.stem.replace("_", " "))


def _header(file: Path) -> str:
    with contextlib.suppress(SyntaxError, ValueError):
        return ast.get_docstring(ast.parse(file.read_text(encoding="utf-8", errors="replace"))) or ""
    return ""
