"""What an instructor asks for."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from grader.grading import Options


@dataclass(frozen=True)
class Order:
    """A class to grade: where the submissions are, where the results go, and how.

    `jobs` is how many submissions are graded at once, None for as many as suit
    this machine. `regrade` names students whose submissions are graded again
    though nothing has changed, `*` all of them. `overrides` is a CSV file, `scheduler` a Dask scheduler's address.
    `rejudge` asks for new verdicts on stored recordings, and `replace` for keeping them unasked. `publish` asks for one
    zip per student.
    """

    source: Path
    out: Path
    options: Options
    jobs: int | None = None
    regrade: tuple[str, ...] = ()
    overrides: Path | None = None
    scheduler: str = ""
    rejudge: bool = False
    replace: bool = False
    publish: bool = False
