"""Texts that are known only when a launch file runs, under the names of ROS 2's own API."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field, replace
from importlib import import_module
from pathlib import Path
from typing import Any

from interface_compiler import prefixes
from ros_in_python.ros2.cli import CommandError


@dataclass
class Context:
    """What is known while a description is carried out.

    `values` are those of the arguments, `parameters` and `remappings` hold for every node that follows, `variables` are
    the changes of its environment (None: removed), `file` is the launch file at hand, and `depth` how many include it.
    """

    values: dict[str, str] = field(default_factory=dict)
    namespace: str = ""
    parameters: list[Any] = field(default_factory=list)
    remappings: list[tuple[str, str]] = field(default_factory=list)
    variables: dict[str, str | None] = field(default_factory=dict)
    file: Path = Path()
    depth: int = 0

    @property
    def launch_configurations(self) -> dict[str, str]:
        """The values of the arguments, by the name that functions in launch files use."""
        return self.values

    def copy(self) -> Context:
        """Return a context of the same state, which a group may change for itself."""
        return replace(
            self,
            values=dict(self.values),
            parameters=list(self.parameters),
            remappings=list(self.remappings),
            variables=dict(self.variables),
        )

    def environment(self, base: dict[str, str]) -> dict[str, str]:
        """Return an environment with the changes made."""
        changed = {**base, **{name: value for name, value in self.variables.items() if value is not None}}
        return {name: value for name, value in changed.items() if self.variables.get(name, "") is not None}


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

    def __init__(self, variable_name: Text, *, default: Text | None = None) -> None:
        self.name, self.default = variable_name, default

    def perform(self, context: Context) -> str:
        """Return the argument's value, or the default. Raises `CommandError` if there is neither."""
        name = text_of(self.name, context)
        if name in context.values:
            return context.values[name]
        if self.default is None:
            known = ", ".join(context.values) or "none"
            raise CommandError(
                f"launch configuration '{name}' does not exist",
                f"Declare it before it is used: DeclareLaunchArgument('{name}'). Declared so far: {known}.",
            )
        return text_of(self.default, context)


class EnvironmentVariable(Substitution):
    """The value of an environment variable."""

    def __init__(self, name: Text, *, default_value: Text | None = None) -> None:
        self.name, self.default = name, default_value

    def perform(self, context: Context) -> str:
        """Return the variable's value, or the default. Raises `CommandError` if there is neither."""
        name = text_of(self.name, context)
        environment = context.environment(dict(os.environ))
        if name in environment:
            return environment[name]
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
        package = text_of(self.package, context)
        return os.fspath(prefix_of(package) / "share" / package)


class FindPackagePrefix(FindPackageShare):
    """The folder in which a package is installed."""

    def perform(self, context: Context) -> str:
        """Return the folder's path. Raises `CommandError` if the package is not installed."""
        return os.fspath(prefix_of(text_of(self.package, context)))


class ExecutableInPackage(Substitution):
    """The path of a package's executable."""

    def __init__(self, executable: Text, package: Text) -> None:
        self.executable, self.package = executable, package

    def perform(self, context: Context) -> str:
        """Return the path. Raises `CommandError` if there is none."""
        package, name = text_of(self.package, context), text_of(self.executable, context)
        file = prefix_of(package) / "lib" / package / name
        if not file.is_file():
            raise CommandError(f"the package '{package}' has no executable '{name}'")
        return os.fspath(file)


def prefix_of(package: str) -> Path:
    """Return the folder in which a package is installed in this environment. Raises `CommandError`."""
    prefix = prefixes.prefix_of(package, prefixes.installed())
    if prefix is None:
        raise CommandError(f"package '{package}' not found", "Build its workspace, and launch from there.")
    return prefix


class FindExecutable(Substitution):
    """The path of a program on PATH."""

    def __init__(self, *, name: Text) -> None:
        self.name = name

    def perform(self, context: Context) -> str:
        """Return the path. Raises `CommandError` if there is no such program."""
        name = text_of(self.name, context)
        path = shutil.which(name)
        if path is None:
            raise CommandError(f"executable '{name}' not found on the PATH")
        return path


class ThisLaunchFile(Substitution):
    """The path of the launch file that is read."""

    def perform(self, context: Context) -> str:
        """Return the path."""
        return os.fspath(context.file)


class ThisLaunchFileDir(Substitution):
    """The folder of the launch file that is read."""

    def perform(self, context: Context) -> str:
        """Return the folder's path."""
        return os.fspath(context.file.parent)


class PythonExpression(Substitution):
    """The value of a Python expression, in which the functions and constants of `python_modules` have their names."""

    def __init__(self, expression: Text, python_modules: Sequence[Text] = ("math",)) -> None:
        self.expression, self.modules = expression, python_modules

    def perform(self, context: Context) -> str:
        """Return the value as a text. Raises `CommandError` if Python can't work it out."""
        text = text_of(self.expression, context)
        names: dict[str, Any] = {}
        for name in (text_of(module, context) for module in self.modules):
            module = import_module(name)
            names |= {**vars(module), name: module}
        try:
            return str(eval(text, names))
        except Exception as error:
            raise CommandError(f"the expression `{text}` fails: {type(error).__name__}: {error}") from None


class CommandOutput(Substitution):
    """What a command prints, such as `xacro robot.urdf.xacro`. What it says on stderr is shown."""

    def __init__(self, command: Text, *, on_stderr: Text = "fail") -> None:
        self.command, self.on_stderr = command, on_stderr

    def perform(self, context: Context) -> str:
        """Return the command's output. Raises `CommandError` if it fails, or says something on stderr."""
        line, on_stderr = text_of(self.command, context), text_of(self.on_stderr, context)
        environment = context.environment(dict(os.environ))
        done = subprocess.run(line, shell=True, env=environment, capture_output=True, text=True, check=False)
        if done.returncode or (done.stderr and on_stderr == "fail"):
            reason = f"exit code {done.returncode}" if done.returncode else "it wrote to stderr"
            raise CommandError(f"the command `{line}` failed ({reason}): {done.stderr.strip() or 'it said nothing'}")
        if done.stderr and on_stderr == "warn":
            print(done.stderr, end="", file=sys.stderr)
        return done.stdout + (done.stderr if on_stderr == "capture" else "")
