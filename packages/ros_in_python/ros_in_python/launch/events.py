"""What happens while a launch runs, and what launch files do then."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, TypeAlias

from ros_in_python.launch.actions import LaunchedProgram
from ros_in_python.launch.conditions import IfCondition

#: Actions, or a function that gets the event and the context and returns actions or None.
Reaction: TypeAlias = Sequence[Any] | Callable[[Any, Any], Any] | Any


@dataclass(frozen=True)
class ProcessStarted:
    """A program has started."""

    action: LaunchedProgram
    process_name: str
    pid: int


@dataclass(frozen=True)
class ProcessExited:
    """A program has ended, by itself or not."""

    action: LaunchedProgram
    process_name: str
    pid: int
    returncode: int


@dataclass(frozen=True)
class ProcessIO:
    """A program has printed a line."""

    action: LaunchedProgram
    process_name: str
    pid: int
    text: bytes
    from_stdout: bool = True
    from_stderr: bool = False


@dataclass(frozen=True)
class ShutdownRequested:
    """The launch ends. Launch files call it `launch.events.Shutdown`."""

    reason: str = "reason not given"
    due_to_sigint: bool = False


#: One program, several, those for which a function says so, or all (None).
Target: TypeAlias = LaunchedProgram | Sequence[LaunchedProgram] | Callable[[LaunchedProgram], bool] | None


class OnProcessStart:
    """Does something when a program has started."""

    event = ProcessStarted

    def __init__(self, *, target_action: Target = None, on_start: Reaction) -> None:
        self.target, self.reaction = target_action, on_start


class OnProcessExit:
    """Does something when a program has ended."""

    event = ProcessExited

    def __init__(self, *, target_action: Target = None, on_exit: Reaction) -> None:
        self.target, self.reaction = target_action, on_exit


class OnProcessIO:
    """Calls a function with each line that a program prints. Both of its outputs are one here."""

    event = ProcessIO

    def __init__(
        self,
        *,
        target_action: Target = None,
        on_stdin: Any = None,
        on_stdout: Reaction = None,
        on_stderr: Reaction = None,
    ) -> None:
        self.target, self.reaction = target_action, on_stdout or on_stderr or ()


class OnShutdown:
    """Does something when the launch ends."""

    event = ShutdownRequested

    def __init__(self, *, on_shutdown: Reaction) -> None:
        self.target, self.reaction = None, on_shutdown


Handler: TypeAlias = OnProcessStart | OnProcessExit | OnProcessIO | OnShutdown


@dataclass
class RegisterEventHandler:
    """Makes a handler hold from here on."""

    event_handler: Handler
    condition: IfCondition | None = None


@dataclass
class EmitEvent:
    """Lets an event happen: here, the end of the launch."""

    event: Any
    condition: IfCondition | None = None


def concerns(handler: Handler, event: Any) -> bool:
    """Return whether a handler is for this event."""
    kind: Any = handler.event
    if not isinstance(event, kind):
        return False
    target = handler.target
    if target is None:
        return True
    if isinstance(target, list | tuple):
        return event.action in target
    return bool(target(event.action)) if callable(target) else event.action is target
