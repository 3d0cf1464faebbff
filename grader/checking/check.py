"""Marks a test function as a check."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, TypeVar

Test = TypeVar("Test", bound=Callable[..., None])

#: Where the mark is kept on the test function.
ATTRIBUTE = "__check__"


@dataclass(frozen=True)
class Mark:
    """What `check` says about a test function. `depends` are names of other checks, `rule` is a sentence of task.md."""

    points: float
    hint: str
    depends: tuple[str, ...]
    misconception: str
    rule: str = ""


def check(
    *,
    points: float,
    hint: str,
    depends: Sequence[Callable[..., Any] | str] = (),
    misconception: str = "",
    rule: str = "",
) -> Callable[[Test], Test]:
    """Make a test function a check that gives `points`; its docstring is the check's title.

    `hint` tells a student who failed it where to look. `depends` lists checks (functions of the same file, or names)
    without which this one can't be judged: it counts as blocked, not as failed, unless all of them passed.
    `misconception` names the usual mistake behind a failure, in two or three words. `rule` is the sentence of task.md
    on which the check stands, word for word: `spinbook audit` wants one for each hidden check, and looks for it there.
    """
    names = tuple(item if isinstance(item, str) else item.__name__ for item in depends)

    def mark(test: Test) -> Test:
        setattr(test, ATTRIBUTE, Mark(points, hint, names, misconception, rule))
        return test

    return mark


def mark_of(test: object) -> Mark | None:
    """What `check` said about this function, if anything."""
    mark = getattr(test, ATTRIBUTE, None)
    return mark if isinstance(mark, Mark) else None
