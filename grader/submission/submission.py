"""What was handed in, after it was read."""

from __future__ import annotations

from dataclasses import dataclass

from grader.sandbox.program import ProgramSpec


@dataclass(frozen=True)
class Submission:
    """One submission, read.

    `digest` is the SHA-256 of what was handed in. `program` says how it is started, and is None if it can't be; then
    `problem` tells the student why, or `question` asks the instructor for a decision: then there is no score.
    `source` is its text, to quote lines from. `warning` tells the instructor what is unusual about it, such as an
    upload that was changed; it costs no points. `notes` tell both which program was chosen. `newer_python` says that
    it was written with a newer Python, if it names one.
    """

    name: str
    digest: str
    file_name: str
    source: str
    program: ProgramSpec | None
    problem: str = ""
    warning: str = ""
    notes: tuple[str, ...] = ()
    question: str = ""
    newer_python: str = ""

    @property
    def sources(self) -> dict[str, str]:
        """The Python files of the program, by name."""
        files = self.program.files if self.program else {}
        return {name: data.decode("utf-8", errors="replace") for name, data in files.items() if name.endswith(".py")}
