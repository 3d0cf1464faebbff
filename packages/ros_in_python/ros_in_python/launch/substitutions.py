"""Texts that are known only when a launch file runs, under the names of ROS 2's own API."""

from __future__ import annotations

import os
import shlex
import subprocess
import sys
import uuid
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from importlib import import_module
from pathlib import Path
from types import MappingProxyType, SimpleNamespace
from typing import Any

from ros_in_python.ros2.cli import CommandError


@dataclass
class Context:
    """What is known while a description is carried out.

    `values` are those of the arguments, `parameters` and `remappings` hold for every node that follows, `variables` are
    the changes of its environment (None: removed), `file` is the launch file at hand, and `depth` how many include it.
    `locals` has the event of a handler. `asked` are the arguments that were declared or asked for. `is_later` says that
    what is planned now waits for a time or an event.
    """

    values: dict[str, str] = field(default_factory=dict)
    namespace: str | None = None
    parameters: list[Any] = field(default_factory=list)
    remappings: list[tuple[str, str]] = field(default_factory=list)
    variables: dict[str, str | None] = field(default_factory=dict)
    file: Path = Path()
    depth: int = 0
    locals: SimpleNamespace = field(default_factory=SimpleNamespace)
    is_later: bool = False
    asked: set[str] = field(default_factory=set)
    _kept: list[tuple[str, Context]] = field(default_factory=list)

    @property
    def launch_configurations(self) -> dict[str, str]:
        """The values of the arguments, by the name that functions in launch files use."""
        return self.values

    @property
    def environment(self) -> Mapping[str, str]:
        """The environment of programs that follow. To change it, a launch file has actions."""
        return MappingProxyType(self.changed(dict(os.environ)))

    def value_of(self, name: str) -> str | None:
        """Return the value of an argument; None if there is none."""
        self.asked.add(name)
        return self.values.get(name)

    def perform_substitution(self, substitution: Text) -> str:
        """Return the text that a substitution stands for, as functions in launch files ask for it."""
        return text_of(substitution, self)

    def copy(self, **changes: Any) -> Context:
        """Return a context of the same state, but for these changes, which a group may change for itself."""
        return replace(
            self,
            values=dict(self.values),
            parameters=list(self.parameters),
            remappings=list(self.remappings),
            variables=dict(self.variables),
            _kept=list(self._kept),
            **changes,
        )

    def changed(self, base: dict[str, str]) -> dict[str, str]:
        """Return an environment with the changes made."""
        all_set = {**base, **{name: value for name, value in self.variables.items() if value is not None}}
        return {name: value for name, value in all_set.items() if self.variables.get(name, "") is not None}

    @contextmanager
    def in_environment(self) -> Iterator[None]:
        """Let functions of launch files find the environment in `os.environ` inside the block, and change it there."""
        before, inside = dict(os.environ), dict(self.environment)
        _become(inside)
        try:
            yield
        finally:
            after = dict(os.environ)
            changes = {name for name in {*inside, *after} if inside.get(name) != after.get(name)}
            self.variables.update({name: after.get(name) for name in changes})
            _become(before)

    def reset_configurations(self, values: dict[str, str]) -> None:
        """Forget all arguments but these, and what holds for every node."""
        self.values, self.namespace, self.parameters, self.remappings = values, None, [], []

    def push(self, kind: str) -> None:
        """Keep the `configurations` or the `environment`."""
        self._kept.append((kind, self.copy()))

    def pop(self, kind: str) -> None:
        """Bring back what was kept last of this kind. Raises `CommandError` if there is nothing."""
        places = [place for place, (kept, _) in enumerate(self._kept) if kept == kind]
        if not places:
            raise CommandError(f"there are no {kind} to bring back: Push stands before Pop")
        _, state = self._kept.pop(places[-1])
        if kind == "environment":
            self.variables = state.variables
            return
        self.values, self.namespace = state.values, state.namespace
        self.parameters, self.remappings = state.parameters, state.remappings


def _become(environment: Mapping[str, str]) -> None:
    os.environ.clear()
    os.environ.update(environment)


class Substitution:
    """A text that is known only when the launch file runs."""

    def perform(self, context: Context) -> str:
        """Return the text. Raises `CommandError` if it can't be known."""
        raise NotImplementedError

    def describe(self) -> str:
        """Return what it is, for a launch file's own messages."""
        return f"{type(self).__name__}()"


