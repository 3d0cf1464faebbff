"""What happens while a launch runs, and what launch files do then."""

from __future__ import annotations

import signal
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, ClassVar, TypeAlias

from ros_in_python.launch.actions import Action, LaunchedProgram, LifecycleNode
from ros_in_python.launch.conditions import Condition
from ros_in_python.ros2.cli import CommandError

#: Actions, or a function that gets the event and the context and returns actions or None.
Reaction: TypeAlias = Sequence[Any] | Callable[[Any, Any], Any] | Any
#: One program, several, those for which a function says so, or all (None).
Target: TypeAlias = LaunchedProgram | Sequence[LaunchedProgram] | Callable[[LaunchedProgram], bool] | None


class LaunchEvent:
    """The base of all events, and of a launch file's own."""


@dataclass(frozen=True)
class ProcessEvent(LaunchEvent):
    """Something happened to a program."""

    action: LaunchedProgram
    process_name: str
    pid: int

    @property
    def cmd(self) -> Sequence[str]:
        """The words of its command."""
        return tuple((self.action.process_details or {"cmd": ()})["cmd"])


@dataclass(frozen=True)
class ProcessStarted(ProcessEvent):
    """A program has started."""


@dataclass(frozen=True)
class ProcessExited(ProcessEvent):
    """A program has ended, by itself or not."""

    returncode: int


@dataclass(frozen=True)
class ProcessIO(ProcessEvent):
    """A program has printed a line."""

    text: bytes
    from_stdout: bool = True
    from_stdin: ClassVar[bool] = False

    @property
    def from_stderr(self) -> bool:
        """Whether it printed the line to its other output."""
        return not self.from_stdout


@dataclass(frozen=True)
class ExecutionComplete(LaunchEvent):
    """A program has ended, and does not start again."""

    action: LaunchedProgram


@dataclass(frozen=True)
class ShutdownRequested(LaunchEvent):
    """The launch ends. Launch files call it `launch.events.Shutdown`."""

    reason: str = "reason not given"
    due_to_sigint: bool = False


@dataclass(frozen=True)
class StateTransition(LaunchEvent):
    """The state of a node with a life cycle has changed. `transition` and the states are names, such as `active`."""

    action: LifecycleNode
    transition: str
    start_state: str
    goal_state: str


@dataclass(frozen=True, kw_only=True)
class SignalProcess(LaunchEvent):
    """Sends programs a signal, by its number or name, when it is emitted."""

    signal_number: int | str
    process_matcher: Callable[[LaunchedProgram], bool]

    @property
    def number(self) -> signal.Signals:
        """The signal. Raises `CommandError` if there is none with this number or name."""
        of = self.signal_number
        try:
            return signal.Signals[of] if isinstance(of, str) else signal.Signals(of)
        except (KeyError, ValueError):
            raise CommandError(f"SignalProcess: there is no signal {of!r}") from None


@dataclass(frozen=True, kw_only=True)
class ShutdownProcess(LaunchEvent):
    """Ends programs, when it is emitted."""

    process_matcher: Callable[[LaunchedProgram], bool]


@dataclass(frozen=True, kw_only=True)
class ChangeState(LaunchEvent):
    """Makes nodes with a life cycle do a transition, when it is emitted."""

    lifecycle_node_matcher: Callable[[LifecycleNode], bool]
    transition_id: int


# --- handlers


class EventHandler:
    """Does something about the events for which a function says so; with `handle_once`, about the first one."""

    def __init__(self, *, matcher: Callable[[Any], bool], entities: Reaction = None, handle_once: bool = False) -> None:
        self.matcher, self.reaction, self.handle_once = matcher, entities, handle_once


class _ActionHandler(EventHandler):
    """A handler of one kind of event, of chosen programs."""

    def __init__(self, event: type[Any], target: Target, reaction: Reaction, options: dict[str, Any]) -> None:
        def matches(happened: Any) -> bool:
            return isinstance(happened, event) and _concerns(target, happened.action)

        super().__init__(matcher=matches, entities=reaction, **options)


class OnProcessStart(_ActionHandler):
    """Does something when a program has started."""

    def __init__(self, *, target_action: Target = None, on_start: Reaction, **options: Any) -> None:
        super().__init__(ProcessStarted, target_action, on_start, options)


