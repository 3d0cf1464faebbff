"""What a check is, how it fails, and its verdict on one submission."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Literal, NoReturn, TypeVar


@dataclass(frozen=True)
class Finding:
    """What is wrong, in words for the student, and in parts if there are any.

    `at` is in seconds after the scenario's start, `message` is the number of the message sent, counted from 1.
    `shortened` limits the length of the texts, which may repeat what the student's program printed or published.

    `cause` is what the recording shows to be behind it, which `text` says, too: all findings with one cause are one
    mistake. `where` and `todo` are the hints that belong to the cause.
    """

    text: str
    scenario: str = ""
    message: int | None = None
    at: float | None = None
    part: str = ""
    expected: str = ""
    got: str = ""
    cause: str = ""
    where: str = ""
    todo: str = ""

    def shortened(self) -> Finding:
        """Return the finding with at most `LONGEST_TEXT` characters in each of its texts."""
        text, cause = _shortened(self.text), _shortened(self.cause)
        return replace(self, text=text, cause=cause, expected=_shortened(self.expected), got=_shortened(self.got))


#: In characters. The overview of a class compares all findings word by word, so long ones cost time.
LONGEST_TEXT = 4000


def _shortened(text: str) -> str:
    return text if len(text) <= LONGEST_TEXT else f"{text[:LONGEST_TEXT]}…"


class Wrong(AssertionError):
    """Raised by a check that the student's node does not pass.

    `share` is how much of what the check looked at is right all the same, between 0 and 1.
    """

    def __init__(self, finding: Finding, share: float = 0.0) -> None:
        super().__init__(finding.text)
        self.finding = finding
        self.share = share


def fail(text: str, *, expected: object = "", got: object = "", at: float | None = None) -> NoReturn:
    """End the check: the node does not pass it. `text` says why, to the student; `at` is in seconds.

    Example: `fail("Two publishers on /out.", expected=1, got=2)`
    """
    message = with_values(text, [("expected", expected), ("got", got)])
    raise Wrong(Finding(message, at=at, expected=str(expected), got=str(got)))


def with_values(text: str, values: Iterable[tuple[str, object]]) -> str:
    """Return a finding's text with a sentence for the values that are given: "Expected 1, got 2."."""
    sentence = ", ".join(f"{word} {value}" for word, value in values if value != "")
    if not sentence:
        return text
    return f"{text}{'.' * text[-1:].isalnum()} {sentence[0].upper()}{sentence[1:]}."


#: `error`: the check itself crashed, which is never the student's fault.
Status = Literal["passed", "failed", "blocked", "error"]


@dataclass(frozen=True)
class Verdict:
    """One check's verdict. `name` is its function, `title` its docstring.

    A failed check has a `finding`, and `share` is how much of what it looked at is right, between 0 and 1. If it is
    `partial`, that gives part of the points. `blocked_by` names the checks without which a blocked one can't be judged.
    `error` says what crashed in the check, with file and line. `hint` and `todo` are the author's hints: where to look,
    and what to do. `untested` says what the check can't show in a self-check.
    """

    name: str
    title: str
    status: Status
    points: float
    hint: str = ""
    misconception: str = ""
    hidden: bool = False
    finding: Finding | None = None
    blocked_by: tuple[str, ...] = ()
    error: str = ""
    share: float = 0.0
    partial: bool = False
    todo: str = ""
    untested: str = ""

    @property
    def earned(self) -> float:
        """Return the points that it gave.

        A partial check gives twice what is right above one half: all points for all of it, none for half of it. If it
        fails, rounding never gives it all of them.
        """
        if self.status == "passed":
            return self.points
        if not self.partial:
            return 0.0
        return round(max(min(self.points * (2 * self.share - 1), self.points - 0.1), 0.0), 1)

    @property
    def blocks(self) -> bool:
        """Return whether checks that depend on it can't be judged: unless more than half is right."""
        return self.status != "passed" and self.share <= 0.5


Test = TypeVar("Test", bound=Callable[..., None])

#: The attribute of a test function that holds its options.
ATTRIBUTE = "__check__"


@dataclass(frozen=True)
class CheckOptions:
    """The arguments of the `check` decorator of a test function, by its names.

    `depends` are names of other checks. `rules` name rules of task.md, each by its id or by a sentence.
    """

    points: float
    hint: str
    depends: tuple[str, ...]
    misconception: str
    rules: tuple[str, ...] = ()
    partial: bool = False
    todo: str = ""
    untested: str = ""


@dataclass(frozen=True, kw_only=True)
class ListedCheck(CheckOptions):
    """One check of an exercise, as its author wrote it.

    `scenarios` are those that it uses, directly or by a fixture; with other fixtures, if the scenarios are not known.
    `file` and `line` say where the check is, and `seconds` how long it took to judge, if it did.
    """

    name: str
    title: str
    hidden: bool
    scenarios: tuple[str, ...]
    file: Path
    line: int
    seconds: float = 0.0


def with_dependencies(names: Iterable[str], checks: Iterable[ListedCheck]) -> set[str]:
    """Return these names of `checks`, and those of all the checks on which they depend."""
    depends = {check.name: check.depends for check in checks}
    found: set[str] = set()
    waiting = list(names)
    while waiting:
        name = waiting.pop()
        if name in depends and name not in found:
            found.add(name)
            waiting += depends[name]
    return found


def check(
    *,
    points: float,
    hint: str,
    depends: Sequence[Callable[..., Any] | str] = (),
    misconception: str = "",
    rule: str | Sequence[str] = (),
    partial: bool = False,
    todo: str = "",
    untested: str = "",
) -> Callable[[Test], Test]:
    """Make a test function a check that gives `points`. Its docstring is the check's title.

    `hint` says where to look to a student who fails the check. `depends` lists checks (functions of the same file, or
    names) without which this one can't be judged: unless each of them passed, or more than half of what it looks at is
    right, it counts as blocked, not as failed. `misconception` names the common mistake behind a failure, in two or
    three words. `rule` names the rules of task.md that the check is based on, each by its id or by a sentence of it,
    word for word: `spinbook audit` needs one for each hidden check. A `partial` check gives part of its points for what
    is right.

    `todo` says what to do, in up to 160 words, to a student who asks for more than `hint`. Both are shown only if the
    recording shows no cause that has hints of its own. `untested` is for a check whose rule no public scenario tests in
    full: what passes it all the same, such as "a stamp from now() passes, too." A self-check then shows no ✓.

    Example: `check(points=5, hint="Which topic does it publish on?", rule="topic")`
    """
    names = tuple(item if isinstance(item, str) else item.__name__ for item in depends)
    rules = (rule,) if isinstance(rule, str) else tuple(rule)

    def mark(test: Test) -> Test:
        if not test.__name__.startswith("test"):
            raise ValueError(f"a check's name begins with test_: call it test_{test.__name__}")
        setattr(test, ATTRIBUTE, CheckOptions(points, hint, names, misconception, rules, partial, todo, untested))
        return test

    return mark


def check_options(test: object) -> CheckOptions | None:
    """Return what `check` said about this function, if anything."""
    mark = getattr(test, ATTRIBUTE, None)
    return mark if isinstance(mark, CheckOptions) else None