#: A text, a substitution, or several of them in a row.
Text = Any


def text_of(value: Text, context: Context) -> str:
    """Return the text that a value stands for; a list of texts and substitutions is joined."""
    if isinstance(value, Substitution):
        return value.perform(context)
    if isinstance(value, list | tuple):
        return "".join(text_of(part, context) for part in value)
    return os.fspath(value) if isinstance(value, Path) else str(value)


def texts_of(table: Mapping[Any, Any], context: Context) -> dict[str, str]:
    """Return a table of texts, in which names and values were perhaps substitutions."""
    return {text_of(name, context): text_of(value, context) for name, value in table.items()}


class TextSubstitution(Substitution):
    """A plain text, for places that want a substitution."""

    def __init__(self, *, text: str) -> None:
        self.text = text

    def perform(self, context: Context) -> str:
        return self.text


class LaunchConfiguration(Substitution):
    """The value of a launch argument."""

    def __init__(self, variable_name: Text, *, default: Text | None = None) -> None:
        self.name, self.default = variable_name, default

    def perform(self, context: Context) -> str:
        """Return the argument's value, or the default. Raises `CommandError` if there is neither."""
        name = text_of(self.name, context)
        value = context.value_of(name)
        if value is not None:
            return value
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
        environment = context.environment
        if name in environment:
            return environment[name]
        if self.default is None:
            raise CommandError(f"environment variable '{name}' does not exist")
        return text_of(self.default, context)


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
        words = shlex.split(line)
        try:
            done = subprocess.run(words, env=dict(context.environment), capture_output=True, text=True, check=False)
        except OSError as error:
            raise CommandError(f"the command `{line}` can't be run: {error.strerror}", *_how_to_get(words[0])) from None
        if done.returncode or (done.stderr and on_stderr == "fail"):
            reason = f"exit code {done.returncode}" if done.returncode else "it wrote to stderr"
            raise CommandError(f"the command `{line}` failed ({reason}): {done.stderr.strip() or 'it said nothing'}")
        if done.stderr and on_stderr == "warn":
            print(done.stderr, end="", file=sys.stderr)
        return done.stdout + (done.stderr if on_stderr == "capture" else "")


def _how_to_get(program: str) -> list[str]:
    return ["`pip install xacro` brings it."] if Path(program).name == "xacro" else []


class AnonName(Substitution):
    """A name with a number, the same for the same name in one launch, and another one in each launch."""

    def __init__(self, name: Text) -> None:
        self.name = name

    def perform(self, context: Context) -> str:
        name = text_of(self.name, context)
        return context.values.setdefault(f"anon{name}", f"{name}_{os.getpid()}_{uuid.uuid4().hex[:8]}")


class NotYetKnownError(CommandError):
    """A text is known only when the event has happened."""


class LocalSubstitution(Substitution):
    """What a handler knows of its event: `LocalSubstitution('event.reason')`."""

    def __init__(self, expression: str, description: str | None = None) -> None:
        self.expression = expression

    def perform(self, context: Context) -> str:
        """Return it. Raises `CommandError` outside a handler, and for what the event does not have."""
        if context.is_later:
            raise NotYetKnownError(f"LocalSubstitution('{self.expression}') is known when the event has happened")
        value: Any = context.locals
        for name in self.expression.split("."):
            if not hasattr(value, name):
                raise CommandError(f"LocalSubstitution('{self.expression}'): there is no '{name}' here")
            value = getattr(value, name)
        return str(value)


class GlobalParameter(Substitution):
    """The value of a parameter that `SetParameter` gave all nodes: `launch_ros.substitutions.Parameter('gain')`."""

    def __init__(self, name: Text, *, default: Any = None) -> None:
        self.name, self.default = name, default

    def perform(self, context: Context) -> str:
        """Return its value as a text, or the default. Raises `CommandError` if there is neither."""
        name = text_of(self.name, context)
        tables = [table for table in context.parameters if isinstance(table, dict) and name in table]
        if tables:
            return str(tables[-1][name])
        if self.default is None:
            raise CommandError(f"the parameter '{name}' was not set for all nodes: SetParameter does that")
        return text_of(self.default, context)
