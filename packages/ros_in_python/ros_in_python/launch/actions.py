"""What a launch file describes: nodes, other programs, groups, other files, and what comes later."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from types import SimpleNamespace
from typing import Any

from ros_in_python.launch.conditions import Condition
from ros_in_python.launch.substitutions import Context, LaunchConfiguration, Text
from ros_in_python.ros2.cli import CommandError


class PlacedError(CommandError):
    """What is wrong, after the file and the line of a launch file."""


class Action:
    """The base of all actions, and of a launch file's own: `execute` returns more actions or None.

    `place` is the file and line of a Python launch file that made it.
    """

    place: str

    def __new__(cls, *args: Any, **options: Any) -> Any:
        """Remember who makes it."""
        made, caller = super().__new__(cls), sys._getframe(1)
        is_ours = caller.f_globals["__name__"].startswith(__package__)
        made.place = "" if is_ours else f"{caller.f_code.co_filename}:{caller.f_lineno}"
        return made

    def __init__(self, *, condition: Condition | None = None) -> None:
        self.condition = condition

    def execute(self, context: Context) -> Any:
        """Return what is to be done."""
        raise NotImplementedError


class LaunchDescription:
    """All that a launch file describes, in order."""

    def __init__(self, initial_entities: Iterable[Any] = ()) -> None:
        self.entities: list[Any] = list(initial_entities or ())

    def add_action(self, action: Any) -> None:
        """Append an action."""
        self.entities.append(action)

    def add_entity(self, entity: Any) -> None:
        """Append an action: the older name of `add_action`."""
        self.entities.append(entity)


@dataclass
class DeclareLaunchArgument(Action):
    """An argument of the launch file, given as `NAME:=VALUE`."""

    name: str
    default_value: Text | None = None
    description: str | None = None
    choices: Sequence[str] | None = None
    condition: Condition | None = None


@dataclass
class LogInfo(Action):
    """A line in the log of the launch."""

    msg: Text
    condition: Condition | None = None


@dataclass
class GroupAction(Action):
    """Actions together, under one condition or in one namespace; what they change ends with the group if `scoped`.

    A scoped group that is not `forwarding` knows nothing of what holds outside but its `launch_configurations`.
    """

    actions: Sequence[Any]
    condition: Condition | None = None
    scoped: bool = True
    forwarding: bool = True
    launch_configurations: Mapping[Text, Text] = field(default_factory=dict)


class LaunchService:
    """Not for a launch file that `ros2 launch` reads: one that is run as a script needs ROS 2's own launch."""

    def __init__(self, *arguments: Any, **options: Any) -> None:
        raise CommandError(f"{type(self).__name__} needs ROS 2's own launch: start this file with `ros2 launch`")


class LaunchIntrospector:
    """Describes what a launch file describes, for a launch file that prints it."""

    def format_launch_description(self, description: LaunchDescription) -> str:
        """Return a line per action."""
        return "\n".join(["LaunchDescription:", *(f"    {entity!r}" for entity in description.entities)])


class LaunchDescriptionSource:
    """A launch file in Python, YAML or XML."""

    def __init__(self, launch_file_path: Text) -> None:
        self.path = launch_file_path


@dataclass
class IncludeLaunchDescription(Action):
    """All that another launch file describes, with values for its arguments."""

    launch_description_source: LaunchDescriptionSource | LaunchDescription | Text
    launch_arguments: Iterable[tuple[Text, Text]] = ()
    condition: Condition | None = None


class OpaqueFunction(Action):
    """A function of the launch file: gets the context, and returns more actions or None."""

    def __init__(
        self,
        *,
        function: Callable[..., Sequence[Any] | None],
        args: Iterable[Any] = (),
        kwargs: Mapping[str, Any] | None = None,
        condition: Condition | None = None,
    ) -> None:
        super().__init__(condition=condition)
        self.function, self.args, self.kwargs = function, tuple(args), dict(kwargs or {})

    def execute(self, context: Context) -> Any:
        return self.function(context, *self.args, **self.kwargs)


@dataclass
class TimerAction(Action):
    """Actions that come `period` seconds later, if `cancel_on_shutdown` is false also when the launch is ending."""

    period: Any
    actions: Sequence[Any]
    cancel_on_shutdown: Any = True
    condition: Condition | None = None


