"""What is behind a failure, as far as a recording shows it."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Cause:
    """The cause of a failure in three steps: what was `seen`, where to look (`where`), and what to do (`todo`).

    The student reads the first step at once, and the others on request. They replace a check's own hints, which may not
    fit this cause. `seen` is empty if the finding itself says it. A cause that is false has nothing to say.
    """

    seen: str = ""
    where: str = ""
    todo: str = ""

    def __bool__(self) -> bool:
        return bool(self.seen or self.where)


#: Nothing is known.
UNKNOWN = Cause()


def as_cause(text: str | Cause) -> Cause:
    """Return a sentence about what was seen as a cause."""
    return text if isinstance(text, Cause) else Cause(text.strip())
