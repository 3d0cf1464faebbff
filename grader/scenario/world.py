"""Worlds: small models that read a program's commands and publish the state, stepped in simulated time.

A model is a class with `reads` and `publishes` (topic to type), `hear(topic, message)`, `step(seconds)` and `state()`,
which returns a message's fields for each topic to publish now. It runs inside the grader. If it also has `truth()`,
which returns a dictionary, checks see what that returned after each step, and students' programs never do.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any, Protocol

from grader.recording.events import Fields
from grader.scenario.code import AuthorCode, code_of, folder_of_the_author, line_of_the_author

#: The duration of one step of a world, unless the author says otherwise (s).
PERIOD = 0.02


class Model(Protocol):
    """The interface of a world's class. `reads` and `publishes` may be set by its constructor, too."""

    reads: dict[str, str]
    publishes: dict[str, str]

    def hear(self, topic: str, message: Any) -> None:
        """Take a message that has arrived; its fields are attributes."""

    def step(self, seconds: float) -> None:
        """Advance the world by this much simulated time."""

    def state(self) -> dict[str, Fields]:
        """Return the messages to publish after a step, by topic."""


@dataclass(frozen=True)
class World:
    """A model, by its class and its constructor's arguments; it is stepped every `period` s of simulated time."""

    code: AuthorCode
    arguments: dict[str, Any] = field(default_factory=dict)
    period: float = PERIOD
    line: int = field(default_factory=line_of_the_author, compare=False, repr=False)

    def __init__(self, model: Callable[..., Any] | AuthorCode, /, period: float = PERIOD, **arguments: Any) -> None:
        """Take the class itself, and the arguments for its constructor."""
        if not callable(model) and not isinstance(model, AuthorCode):
            name = type(model).__name__
            raise ValueError(f"World({name}(…)): give the class itself, and its arguments after it: World({name}, …)")
        if with_files := getattr(model, "with_files", None):
            arguments = with_files(arguments, folder_of_the_author())
        fields = {"code": model if isinstance(model, AuthorCode) else code_of(model), "arguments": arguments}
        for name, value in {**fields, "period": period, "line": line_of_the_author()}.items():
            object.__setattr__(self, name, value)

    def begin(self) -> Model:
        """Return a new model in its initial state."""
        model: Model = self.code.load()(**self.arguments)
        return model

    def __reduce__(self) -> tuple[Callable[..., World], tuple[Any, ...]]:
        """Keep all parts when the world is sent to another process."""
        return restored, (self.code, self.period, self.arguments, self.line)


def restored(code: AuthorCode, period: float, arguments: dict[str, Any], line: int) -> World:
    """Return a world made from its parts."""
    world = World(code, period, **arguments)
    object.__setattr__(world, "line", line)
    return world
