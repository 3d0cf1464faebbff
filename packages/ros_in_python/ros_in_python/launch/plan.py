"""What a description comes to, in order: programs to start, lines to log, and what waits for a time or an event."""

from __future__ import annotations

import itertools
import os
import shlex
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeAlias

import yaml

from ros_in_python.launch import actions as known
from ros_in_python.launch import events, markup_text
from ros_in_python.launch.conditions import truth_of
from ros_in_python.launch.parameters import NodeParameter, ParameterFile, parameter_of
from ros_in_python.launch.substitutions import Context, text_of
from ros_in_python.ros2.cli import CommandError
from ros_in_python.ros2.executables import find

#: A file that includes itself is not followed any deeper than this.
_DEEPEST = 30


@dataclass(frozen=True)
class ProcessToStart:
    """One program's process; `name` stands before each line that it prints: `joint_publisher-1`.

    `respawn_s` is how long after its end it starts again (s); None if it does not.
    """

    name: str
    argv: tuple[str, ...]
    env: Mapping[str, str]
    cwd: str | None = None
    action: known.LaunchedProgram | None = None
    respawn_s: float | None = None


@dataclass(frozen=True)
class Later:
    """Steps that come after some seconds."""

    seconds: float
    steps: tuple[Step, ...]


@dataclass(frozen=True)
class EventStep:
    """A handler that holds from here on. `steps` are those of its actions; None if a function gives them."""

    handler: events.Handler
    steps: tuple[Step, ...] | None
    context: Context


@dataclass(frozen=True)
class EndOfLaunch:
    """Every program is asked to end."""

    reason: str


Step: TypeAlias = ProcessToStart | str | Later | EventStep | EndOfLaunch


