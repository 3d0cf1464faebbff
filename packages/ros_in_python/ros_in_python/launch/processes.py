"""The processes that a description stands for: each node's command, name and environment."""

from __future__ import annotations

import itertools
import os
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import yaml

from ros_in_python.launch import description as known
from ros_in_python.launch.description import Context, parameter_of, text_of
from ros_in_python.ros2.cli import CommandError
from ros_in_python.ros2.executables import find


@dataclass(frozen=True)
class ProcessToStart:
    """One node's process; `name` stands before each line that it prints: `joint_publisher-1`."""

    name: str
    argv: tuple[str, ...]
    env: Mapping[str, str]


@dataclass
class LaunchPlan:
    """Carries out a description: what it logs and which processes it starts. Parameter files go into `folder`."""

    folder: Path
    cwd: Path
    _files: itertools.count[int]

    @classmethod
    def into(cls, folder: Path, cwd: Path) -> LaunchPlan:
        """Make a plan whose parameter files go into `folder`; packages are looked up from `cwd`."""
        return cls(folder, cwd, itertools.count(1))

    def steps(self, entities: Sequence[Any], context: Context) -> Iterator[ProcessToStart | str]:
        """Yield the processes to start and the lines to log, in order. Raises `CommandError`."""
        for entity in entities:
            condition = getattr(entity, "condition", None)
            if condition is not None and not condition.holds(context):
                continue
            if isinstance(entity, known.GroupAction):
                # Within a group, a namespace holds for the group alone.
                yield from self.steps(entity.actions, replace(context))
            elif isinstance(entity, known.Node):
                yield self._process(entity, context)
            elif isinstance(entity, known.LogInfo):
                yield text_of(entity.msg, context)
            elif isinstance(entity, known.PushRosNamespace):
                context.namespace = _below(context.namespace, text_of(entity.namespace, context))
            elif isinstance(entity, known.DeclareLaunchArgument):
                _declare(entity, context)
            else:
                raise CommandError(f"a launch description can't hold a {type(entity).__name__}: {entity!r}")

    def _process(self, node: known.Node, context: Context) -> ProcessToStart:
        package, executable = text_of(node.package, context), text_of(node.executable, context)
        name = text_of(node.name, context) if node.name is not None else ""
        namespace = _below(context.namespace, text_of(node.namespace, context) if node.namespace is not None else "")
        found = find(package, executable, self.cwd)
        words = [text_of(word, context) for word in node.ros_arguments]
        words += ["-r", f"__node:={name}"] if name else []
        words += ["-r", f"__ns:={namespace}"] if namespace else []
        for given in node.parameters:
            words += ["--params-file", self._parameter_file(given, name, namespace, context)]
        for pair in node.remappings:
            words += ["-r", ":=".join(text_of(part, context) for part in pair)]
        arguments = [text_of(word, context) for word in node.arguments]
        argv = (*found.argv, *arguments, *(("--ros-args", *words) if words else ()))
        return ProcessToStart(executable, argv, {**found.env, "PYTHONUNBUFFERED": "1"})

    def _parameter_file(self, given: Any, name: str, namespace: str, context: Context) -> str:
        if not isinstance(given, Mapping):
            path = Path(text_of(given, context))
            if not path.is_file():
                raise CommandError(f"the parameter file {path} does not exist.")
            return os.fspath(path)
        values = {text_of(key, context): parameter_of(value, context) for key, value in given.items()}
        node = f"{namespace or ''}/{name}" if name else "/**"
        file = self.folder / f"launch_params_{next(self._files)}.yaml"
        file.write_text(yaml.safe_dump({node: {"ros__parameters": values}}), encoding="utf-8")
        return os.fspath(file)


def _below(above: str, name: str) -> str:
    if not name:
        return above
    return name if name.startswith("/") else f"{above}/{name}"


def _declare(argument: known.DeclareLaunchArgument, context: Context) -> None:
    if argument.name not in context.values:
        if argument.default_value is None:
            text = f" ({argument.description})" if argument.description else ""
            raise CommandError(f"the launch argument '{argument.name}'{text} is missing: give {argument.name}:=VALUE.")
        context.values[argument.name] = text_of(argument.default_value, context)
    value = context.values[argument.name]
    if argument.choices is not None and value not in argument.choices:
        raise CommandError(f"{argument.name}:={value} is not one of: {', '.join(argument.choices)}.")


def arguments_of(entities: Sequence[Any]) -> Iterator[known.DeclareLaunchArgument]:
    """Yield the arguments that a description declares, in groups as well."""
    for entity in entities:
        if isinstance(entity, known.DeclareLaunchArgument):
            yield entity
        elif isinstance(entity, known.GroupAction):
            yield from arguments_of(entity.actions)
