"""What a launch file describes: nodes, other programs, groups, other files, and what comes later."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from types import SimpleNamespace
from typing import Any

from ros_in_python.launch.conditions import IfCondition
from ros_in_python.launch.substitutions import Context, Text
from ros_in_python.ros2.cli import CommandError


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
class DeclareLaunchArgument:
    """An argument of the launch file, given as `NAME:=VALUE`."""

    name: str
    default_value: Text | None = None
    description: str | None = None
    choices: Sequence[str] | None = None
    condition: IfCondition | None = None


@dataclass
class LogInfo:
    """A line in the log of the launch."""

    msg: Text
    condition: IfCondition | None = None


@dataclass
class GroupAction:
    """Actions together, under one condition or in one namespace; what they change ends with the group if `scoped`.

    A scoped group that is not `forwarding` knows nothing of what holds outside but its `launch_configurations`.
    """

    actions: Sequence[Any]
    condition: IfCondition | None = None
    scoped: bool = True
    forwarding: bool = True
    launch_configurations: Mapping[Text, Text] = field(default_factory=dict)


class Action:
    """The base of a launch file's own actions: `execute` returns more actions or None."""

    def __init__(self, *, condition: IfCondition | None = None) -> None:
        self.condition = condition

    def execute(self, context: Context) -> Any:
        """Return what is to be done."""
        raise NotImplementedError


class LaunchService:
    """Not for a launch file that `ros2 launch` reads: one that is run as a script needs ROS 2's own launch."""

    def __init__(self, *arguments: Any, **options: Any) -> None:
        raise CommandError(f"{type(self).__name__} needs ROS 2's own launch: start this file with `ros2 launch`")


class LaunchIntrospector(LaunchService):
    """As `LaunchService`."""


class LaunchDescriptionSource:
    """A launch file in Python, YAML or XML."""

    def __init__(self, launch_file_path: Text) -> None:
        self.path = launch_file_path


@dataclass
class IncludeLaunchDescription:
    """All that another launch file describes, with values for its arguments."""

    launch_description_source: LaunchDescriptionSource | LaunchDescription | Text
    launch_arguments: Iterable[tuple[Text, Text]] = ()
    condition: IfCondition | None = None


class OpaqueFunction(Action):
    """A function of the launch file: gets the context, and returns more actions or None."""

    def __init__(
        self,
        *,
        function: Callable[..., Sequence[Any] | None],
        args: Iterable[Any] = (),
        kwargs: Mapping[str, Any] | None = None,
        condition: IfCondition | None = None,
    ) -> None:
        super().__init__(condition=condition)
        self.function, self.args, self.kwargs = function, tuple(args), dict(kwargs or {})

    def execute(self, context: Context) -> Any:
        """Return what the function returns."""
        return self.function(context, *self.args, **self.kwargs)


@dataclass
class TimerAction:
    """Actions that come `period` seconds later, if `cancel_on_shutdown` is false also when the launch is ending."""

    period: Any
    actions: Sequence[Any]
    cancel_on_shutdown: Any = True
    condition: IfCondition | None = None


@dataclass
class RosTimer(TimerAction):
    """As `TimerAction`, in ROS's time, which here can't be a simulated one."""


@dataclass
class Shutdown:
    """Ends the launch: every program gets SIGINT."""

    reason: Text = "reason not given"
    condition: IfCondition | None = None


@dataclass(eq=False, kw_only=True)
class LaunchedProgram:
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
    sigterm_timeout: Text = "5"
    sigkill_timeout: Text = "5"
    condition: IfCondition | None = None
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
class LifecycleTransition:
    """Makes nodes with a life cycle do transitions, each after the one before has succeeded."""

    lifecycle_node_names: Sequence[Text]
    transition_ids: Sequence[Any]
    condition: IfCondition | None = None


def line_of(program: LaunchedProgram, name: str, line: str) -> str:
    """Return a line that a program has printed as the launch shows it. Raises what `str.format` does."""
    this = SimpleNamespace(process_description=SimpleNamespace(final_name=name, name=name), name=name)
    return program.output_format.format(line=line, this=this)


def as_actions(value: Any) -> list[Any]:
    """Return actions as a list, if one or none is given as well."""
    if value is None:
        return []
    return list(value) if isinstance(value, list | tuple) else [value]


def path_of_source(source: Any) -> Text:
    """Return the path in a source, however it was given."""
    return (
        source.path
        if isinstance(source, LaunchDescriptionSource)
        else Path(source)
        if isinstance(source, Path)
        else source
    )