@dataclass
class LaunchPlan:
    """Carries out a description: what it logs and which processes it starts. Parameter files go into `folder`."""

    folder: Path
    cwd: Path
    read: Callable[[Path], known.LaunchDescription]
    _files: itertools.count[int]

    @classmethod
    def into(cls, folder: Path, cwd: Path, read: Callable[[Path], known.LaunchDescription]) -> LaunchPlan:
        """Make a plan whose parameter files go into `folder`; packages are looked up from `cwd`, files are `read`."""
        return cls(folder, cwd, read, itertools.count(1))

    def steps(self, entities: Sequence[Any], context: Context) -> Iterator[Step]:
        """Yield what is to be done, in order. Raises `CommandError`."""
        for entity in entities:
            condition = getattr(entity, "condition", None)
            if condition is None or condition.holds(context):
                yield from self._steps_of(entity, context)

    def _steps_of(self, entity: Any, context: Context) -> Iterator[Step]:
        for kind in type(entity).__mro__:
            if carry_out := _HOW.get(kind):
                yield from carry_out(self, entity, context)
                return
        raise CommandError(f"a launch description can't hold a {type(entity).__name__}: {entity!r}")

    # --- programs

    def _node(self, node: known.Node, context: Context) -> Iterator[Step]:
        executable = text_of(node.executable, context)
        argv: tuple[str, ...] = (executable,)
        env = dict(os.environ)
        if node.package is not None:
            invocation = find(text_of(node.package, context), executable, self.cwd)
            argv, env = tuple(invocation.argv), dict(invocation.env)
        argv += tuple(text_of(word, context) for word in node.arguments)
        if words := self._ros_words(node, context):
            argv += ("--ros-args", *words)
        name = text_of(node.exec_name, context) if node.exec_name is not None else Path(executable).name
        yield from self._program(node, name, argv, env, context)

    def _ros_words(self, node: known.Node, context: Context) -> list[str]:
        name = text_of(node.name, context) if node.name is not None else ""
        namespace = _below(context.namespace, text_of(node.namespace, context) if node.namespace is not None else "")
        words = [text_of(word, context) for word in node.ros_arguments]
        words += ["-r", f"__node:={name}"] if name else []
        words += ["-r", f"__ns:={namespace}"] if namespace else []
        for parameters in (*context.parameters, *node.parameters):
            words += ["--params-file", self._parameter_file(parameters, name, namespace, context)]
        own = [(text_of(old, context), text_of(new, context)) for old, new in node.remappings]
        return words + [word for old, new in (*context.remappings, *own) for word in ("-r", f"{old}:={new}")]

    def _parameter_file(self, given: Any, name: str, namespace: str, context: Context) -> str:
        if isinstance(given, NodeParameter):
            given = {given.name: given.value}
        if isinstance(given, Mapping):
            values = _nested({text_of(key, context): value for key, value in given.items()}, context)
            node = f"{namespace or ''}/{name}" if name else "/**"
            return self._written(yaml.safe_dump({node: {"ros__parameters": values}}))
        path = Path(text_of(given.file if isinstance(given, ParameterFile) else given, context))
        if not path.is_file():
            raise CommandError(f"the parameter file {path} does not exist.")
        if isinstance(given, ParameterFile) and given.allow_substs:
            return self._written(text_of(markup_text.parse(path.read_text(encoding="utf-8")), context))
        return os.fspath(path)

    def _written(self, text: str) -> str:
        file = self.folder / f"launch_params_{next(self._files)}.yaml"
        file.write_text(text, encoding="utf-8")
        return os.fspath(file)

    def _execute(self, process: known.ExecuteProcess, context: Context) -> Iterator[Step]:
        words = [text_of(word, context) for word in process.cmd]
        if not words:
            raise CommandError("ExecuteProcess has an empty cmd")
        argv = ("/bin/sh", "-c", " ".join(words)) if process.shell else tuple(words)
        name = text_of(process.name, context) if process.name is not None else Path(words[0].split()[0]).name
        yield from self._program(process, name, argv, dict(os.environ), context)

    def _program(
        self, program: known.LaunchedProgram, name: str, argv: tuple[str, ...], env: dict[str, str], context: Context
    ) -> Iterator[Step]:
        if program.on_exit:
            yield from self._handler(events.OnProcessExit(target_action=program, on_exit=program.on_exit), context)
        if program.prefix is not None:
            argv = (*shlex.split(text_of(program.prefix, context)), *argv)
        if program.env is not None:
            env = _texts(program.env, context)
        env = {**context.environment(env), **_texts(program.additional_env, context), "PYTHONUNBUFFERED": "1"}
        cwd = text_of(program.cwd, context) if program.cwd is not None else None
        respawns = truth_of(str(program.respawn) if isinstance(program.respawn, bool) else program.respawn, context)
        delay = (program.respawn_delay or 0.0) if respawns else None
        yield ProcessToStart(name, argv, env, cwd, program, delay)

    # --- what comes later

    def _timer(self, timer: known.TimerAction, context: Context) -> Iterator[Step]:
        text = text_of(timer.period, context)
        try:
            seconds = float(text)
        except ValueError:
            raise CommandError(f"the period of a TimerAction is a number of seconds, and not '{text}'") from None
        yield Later(seconds, tuple(self.steps(timer.actions, context.copy())))

    def _register(self, action: events.RegisterEventHandler, context: Context) -> Iterator[Step]:
        yield from self._handler(action.event_handler, context)

    def _handler(self, handler: events.Handler, context: Context) -> Iterator[Step]:
        reaction, later = handler.reaction, context.copy()
        known_now = None if callable(reaction) else tuple(self.steps(known.as_actions(reaction), later))
        yield EventStep(handler, known_now, later)

    def reaction(self, step: EventStep, event: Any) -> tuple[Step, ...]:
        """Return what a handler does about an event. Raises `CommandError`."""
        if step.steps is not None:
            return step.steps
        try:
            react: Any = step.handler.reaction
            answer = react(event, step.context)
        except Exception as error:
            raise CommandError(f"the handler of {type(event).__name__} fails: {_described(error)}") from None
        return tuple(self.steps(known.as_actions(answer), step.context))

    # --- groups, files and functions

    def _group(self, group: known.GroupAction, context: Context) -> Iterator[Step]:
        inner = context.copy() if group.scoped else context
        inner.values.update(_texts(group.launch_configurations, context))
        yield from self.steps(group.actions, inner)

    def _include(self, action: known.IncludeLaunchDescription, context: Context) -> Iterator[Step]:
        given = action.launch_arguments
        for name, value in given.items() if isinstance(given, Mapping) else given or ():
            context.values[text_of(name, context)] = text_of(value, context)
        source = action.launch_description_source
        if isinstance(source, known.LaunchDescription):
            yield from self.steps(source.entities, context)
            return
        file = Path(text_of(known.path_of_source(source), context))
        if not file.is_file():
            raise CommandError(f"the launch file {file} does not exist.")
        yield from self._included(file, context)

    def _included(self, file: Path, context: Context) -> Iterator[Step]:
        outer, outer_depth = context.file, context.depth
        if outer_depth >= _DEEPEST:
            raise CommandError(f"{file} is included {_DEEPEST} files deep: does it include itself?")
        context.file, context.depth = file.absolute(), outer_depth + 1
        yield from self.steps(self.read(file).entities, context)
        context.file, context.depth = outer, outer_depth

    def _opaque(self, action: known.OpaqueFunction, context: Context) -> Iterator[Step]:
        try:
            found = action.function(context, *action.args, **action.kwargs)
        except CommandError:
            raise
        except Exception as error:
            raise CommandError(f"the function of an OpaqueFunction fails: {_described(error)}") from None
        yield from self.steps(known.as_actions(found), context)


def _described(error: Exception) -> str:
    return f"{type(error).__name__}: {error}"


def _texts(table: Mapping[Any, Any], context: Context) -> dict[str, str]:
    return {text_of(name, context): text_of(value, context) for name, value in table.items()}


