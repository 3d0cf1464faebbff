"""A submission as plain data."""

from __future__ import annotations

from dataclasses import dataclass

from grader.sandbox import Program


@dataclass(frozen=True)
class Submission:
    """One submission, read.

    `digest` is the SHA-256 of what was handed in. `program` says how it is started, and is None where it can't be;
    then `problem` tells the student why. `source` is its text, to quote lines from. `warning` tells the instructor what
    is odd about it, such as an upload that was changed; it costs no points.
    """

    name: str
    digest: str
    file_name: str
    source: str
    program: Program | None
    problem: str = ""
    warning: str = ""
