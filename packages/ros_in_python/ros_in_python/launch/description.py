"""What a launch file describes: arguments, nodes and groups of them, under the names of ROS 2's own API."""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import yaml

from interface_compiler import prefixes
from ros_in_python.ros2.cli import CommandError


@dataclass
class Context:
    """What is known while a description is carried out: the arguments' values, and the namespace around."""

    values: dict[str, str] = field(default_factory=dict)
    namespace: str = ""


class Substitution:
    """A text that is known only when the launch file runs."""

    def perform(self, context: Context) -> str:
        """Return the text. Raises `CommandError` if it can't be known."""
        raise NotImplementedError


#: A text, a substitution, or several of them in a row.
Text = Any


def text_of(value: Text, context: Context) -> str:
    """Return the text that a value stands for; a list of texts and substitutions is joined."""
    if isinstance(value, Substitution):
        return value.perform(context)
    if isinstance(value, list | tuple):
        return "".join(text_of(part, context) for part in value)
    return os.fspath(value) if isinstance(value, Path) else str(value)


class TextSubstitution(Substitution):
    """A plain text, for places that want a substitution."""

    def __init__(self, *, text: str) -> None:
        self.text = text

    def perform(self, context: Context) -> str:
        """Return the text itself."""
        return self.text


class LaunchConfiguration(Substitution):
    """The value of a launch argument."""

    def __init__(self, variable_name: str, *, default: Text | None = None) -> None:
        self.name, self.default = variable_name, default

    def perform(self, context: Context) -> str:
        """Return the argument's value, or the default. Raises `CommandError` if there is neither."""
        if self.name in context.values:
            return context.values[self.name]
        if self.default is None:
            known = ", ".join(context.values) or "none"
            raise CommandError(
                f"launch configuration '{self.name}' does not exist",
                f"Declare it before it is used: DeclareLaunchArgument('{self.name}'). Declared so far: {known}.",
            )
        return text_of(self.default, context)


class EnvironmentVariable(Substitution):
    """The value of an environment variable."""

    def __init__(self, name: Text, *, default_value: Text | None = None) -> None:
        self.name, self.default = name, default_value

    def perform(self, context: Context) -> str:
        """Return the variable's value, or the default. Raises `CommandError` if there is neither."""
        name = text_of(self.name, context)
        if name in os.environ:
            return os.environ[name]
        if self.default is None:
            raise CommandError(f"environment variable '{name}' does not exist")
        return text_of(self.default, context)


class PathJoinSubstitution(Substitution):
    """Parts of a path, joined with slashes."""

    def __init__(self, substitutions: Iterable[Text]) -> None:
        self.parts = list(substitutions)

    def perform(self, context: Context) -> str:
        """Return the path."""
        return os.fspath(Path(*(text_of(part, context) for part in self.parts)))


class FindPackageShare(Substitution):
    """The folder `share/PACKAGE` of an installed package."""

    def __init__(self, package: Text) -> None:
        self.package = package

    def perform(self, context: Context) -> str:
        """Return the folder's path. Raises `CommandError` if the package is not installed."""
        return os.fspath(share_of(text_of(self.package, context)))


def share_of(package: str) -> Path:
    """Return the share folder of a package in this environment's prefixes. Raises `CommandError`."""
    prefix = prefixes.prefix_of(package, prefixes.installed())
    if prefix is None:
        raise CommandError(f"package '{package}' not found", "Build its workspace, and launch from there.")
    return prefix / "share" / package


class IfCondition:
    """Holds when a text is `true` or `1`."""

    holds_for = True

    def __init__(self, predicate_expression: Text) -> None:
        self.expression = predicate_expression

    def holds(self, context: Context) -> bool:
        """Return whether it holds. Raises `CommandError` for a text that is neither true nor false."""
        text = text_of(self.expression, context)
        if text.strip().lower() not in {"true", "1", "false", "0"}:
            raise CommandError(f"a condition must be true, false, 1 or 0, and not '{text}'")
        return (text.strip().lower() in {"true", "1"}) is self.holds_for


class UnlessCondition(IfCondition):
    """Holds when a text is `false` or `0`."""

    holds_for = False


class ParameterValue:
    """A parameter's value with its type: `ParameterValue(LaunchConfiguration('gain'), value_type=float)`."""

    def __init__(self, value: Any, *, value_type: Any = None) -> None:
        self.value, self.value_type = value, value_type

    def evaluate(self, context: Context) -> Any:
        """Return the value, converted to its type if one is given. Raises `CommandError` if it can't be."""
        if self.value_type is None:
            return parameter_of(self.value, context)
        read = yaml.safe_load(text_of(self.value, context)) if self.value_type is not str else None
        text = text_of(self.value, context)
        if self.value_type is str:
            return text
        if self.value_type in (bool, int, float) and isinstance(read, bool) is (self.value_type is bool):
            try:
                return self.value_type(read)
            except (TypeError, ValueError):
                pass
        raise CommandError(
            f"'{text}' can't be a parameter of type {getattr(self.value_type, '__name__', self.value_type)}"
        )


def parameter_of(value: Any, context: Context) -> Any:
    """Return a parameter's value as in a parameter file; the text of a substitution is read as YAML, as in ROS 2."""
    if isinstance(value, ParameterValue):
        return value.evaluate(context)
    if isinstance(value, Substitution) or (
        isinstance(value, list | tuple) and any(isinstance(part, Substitution) for part in value)
    ):
        return yaml.safe_load(text_of(value, context))
    return list(value) if isinstance(value, tuple) else value


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
class PushRosNamespace:
    """Puts the nodes after it, in its group, into a namespace."""

    namespace: Text
    condition: IfCondition | None = None


@dataclass
class GroupAction:
    """Actions together, under one condition or in one namespace."""

    actions: Sequence[Any]
    condition: IfCondition | None = None


@dataclass(kw_only=True)
class Node:
    """A node to start, as `ros2 run` would.

    `parameters` are dictionaries, and paths of parameter files; `remappings` are pairs (from, to). `output` is taken
    and changes nothing: all that a node prints is shown.
    """

    package: Text
    executable: Text
    name: Text | None = None
    namespace: Text | None = None
    parameters: Sequence[Mapping[Any, Any] | Text] = ()
    remappings: Sequence[tuple[Text, Text]] = ()
    arguments: Sequence[Text] = ()
    ros_arguments: Sequence[Text] = ()
    output: Text = "log"
    emulate_tty: bool = False
    condition: IfCondition | None = None


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
