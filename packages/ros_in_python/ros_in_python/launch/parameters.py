"""Parameters of nodes in launch files: values with types, and parameter files."""

from __future__ import annotations

from typing import Any, get_args, get_origin

import yaml

from ros_in_python.launch.substitutions import Context, Substitution, Text, text_of
from ros_in_python.ros2.cli import CommandError

#: How much of a value a message shows (characters).
_SHOWN = 60


class ParameterValue:
    """A parameter's value with its type: `ParameterValue(LaunchConfiguration('gain'), value_type=float)`."""

    def __init__(self, value: Any, *, value_type: Any = None) -> None:
        self.value, self.value_type = value, value_type

    def evaluate(self, context: Context) -> Any:
        """Return the value, converted to its type if one is given. Raises `CommandError` if it can't be."""
        if self.value_type is None:
            return parameter_of(self.value, context)
        if get_origin(self.value_type) is list:
            items = parameter_of(self.value, context)
            if not isinstance(items, list):
                raise _misfit(items, "list")
            return [_converted(item, get_args(self.value_type)[0]) for item in items]
        text = text_of(self.value, context)
        return text if self.value_type is str else _converted(yaml.safe_load(text), self.value_type)


def _converted(value: Any, kind: Any) -> Any:
    if kind is str or (kind in (bool, int, float) and isinstance(value, bool) is (kind is bool)):
        try:
            return kind(value)
        except (TypeError, ValueError):
            pass
    raise _misfit(value, getattr(kind, "__name__", kind))


def _misfit(value: Any, kind: str) -> CommandError:
    return CommandError(f"'{value}' can't be a parameter of type {kind}")


class ParameterFile:
    """A file of parameters; with `allow_substs`, `$(var NAME)` and the like in it are replaced."""

    def __init__(self, param_file: Text, *, allow_substs: Any = False) -> None:
        self.file, self.allow_substs = param_file, allow_substs


class NodeParameter:
    """One parameter with its name: `Parameter('gain', 2.0)`."""

    def __init__(self, name: Text, value: Any, *, value_type: Any = None) -> None:
        self.name = name
        self.value = ParameterValue(value, value_type=value_type) if value_type else value


def parameter_of(value: Any, context: Context) -> Any:
    """Return a parameter's value as in a parameter file; the text of a substitution is read as YAML, as in ROS 2.

    A list of texts and substitutions is one text; each list within a list is one as well. Raises `CommandError` for a
    text that is no parameter's value in YAML, such as a robot's description.
    """
    if isinstance(value, ParameterValue):
        return value.evaluate(context)
    if not isinstance(value, list | tuple):
        return _read(text_of(value, context)) if isinstance(value, Substitution) else value
    if any(isinstance(part, list | tuple) for part in value):
        return [_read(text_of(part, context)) for part in value]
    if any(isinstance(part, Substitution) for part in value):
        return _read(text_of(value, context))
    # As in ROS 2, whole numbers between others are floats; a parameter has one type.
    return list(map(float, value)) if {type(part) for part in value} == {int, float} else list(value)


def _read(text: str) -> Any:
    try:
        value = yaml.safe_load(text or "''")
    except yaml.YAMLError:
        value = None
    if value is None or isinstance(value, dict):
        start = text if len(text) < _SHOWN else f"{text[:_SHOWN]}…"
        raise CommandError(
            f"'{start}' is not a parameter's value in YAML.", "ParameterValue(…, value_type=str) makes a text of it."
        )
    return value