@dataclass
class RosTimer(TimerAction):
    """As `TimerAction`, in ROS's time, which here can't be a simulated one."""


@dataclass
class Shutdown(Action):
    """Ends the launch: every program gets SIGINT."""

    reason: Text = "reason not given"
    condition: Condition | None = None


#: How long a program may take to end (s), unless an argument of the launch says otherwise.
_TERM_TIMEOUT, _KILL_TIMEOUT = (LaunchConfiguration(f"sig{name}_timeout", default="5") for name in ("term", "kill"))


@dataclass(eq=False, kw_only=True)
class LaunchedProgram(Action):
    """What each program of a launch may have besides its command.

    `on_exit` are actions for when it has ended; `respawn` starts it again. `process_details` has `name`, `pid` and
    `cmd` once it has started. All that a program prints is shown at once, whatever `output`, `emulate_tty` and
    `cached_output` are.
    """

    name: Text | None = None
    cwd: Text | None = None
    env: Mapping[Text, Text] | None = None
    additional_env: Mapping[Text, Text] = field(default_factory=dict)
    prefix: Text | None = None
    output: Text = "log"
    output_format: str = "[{this.process_description.final_name}] {line}"
    emulate_tty: bool = False
    cached_output: bool = False
    log_cmd: bool = False
    on_exit: Any = ()
    respawn: Any = False
    respawn_delay: float | None = None
    respawn_max_retries: int = -1
    sigterm_timeout: Text = _TERM_TIMEOUT
    sigkill_timeout: Text = _KILL_TIMEOUT
    condition: Condition | None = None
    process_details: Mapping[str, Any] | None = field(default=None, init=False)


@dataclass(eq=False, kw_only=True)
class ExecuteProcess(LaunchedProgram):
    """Any program: its words, or with `shell` a line for the shell."""

    cmd: Sequence[Text]
    shell: bool = False


@dataclass(eq=False, kw_only=True)
class Node(LaunchedProgram):
    """A node to start, as `ros2 run` would.

    `parameters` are dictionaries, and paths of parameter files; `remappings` are pairs (from, to).
    """

    executable: Text
    package: Text | None = None
    namespace: Text | None = None
    exec_name: Text | None = None
    parameters: Sequence[Any] = ()
    remappings: Sequence[tuple[Text, Text]] = ()
    arguments: Sequence[Text] = ()
    ros_arguments: Sequence[Text] = ()
    node_name: str = field(default="", init=False)


@dataclass(eq=False, kw_only=True)
class LifecycleNode(Node):
    """A node with a life cycle. It starts unconfigured; events, `ros2 lifecycle set` or `autostart` change that."""

    autostart: bool = False


@dataclass
class ComposableNode:
    """A node in a C++ library, for a container; never started here."""

    package: Text
    plugin: Text
    name: Text | None = None
    namespace: Text | None = None
    parameters: Sequence[Any] = ()
    remappings: Sequence[tuple[Text, Text]] = ()
    extra_arguments: Sequence[Any] = ()
    condition: Condition | None = None


@dataclass(eq=False, kw_only=True)
class ComposableNodeContainer(Node):
    """A process for composable nodes: refused, or left out if the user asks for that."""

    composable_node_descriptions: Sequence[ComposableNode] = ()


@dataclass(eq=False, kw_only=True)
class LoadComposableNodes(Action):
    """Puts composable nodes into a container that runs already: as `ComposableNodeContainer`."""

    composable_node_descriptions: Sequence[ComposableNode]
    target_container: Any
    condition: Condition | None = None


@dataclass
class LifecycleTransition(Action):
    """Makes nodes with a life cycle do transitions, each after the one before has succeeded."""

    lifecycle_node_names: Sequence[Text]
    transition_ids: Sequence[Any]
    condition: Condition | None = None


def line_of(program: LaunchedProgram, name: str, line: str) -> str:
    """Return a line that a program has printed as the launch shows it. Raises what `str.format` does."""
    this = SimpleNamespace(process_description=SimpleNamespace(final_name=name, name=name), name=name)
    return program.output_format.format(line=line, this=this)


def as_actions(value: Any) -> list[Any]:
    """Return actions as a list, if one or none is given as well."""
    if value is None:
        return []
    return list(value) if isinstance(value, list | tuple) else [value]