class OnProcessExit(_ActionHandler):
    """Does something when a program has ended."""

    def __init__(self, *, target_action: Target = None, on_exit: Reaction, **options: Any) -> None:
        super().__init__(ProcessExited, target_action, on_exit, options)


class OnExecutionComplete(_ActionHandler):
    """Does something when a program has ended, and does not start again."""

    def __init__(self, *, target_action: Target = None, on_completion: Reaction, **options: Any) -> None:
        if not (target_action is None or callable(target_action) or isinstance(target_action, LaunchedProgram)):
            raise TypeError(f"OnExecutionComplete is for programs, not for a {type(target_action).__name__}")
        super().__init__(ExecutionComplete, target_action, on_completion, options)


class OnProcessIO(_ActionHandler):
    """Calls a function with each line that a program prints: unlike other functions, with the event alone."""

    def __init__(
        self,
        *,
        target_action: Target = None,
        on_stdin: Callable[[ProcessIO], Any] | None = None,
        on_stdout: Callable[[ProcessIO], Any] | None = None,
        on_stderr: Callable[[ProcessIO], Any] | None = None,
        **options: Any,
    ) -> None:
        if on_stdin is not None:
            raise TypeError("on_stdin: the programs of a launch read nothing")

        def react(event: ProcessIO, context: Any) -> Any:
            function = on_stdout if event.from_stdout else on_stderr
            return function(event) if function else None

        super().__init__(ProcessIO, target_action, react, options)


class OnShutdown(EventHandler):
    """Does something when the launch ends."""

    def __init__(self, *, on_shutdown: Reaction, **options: Any) -> None:
        super().__init__(matcher=lambda event: isinstance(event, ShutdownRequested), entities=on_shutdown, **options)


class OnStateTransition(EventHandler):
    """Does something when the state of a node with a life cycle has changed."""

    def __init__(
        self,
        *,
        entities: Reaction,
        target_lifecycle_node: Target = None,
        transition: str | None = None,
        start_state: str | None = None,
        goal_state: str | None = None,
        matcher: Callable[[Any], bool] | None = None,
        **options: Any,
    ) -> None:
        expected = {"transition": transition, "start_state": start_state, "goal_state": goal_state}

        def matches(event: Any) -> bool:
            return (
                isinstance(event, StateTransition)
                and _concerns(target_lifecycle_node, event.action)
                and all(value in (None, getattr(event, name)) for name, value in expected.items())
            )

        super().__init__(matcher=matcher or matches, entities=entities, **options)


@dataclass
class RegisterEventHandler(Action):
    """Makes a handler hold from here on."""

    event_handler: EventHandler
    condition: Condition | None = None


@dataclass
class UnregisterEventHandler(Action):
    """Makes a handler hold no more."""

    event_handler: EventHandler
    condition: Condition | None = None


@dataclass
class EmitEvent(Action):
    """Lets an event happen."""

    event: Any
    condition: Condition | None = None


def _concerns(target: Any, action: LaunchedProgram) -> bool:
    if target is None:
        return True
    if isinstance(target, list | tuple):
        return action in target
    return bool(target(action)) if callable(target) else action is target


# --- functions that say which program an event is for


def matches_action(target_action: LaunchedProgram) -> Callable[[LaunchedProgram], bool]:
    """Return a function that is true for this program alone."""
    return lambda action: action is target_action


def matches_name(name: str) -> Callable[[LaunchedProgram], bool]:
    """Return a function that is true for the program whose lines begin with this name, such as `talker-1`."""
    return lambda action: (action.process_details or {}).get("name") == name


def matches_pid(pid: int) -> Callable[[LaunchedProgram], bool]:
    """Return a function that is true for the process with this number."""
    return lambda action: (action.process_details or {}).get("pid") == pid


def matches_executable(executable: str) -> Callable[[LaunchedProgram], bool]:
    """Return a function that is true for programs whose path ends so."""
    return lambda action: (action.process_details or {"cmd": [""]})["cmd"][0].endswith(executable)


def matches_node_name(node_name: str) -> Callable[[Any], bool]:
    """Return a function that is true for the node with this name."""
    full = node_name if node_name.startswith("/") else f"/{node_name}"
    return lambda action: getattr(action, "node_name", None) == full
