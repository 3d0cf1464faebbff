"""What a worker of a cluster does: it grades one submission, with everything made ready once in its process."""

from __future__ import annotations

import contextlib
import tempfile
import threading
from dataclasses import dataclass, replace
from pathlib import Path

from grader.crew import Crew
from grader.exercise import load
from grader.grading import Options, grading_of
from grader.grading.grading import Grading
from grader.grading.versions import versions
from grader.marking.cores import own_core
from grader.marking.fault import fault
from grader.marking.key import key_of
from grader.marking.marks import Marked
from grader.marking.parcel import Parcel
from grader.marking.picture import picture
from grader.sandbox import Middleware, choose_middleware
from grader.submission import Submission


@dataclass(frozen=True)
class Bench:
    """One exercise, ready to be graded in this process for as long as that lives. `holds` is closed after it."""

    grading: Grading
    key: str
    holds: contextlib.ExitStack


_ready: dict[str, Bench] = {}
_lock = threading.Lock()


def about(middleware: Middleware) -> dict[str, str]:
    """What grades depend on here, besides the exercise. Raises `MiddlewareUnavailable`."""
    return versions(choose_middleware(middleware).middleware)


def mark(parcel: Parcel, options: Options, key: str, who: str, submission: Submission) -> Marked:
    """One submission's grade, without recordings, and the picture of it.

    `key` is that of whoever asks: where grades would depend on something else here, there is none, and it is told.
    """
    bench = _bench(parcel, options)
    spinner = bench.grading.spinner
    if bench.key != key:
        told = f"a worker of the cluster grades otherwise than this machine: {versions(spinner.middleware)}"
        return Marked(who, fault(spinner, submission, told), None)
    with own_core() as core:
        spinner = replace(spinner, options=replace(options, parallel=1, core=core))
        grade = replace(bench.grading, spinner=spinner).grade(submission)
    return Marked(who, replace(grade, recordings={}, references={}), picture(grade, spinner.exercise))


def _bench(parcel: Parcel, options: Options) -> Bench:
    """Made ready by whichever task comes first, for all that follow; only the newest exercise is kept."""
    name = f"{parcel.digest} {options}"
    with _lock:
        if name not in _ready:
            while _ready:
                _ready.popitem()[1].holds.close()
            with contextlib.ExitStack() as holds:
                folder = holds.enter_context(tempfile.TemporaryDirectory(prefix="spinbook-exercise-"))
                crew = holds.enter_context(Crew(options.middleware))
                grading = grading_of(load(parcel.unpack(Path(folder))), options, crew)
                _ready[name] = Bench(grading, key_of(grading), holds.pop_all())
        return _ready[name]
