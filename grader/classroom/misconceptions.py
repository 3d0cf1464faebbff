"""Known mistakes, what each of them fails, and which submissions fail the same."""

from __future__ import annotations

import ast
import contextlib
import dataclasses
import hashlib
import json
import re
from collections.abc import Sequence, Set
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path

from grader.checking.verdict import Finding
from grader.files import write_if_changed
from grader.grading.entry import Entry
from grader.grading.grade import Grade
from grader.grading.grading import Grading
from grader.grading.reference import cache_folder, reference_key
from grader.submission.reading import of_source


@dataclass(frozen=True)
class Failure:
    """How a check fails. `text` is the finding word for word, `kind` the same without what is each program's own."""

    text: str
    kind: str

    @property
    def bare(self) -> bool:
        """Whether `kind` says no more than that some value is not the expected one."""
        return bool(BARE.fullmatch(self.kind))


@dataclass(frozen=True)
class Signature:
    """One or several known mistakes that nothing tells apart.

    `names` are their files' names, `sentences` the first lines of their docstrings. `failures` are the checks that
    they fail, by name; what is blocked by these does not count.
    """

    names: tuple[str, ...]
    sentences: tuple[str, ...]
    failures: dict[str, Failure]

    @property
    def sentence(self) -> str:
        """What the mistake is, in words."""
        return " Or: ".join(self.sentences)


#: "Message 3 of 16 (0.30 s after the start; one in three messages is lost), left_elbow: ", or what stands before a
#: finding that is about no message of ours: "At 2.00 s (a goal, canceled), goal 1 for /count (order 3): "
WHERE = re.compile(r"^(Message \d+ of \d+|At [\d.]+ s|Before the start) \([^)]*\)(, [^:]*)?: |^In “[^”]*”(, [^:]*)?: ")
ENDED = re.compile(r"\b([A-Z]\w*(?:Error|Exception|Interrupt))\b.* in line \d+")
BARE = re.compile(r"expected \S+ ⟨expected⟩( \S+)?, got ⟨got⟩( \S+)?\.|no \S+ was expected, got ⟨got⟩\.")


def failures_of(grade: Grade) -> dict[str, Failure]:
    """The checks that a graded submission fails, and how; empty for one that did not come through."""
    if grade.outcome != "graded":
        return {}
    failed = [verdict for verdict in grade.verdicts if verdict.status == "failed" and verdict.finding]
    return {verdict.name: failure_of(verdict.finding) for verdict in failed if verdict.finding}


def failure_of(finding: Finding) -> Failure:
    """The failure that a finding tells of.

    Its kind is the finding without the message and joint at which it was seen first, and without the values: "expected
    velocity ⟨expected⟩, got ⟨got⟩. Every value has the wrong sign." Of a run that ended by itself the
    exception is left.
    """
    if ended := ENDED.search(finding.text):
        return Failure(finding.text, f"ended by {ended[1]}")
    kind = WHERE.sub("", finding.text)
    for value, name in ((finding.expected, "expected"), (finding.got, "got")):
        if value:
            kind = re.sub(rf"(?<![\w.]){re.escape(value)}(?![\w.]\w)", f"⟨{name}⟩", kind, count=1)
    return Failure(finding.text, re.sub(r" \([^)]*\)", "", kind))


#: How well a submission's failure fits a signature's: the same words, the same kind, another value where one was
#: expected, or only the same check.
SAME, SAME_KIND, ANOTHER_VALUE, SAME_CHECK = 1.0, 0.75, 0.5, 0.25

#: How well all of a signature's failures have to fit, on average. Less will do where the submission fails just those
#: checks, two at least.
FITS, FITS_ALL = 0.6, 0.5


@dataclass(frozen=True)
class Group:
    """Students whose submissions fail as a known mistake does."""

    signature: Signature
    entries: tuple[Entry, ...]


@dataclass(frozen=True)
class Misconceptions:
    """Groups, the largest first; and under `other` who fails checks in ways that no known mistake does."""

    groups: tuple[Group, ...]
    other: tuple[Entry, ...]

    def of(self, entry: Entry) -> tuple[Signature, ...]:
        """The known mistakes that a student makes."""
        return tuple(group.signature for group in self.groups if entry in group.entries)


def grouped(entries: Sequence[Entry], signatures: Sequence[Signature]) -> Misconceptions:
    """Group the graded submissions that fail checks by the known mistakes they make; one may make several."""
    found: dict[int, list[Entry]] = {}
    other: list[Entry] = []
    for entry in entries:
        failed = failures_of(entry.grade)
        made = _mistakes(failed, signatures)
        for number in made:
            found.setdefault(number, []).append(entry)
        if failed and not made:
            other.append(entry)
    groups = [Group(signatures[number], tuple(members)) for number, members in sorted(found.items())]
    return Misconceptions(tuple(sorted(groups, key=lambda group: -len(group.entries))), tuple(other))


def _mistakes(failed: dict[str, Failure], signatures: Sequence[Signature]) -> list[int]:
    """Numbers of the signatures that explain `failed`.

    The one that explains most comes first; then what it explains is set aside, and the rest is looked at again.
    """
    left, made = dict(failed), []
    while left:
        scores = {number: _score(left, signature) for number, signature in enumerate(signatures) if number not in made}
        best = max(scores, key=lambda number: scores[number], default=None)
        if best is None or scores[best] == 0:
            break
        made.append(best)
        for name in signatures[best].failures:
            left.pop(name, None)
    return made


def _score(failed: dict[str, Failure], signature: Signature) -> float:
    """How much of `failed` a signature explains, 0 where it does not fit."""
    fits = [_fit(failed.get(name), failure) for name, failure in signature.failures.items()]
    enough = FITS_ALL if len(fits) > 1 and failed.keys() == signature.failures.keys() else FITS
    return sum(fits) if sum(fits) / len(fits) >= enough else 0.0


def _fit(failure: Failure | None, known: Failure) -> float:
    if failure is None:
        return 0.0
    if failure.text == known.text:
        return SAME
    if failure.kind == known.kind:
        return ANOTHER_VALUE if known.bare else SAME_KIND
    return SAME_CHECK


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
    folder = grading.runner.exercise.solution_folder
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
    exercise = grading.runner.exercise
    digest = hashlib.sha256(reference_key(grading.runner).encode() + code).hexdigest()
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
            write_if_changed(
                kept,
                json.dumps({name: dataclasses.asdict(failure) for name, failure in failures.items()}),
                durable=True,
            )
    return failures


def _sentence(file: Path) -> str:
    """The first line of the file's docstring, else its name in words."""
    return next(iter(_header(file).splitlines()), file.stem.replace("_", " "))


def _header(file: Path) -> str:
    with contextlib.suppress(SyntaxError, ValueError):
        return ast.get_docstring(ast.parse(file.read_text(encoding="utf-8", errors="replace"))) or ""
    return ""
