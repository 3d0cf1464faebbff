"""What a launch file describes: nodes, other programs, groups, and changes for those that follow."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from ros_in_python.launch.conditions import IfCondition
from ros_in_python.launch.substitutions import Text


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
class SetLaunchConfiguration:
    """Gives an argument a value from here on."""

    name: Text
    value: Text
    condition: IfCondition | None = None


@dataclass
class LogInfo:
    """A line in the log of the launch."""

    msg: Text
    condition: IfCondition | None = None


@dataclass
class PushRosNamespace:
    """Puts the nodes after it, in its group, into a namespace."""

    namespace: Text
    condition: IfCondition | None = None


@dataclass
class ParameterForAll:
    """Gives every node after it, in its group, a parameter."""

    name: Text
    value: Any
    condition: IfCondition | None = None


@dataclass
class SetParametersFromFile:
    """Gives every node after it, in its group, the parameters of a file."""

    filename: Text
    condition: IfCondition | None = None


@dataclass
class SetUseSimTime:
    """Lets every node after it, in its group, use simulated time."""

    value: Any = True
    condition: IfCondition | None = None


@dataclass
class SetRemap:
    """Remaps a name for every node after it, in its group."""

    src: Text
    dst: Text
    condition: IfCondition | None = None


@dataclass
class SetEnvironmentVariable:
    """Gives every program after it, in its group, an environment variable."""

    name: Text
    value: Text
    condition: IfCondition | None = None


@dataclass
class AppendEnvironmentVariable:
    """Appends to an environment variable of every program after it, in its group."""

    name: Text
    value: Text
    prepend: Any = False
    separator: Text = ":"
    condition: IfCondition | None = None


@dataclass
class UnsetEnvironmentVariable:
    """Removes an environment variable of every program after it, in its group."""

    name: Text
    condition: IfCondition | None = None


@dataclass
class GroupAction:
    """Actions together, under one condition or in one namespace; what they change ends with the group if `scoped`."""

    actions: Sequence[Any]
    condition: IfCondition | None = None
    scoped: bool = True
    forwarding: bool = True
    launch_configurations: Mapping[Text, Text] = field(default_factory=dict)


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


class OpaqueFunction:
    """A function of the launch file: gets the context, and returns more actions or None."""

    def __init__(
        self,
        *,
        function: Callable[..., Sequence[Any] | None],
        args: Iterable[Any] = (),
        kwargs: Mapping[str, Any] | None = None,
        condition: IfCondition | None = None,
    ) -> None:
        self.function, self.args, self.kwargs, self.condition = function, tuple(args), dict(kwargs or {}), condition


@dataclass
class TimerAction:
    """Actions that come `period` seconds later."""

    period: Any
    actions: Sequence[Any]
    cancel_on_shutdown: Any = True
    condition: IfCondition | None = None


@dataclass
class Shutdown:
    """Ends the launch: every program gets SIGINT."""

    reason: Text = "reason not given"
    condition: IfCondition | None = None


@dataclass(eq=False, kw_only=True)
class LaunchedProgram:
    """What each program of a launch may have besides its command.

    `on_exit` are actions for when it has ended; `respawn` starts it again. `output` is taken and changes nothing: all
    that a program prints is shown.
    """

    name: Text | None = None
    cwd: Text | None = None
    env: Mapping[Text, Text] | None = None
    additional_env: Mapping[Text, Text] = field(default_factory=dict)
    prefix: Text | None = None
    output: Text = "log"
    output_format: str = ""
    emulate_tty: bool = False
    on_exit: Any = ()
    respawn: Any = False
    respawn_delay: float | None = None
    sigterm_timeout: Text = "5"
    sigkill_timeout: Text = "5"
    condition: IfCondition | None = None


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


@dataclass(eq=False, kw_only=True)
class LifecycleNode(Node):
    """A node with a life cycle. It starts unconfigured, as in ROS 2; `ros2 lifecycle set` changes that."""


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
