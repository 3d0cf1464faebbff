"""What starts nothing, but changes what holds for the actions after it, in its group."""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from ros_in_python.launch.actions import Action
from ros_in_python.launch.conditions import Condition, truth_of
from ros_in_python.launch.parameters import parameter_of
from ros_in_python.launch.substitutions import Context, Text, text_of, texts_of


@dataclass
class ContextChange(Action):
    """An action that is carried out by `change`, which may raise `CommandError`."""

    condition: Condition | None = field(default=None, kw_only=True)

    def change(self, context: Context) -> None:
        """Change the context."""
        raise NotImplementedError


@dataclass
class SetLaunchConfiguration(ContextChange):
    """Gives an argument a value."""

    name: Text
    value: Text

    def change(self, context: Context) -> None:
        context.values[text_of(self.name, context)] = text_of(self.value, context)


@dataclass
class UnsetLaunchConfiguration(ContextChange):
    """Removes an argument."""

    name: Text

    def change(self, context: Context) -> None:
        context.values.pop(text_of(self.name, context), None)


@dataclass
class ResetLaunchConfigurations(ContextChange):
    """Forgets all arguments, and what holds for all nodes; then sets these arguments."""

    launch_configurations: Mapping[Text, Text] | None = None

    def change(self, context: Context) -> None:
        context.reset_configurations(texts_of(self.launch_configurations or {}, context))


@dataclass
class PushLaunchConfigurations(ContextChange):
    """Keeps the arguments until `PopLaunchConfigurations`."""

    def change(self, context: Context) -> None:
        context.push("configurations")


@dataclass
class PopLaunchConfigurations(ContextChange):
    """Brings back the arguments that were kept last."""

    def change(self, context: Context) -> None:
        context.pop("configurations")


@dataclass
class PushRosNamespace(ContextChange):
    """Puts the nodes into a namespace."""

    namespace: Text

    def change(self, context: Context) -> None:
        """Go into the namespace, which is below the present one if it does not begin with a slash."""
        context.namespace = below(context.namespace, text_of(self.namespace, context))


@dataclass
class ParameterForAll(ContextChange):
    """Gives every node a parameter."""

    name: Text
    value: Any

    def change(self, context: Context) -> None:
        context.parameters.append({text_of(self.name, context): parameter_of(self.value, context)})


@dataclass
class SetParametersFromFile(ContextChange):
    """Gives every node the parameters of a file."""

    filename: Text

    def change(self, context: Context) -> None:
        context.parameters.append(text_of(self.filename, context))


@dataclass
class SetUseSimTime(ContextChange):
    """Lets every node use simulated time."""

    value: Any = True

    def change(self, context: Context) -> None:
        context.parameters.append({"use_sim_time": parameter_of(self.value, context)})


@dataclass
class SetRemap(ContextChange):
    """Remaps a name for every node."""

    src: Text
    dst: Text

    def change(self, context: Context) -> None:
        context.remappings.append((text_of(self.src, context), text_of(self.dst, context)))


@dataclass
class SetEnvironmentVariable(ContextChange):
    """Gives every program an environment variable."""

    name: Text
    value: Text

    def change(self, context: Context) -> None:
        context.variables[text_of(self.name, context)] = text_of(self.value, context)


@dataclass
class SetROSLogDir(ContextChange):
    """Sets the folder into which nodes write their log files."""

    new_log_dir: Text

    def change(self, context: Context) -> None:
        context.variables["ROS_LOG_DIR"] = text_of(self.new_log_dir, context)


@dataclass
class AppendEnvironmentVariable(ContextChange):
    """Appends to an environment variable of every program."""

    name: Text
    value: Text
    prepend: Any = False
    separator: Text = os.pathsep

    def change(self, context: Context) -> None:
        name, value = text_of(self.name, context), text_of(self.value, context)
        present = context.environment.get(name)
        parts = [value, present] if truth_of(str(self.prepend), context) else [present, value]
        context.variables[name] = text_of(self.separator, context).join(part for part in parts if part)


@dataclass
class UnsetEnvironmentVariable(ContextChange):
    """Removes an environment variable of every program."""

    name: Text

    def change(self, context: Context) -> None:
        context.variables[text_of(self.name, context)] = None


@dataclass
class ResetEnvironment(ContextChange):
    """Takes back all changes of the environment."""

    def change(self, context: Context) -> None:
        context.variables.clear()


@dataclass
class PushEnvironment(ContextChange):
    """Keeps the environment until `PopEnvironment`."""

    def change(self, context: Context) -> None:
        context.push("environment")


@dataclass
class PopEnvironment(ContextChange):
    """Brings back the environment that was kept last."""

    def change(self, context: Context) -> None:
        context.pop("environment")


def below(above: str | None, name: str) -> str:
    """Return a name in a namespace; one with a slash at its front stays as it is."""
    if not name:
        return above or ""
    return name if name.startswith("/") else f"{(above or '').rstrip('/')}/{name}"
