"""Reference servers, which answer the student's requests and goals."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, Literal

from grader.recording.events import Fields
from grader.scenario.code import AuthorCode, code_of, line_of_the_author

#: How an action server reacts to a request to cancel. "ignore": it accepts, but continues anyway.
OnCancel = Literal["accept", "refuse", "ignore"]

End = Literal["succeeded", "aborted", "never"]


@dataclass(frozen=True)
class Reply:
    """The answer to one request after `after` s of simulated time; `fields` is None for no answer."""

    after: float = 0.0
    fields: Fields | None = None


def reply(after: float = 0.0, /, **fields: Any) -> Reply:
    """Answer with these fields, after this many seconds: `reply(sum=5)`, `reply(2.0, sum=5)`."""
    return Reply(after, fields)


def no_reply() -> Reply:
    """Never answer."""
    return Reply()


@dataclass(frozen=True)
class Server:
    """A reference server of a service.

    `replies` has one for each request; the last one is repeated. Or it is a function from the author's file, which
    gets the request and returns the response's fields (or a `Reply`).

    The server exists before the program starts, or from `appears` on (s after the start). It disappears at `gone` and
    comes back at `back`.
    """

    service: str
    type: str = ""
    replies: Reply | Sequence[Reply] | Callable[..., Any] | AuthorCode = ()
    appears: float | None = None
    gone: float | None = None
    back: float | None = None
    line: int = field(default_factory=line_of_the_author, compare=False, repr=False)

    def __post_init__(self) -> None:
        """Convert a single reply into a tuple, and a function into its `AuthorCode`."""
        object.__setattr__(self, "replies", _replies(self.replies))

    @property
    def name(self) -> str:
        """The service's name."""
        return self.service


def _replies(replies: Any) -> tuple[Reply, ...] | AuthorCode:
    if isinstance(replies, Reply):
        return (replies,)
    if isinstance(replies, AuthorCode):
        return replies
    return code_of(replies) if callable(replies) else tuple(replies)


@dataclass(frozen=True)
class GoalScript:
    """What a scripted action server does with one goal; times are s after it accepted the goal.

    `answers_after` is the delay before it accepts or rejects the goal.
    """

    accept: bool = True
    answers_after: float = 0.0
    feedback: tuple[tuple[float, Fields], ...] = ()
    end: End = "never"
    after: float = 0.0
    result: Fields = field(default_factory=dict)
    cancel: OnCancel = "accept"
    cancel_takes: float = 0.0


def succeeds(
    after: float = 0.0,
    result: Fields | None = None,
    feedback: dict[float, Fields] | None = None,
    cancel: OnCancel = "accept",
    cancel_takes: float = 0.0,
    answers_after: float = 0.0,
) -> GoalScript:
    """Accept the goal, give feedback at these seconds, and succeed `after` s."""
    timed_feedback = tuple(sorted((feedback or {}).items(), key=lambda entry: entry[0]))
    return GoalScript(True, answers_after, timed_feedback, "succeeded", after, result or {}, cancel, cancel_takes)


def aborts(
    after: float = 0.0,
    result: Fields | None = None,
    feedback: dict[float, Fields] | None = None,
    cancel: OnCancel = "accept",
    cancel_takes: float = 0.0,
    answers_after: float = 0.0,
) -> GoalScript:
    """Accept the goal, give feedback at these seconds, and abort `after` s."""
    return replace(succeeds(after, result, feedback, cancel, cancel_takes, answers_after), end="aborted")


def never_ends(
    feedback: dict[float, Fields] | None = None,
    cancel: OnCancel = "accept",
    cancel_takes: float = 0.0,
    answers_after: float = 0.0,
) -> GoalScript:
    """Accept the goal, and never end."""
    return replace(succeeds(0.0, None, feedback, cancel, cancel_takes, answers_after), end="never")


def rejects(answers_after: float = 0.0) -> GoalScript:
    """Reject the goal."""
    return GoalScript(accept=False, answers_after=answers_after)


@dataclass(frozen=True)
class ActionServer:
    """A scripted server of an action: `goals` has a script for each goal, or one for all; the last serves the rest."""

    action: str
    type: str = ""
    goals: GoalScript | Sequence[GoalScript] = ()
    appears: float | None = None
    gone: float | None = None
    back: float | None = None
    line: int = field(default_factory=line_of_the_author, compare=False, repr=False)

    def __post_init__(self) -> None:
        """Convert a single script into a tuple."""
        object.__setattr__(self, "goals", self.scripts)

    @property
    def name(self) -> str:
        """The action's name."""
        return self.action

    @property
    def scripts(self) -> tuple[GoalScript, ...]:
        """The scripts, in the order of the goals."""
        return (self.goals,) if isinstance(self.goals, GoalScript) else tuple(self.goals)