def _nested(table: Mapping[str, Any], context: Context) -> dict[str, Any]:
    """Return parameters with their values; a table in a table is a group of parameters."""
    return {
        name: _nested(value, context) if isinstance(value, Mapping) else parameter_of(value, context)
        for name, value in table.items()
    }


def _below(above: str, name: str) -> str:
    if not name:
        return above
    return name if name.startswith("/") else f"{above}/{name}"


# --- what starts nothing, and changes the context


def _declare(plan: LaunchPlan, argument: known.DeclareLaunchArgument, context: Context) -> Iterator[Step]:
    if argument.name not in context.values:
        if argument.default_value is None:
            text = f" ({argument.description})" if argument.description else ""
            raise CommandError(f"the launch argument '{argument.name}'{text} is missing: give {argument.name}:=VALUE.")
        context.values[argument.name] = text_of(argument.default_value, context)
    value = context.values[argument.name]
    if argument.choices is not None and value not in argument.choices:
        raise CommandError(f"{argument.name}:={value} is not one of: {', '.join(argument.choices)}.")
    yield from ()


def _log(plan: LaunchPlan, action: known.LogInfo, context: Context) -> Iterator[Step]:
    yield text_of(action.msg, context)


def _end(plan: LaunchPlan, action: known.Shutdown, context: Context) -> Iterator[Step]:
    yield EndOfLaunch(text_of(action.reason, context))


def _emit(plan: LaunchPlan, action: events.EmitEvent, context: Context) -> Iterator[Step]:
    if not isinstance(action.event, events.ShutdownRequested):
        raise CommandError(f"EmitEvent is supported with the event Shutdown alone, not with {action.event!r}")
    yield EndOfLaunch(action.event.reason)


def _changes(change: Callable[[Any, Context], None]) -> Callable[[LaunchPlan, Any, Context], Iterator[Step]]:
    def carry_out(plan: LaunchPlan, action: Any, context: Context) -> Iterator[Step]:
        change(action, context)
        yield from ()

    return carry_out


def _push(action: known.PushRosNamespace, context: Context) -> None:
    context.namespace = _below(context.namespace, text_of(action.namespace, context))


def _configure(action: known.SetLaunchConfiguration, context: Context) -> None:
    context.values[text_of(action.name, context)] = text_of(action.value, context)


def _parameter(action: known.ParameterForAll, context: Context) -> None:
    context.parameters.append({text_of(action.name, context): parameter_of(action.value, context)})


def _parameters(action: known.SetParametersFromFile, context: Context) -> None:
    context.parameters.append(text_of(action.filename, context))


def _sim_time(action: known.SetUseSimTime, context: Context) -> None:
    context.parameters.append({"use_sim_time": parameter_of(action.value, context)})


def _remap(action: known.SetRemap, context: Context) -> None:
    context.remappings.append((text_of(action.src, context), text_of(action.dst, context)))


def _variable(action: known.SetEnvironmentVariable, context: Context) -> None:
    context.variables[text_of(action.name, context)] = text_of(action.value, context)


def _append(action: known.AppendEnvironmentVariable, context: Context) -> None:
    name, value = text_of(action.name, context), text_of(action.value, context)
    present = context.environment(dict(os.environ)).get(name)
    first = [value, present] if truth_of(str(action.prepend), context) else [present, value]
    context.variables[name] = text_of(action.separator, context).join(part for part in first if part)


def _unset(action: known.UnsetEnvironmentVariable, context: Context) -> None:
    context.variables[text_of(action.name, context)] = None


#: How each kind of action is carried out.
_HOW: dict[type, Callable[[LaunchPlan, Any, Context], Iterator[Step]]] = {
    known.Node: LaunchPlan._node,
    known.ExecuteProcess: LaunchPlan._execute,
    known.TimerAction: LaunchPlan._timer,
    events.RegisterEventHandler: LaunchPlan._register,
    known.GroupAction: LaunchPlan._group,
    known.IncludeLaunchDescription: LaunchPlan._include,
    known.OpaqueFunction: LaunchPlan._opaque,
    known.DeclareLaunchArgument: _declare,
    known.LogInfo: _log,
    known.Shutdown: _end,
    events.EmitEvent: _emit,
    known.PushRosNamespace: _changes(_push),
    known.SetLaunchConfiguration: _changes(_configure),
    known.ParameterForAll: _changes(_parameter),
    known.SetParametersFromFile: _changes(_parameters),
    known.SetUseSimTime: _changes(_sim_time),
    known.SetRemap: _changes(_remap),
    known.SetEnvironmentVariable: _changes(_variable),
    known.AppendEnvironmentVariable: _changes(_append),
    known.UnsetEnvironmentVariable: _changes(_unset),
}


def arguments_of(entities: Sequence[Any]) -> Iterator[known.DeclareLaunchArgument]:
    """Yield the arguments that a description declares, in groups as well."""
    for entity in entities:
        if isinstance(entity, known.DeclareLaunchArgument):
            yield entity
        elif isinstance(entity, known.GroupAction):
            yield from arguments_of(entity.actions)
