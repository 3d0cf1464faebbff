"""Works out what a description comes to, step by step."""

from __future__ import annotations

import contextlib
import itertools
import math
import os
import re
import shlex
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import yaml

from ros_in_python.launch import actions as known
from ros_in_python.launch import events, lifecycle, markup_text
from ros_in_python.launch.changes import ContextChange, below
from ros_in_python.launch.conditions import truth_of
from ros_in_python.launch.parameters import NodeParameter, ParameterFile, parameter_of
from ros_in_python.launch.steps import DeferredAction, Emission, EventStep, HandlerRemoval, Later, ProcessToStart, Step
from ros_in_python.launch.substitutions import Context, NotYetKnownError, text_of, texts_of
from ros_in_python.ros2.cli import CommandError
from ros_in_python.ros2.executables import find

#: A file that includes itself is not followed any deeper than this.
_DEEPEST = 30
#: The option of `ros2 launch` that leaves composable nodes out.
WITHOUT_COMPOSABLE = "--without-composable-nodes"


@dataclass
class LaunchPlan:
    """Carries out a description: what it logs and which processes it starts. Parameter files go into `folder`.

    Composable nodes end it with an error, unless they are `left_out`.
    """

    folder: Path
    cwd: Path
    read: Callable[[Path], known.LaunchDescription]
    left_out: bool = False
    _files: itertools.count[int] = field(default_factory=lambda: itertools.count(1))

    def steps(self, entities: Sequence[Any], context: Context) -> Iterator[Step]:
        """Yield what is to be done, in order. Raises `CommandError`."""
        for entity in entities:
            try:
                if _holds(entity, context):
                    yield from self._steps_of(entity, context)
            except NotYetKnownError:
                yield DeferredAction(entity, context.copy())
            except known.PlacedError:
                raise
            except Exception as error:
                place = getattr(entity, "place", "") or context.file
                raise known.PlacedError(f"{place}: {_fault(error)}") from None

    def _steps_of(self, entity: Any, context: Context) -> Iterator[Step]:
        for kind in type(entity).__mro__:
            if carry_out := _HOW.get(kind):
                yield from carry_out(self, entity, context)
                return
        hint = " EmitEvent(event=…) makes an action of an event." if isinstance(entity, events.LaunchEvent) else ""
        raise CommandError(f"{entity!r} is not an action.{hint}")

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

    def _lifecycle_node(self, node: known.LifecycleNode, context: Context) -> Iterator[Step]:
        if node.name is None:
            raise CommandError("a LifecycleNode needs a name: by it, the launch changes its state")
        yield from self._node(node, context)
        if node.autostart:
            in_a_row = (lifecycle.CONFIGURE, lifecycle.ACTIVATE)
            yield from self.steps(list(lifecycle.transitions([node.node_name], in_a_row)), context)

    def _composable(self, action: Any, context: Context) -> Iterator[Step]:
        nodes = [node for node in action.composable_node_descriptions or () if _holds(node, context)]
        plugins = ", ".join(text_of(node.plugin, context) for node in nodes) or "no nodes yet"
        if not self.left_out:
            raise CommandError(
                f"composable nodes ({plugins}) are C++ libraries, which need a ROS installation.",
                f"`ros2 launch {WITHOUT_COMPOSABLE} …` starts all else.",
            )
        yield f"left out, as composable nodes need a ROS installation: {plugins}"

    def _ros_words(self, node: known.Node, context: Context) -> list[str]:
        name = text_of(node.name, context) if node.name is not None else ""
        namespace = _namespace(node, context)
        node.node_name = f"{namespace.rstrip('/')}/{name}"
        words = [text_of(word, context) for word in node.ros_arguments]
        words += ["-r", f"__node:={name}"] if name else []
        words += ["-r", f"__ns:={namespace}"] if namespace else []
        # As in ROS 2, what is written for one node comes before what is written for all, whichever comes later.
        owner = node.node_name if name and namespace else "/**"
        for parameters in context.parameters:
            words += ["--params-file", self._parameter_file(parameters, "/**", context)]
        for parameters in node.parameters:
            words += ["--params-file", self._parameter_file(parameters, owner, context)]
        own = [(text_of(old, context), text_of(new, context)) for old, new in node.remappings]
        return words + [word for old, new in (*context.remappings, *own) for word in ("-r", f"{old}:={new}")]

    def _parameter_file(self, parameters: Any, owner: str, context: Context) -> str:
        if isinstance(parameters, NodeParameter):
            parameters, owner = {parameters.name: parameters.value}, "/**"
        if isinstance(parameters, Mapping):
            values = _nested({text_of(key, context): value for key, value in parameters.items()}, context)
            return self._written(yaml.safe_dump({owner: {"ros__parameters": values}}))
        path = Path(text_of(parameters.file if isinstance(parameters, ParameterFile) else parameters, context))
        if not path.is_file():
            raise CommandError(f"the parameter file {path} does not exist.")
        if isinstance(parameters, ParameterFile) and parameters.allow_substs:
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
        name = text_of(process.name, context) if process.name is not None else Path(words[0].split()[0]).name
        yield from self._program(process, name, tuple(words), dict(os.environ), context)

    def _program(
        self, program: known.LaunchedProgram, name: str, argv: tuple[str, ...], env: dict[str, str], context: Context
    ) -> Iterator[Step]:
        if program.on_exit:
            yield from self._handler(events.OnProcessExit(target_action=program, on_exit=program.on_exit), context)
        try:
            known.line_of(program, name, "")
        except (LookupError, AttributeError, ValueError) as error:
            raise CommandError(f"output_format '{program.output_format}' can't be filled in: {_fault(error)}") from None
        argv = (*_prefix(program, argv[0], context), *argv)
        if isinstance(program, known.ExecuteProcess) and program.shell:
            argv = ("/bin/sh", "-c", " ".join(argv))
        if program.env is not None:
            env = texts_of(program.env, context)
        env = {**context.changed(env), **texts_of(program.additional_env, context), "PYTHONUNBUFFERED": "1"}
        cwd = text_of(program.cwd, context) if program.cwd is not None else None
        delay = (program.respawn_delay or 0.0) if _truth(program.respawn, context) else None
        most = program.respawn_max_retries if program.respawn_max_retries >= 0 else math.inf
        grace = (
            _seconds(program.sigterm_timeout, "sigterm_timeout", context),
            _seconds(program.sigkill_timeout, "sigkill_timeout", context),
        )
        yield ProcessToStart(name, argv, env, program, cwd, delay, most, grace)

    # --- what comes later

    def _timer(self, timer: known.TimerAction, context: Context) -> Iterator[Step]:
        seconds = _seconds(timer.period, "the period of a TimerAction", context)
        steps = tuple(self.steps(timer.actions, context.copy(is_later=True)))
        yield Later(seconds, steps, _truth(timer.cancel_on_shutdown, context))

    def _ros_timer(self, timer: known.RosTimer, context: Context) -> Iterator[Step]:
        if any(isinstance(table, Mapping) and table.get("use_sim_time") for table in context.parameters):
            raise CommandError("a RosTimer in simulated time is not supported here", "TimerAction counts real seconds.")
        yield from self._timer(timer, context)

    def _transitions(self, action: known.LifecycleTransition, context: Context) -> Iterator[Step]:
        names = [text_of(name, context) for name in action.lifecycle_node_names]
        numbers = [int(_seconds(number, "a transition_id", context)) for number in action.transition_ids]
        yield from self.steps(list(lifecycle.transitions(names, numbers)), context)

    def _handler(self, handler: events.EventHandler, context: Context) -> Iterator[Step]:
        reaction, later = handler.reaction, context.copy(is_later=True)
        known_now = None if callable(reaction) else tuple(self.steps(known.as_actions(reaction), later))
        yield EventStep(handler, known_now, later)

    def reaction(self, step: EventStep, event: Any) -> tuple[Step, ...] | None:
        """Return what a handler does about an event; None if it is not for it. Raises `CommandError`."""
        try:
            if not step.handler.matcher(event):
                return None
            if step.steps is not None:
                return self.due(step.steps, event)
            react: Any = step.handler.reaction
            answer = react(event, step.context)
        except CommandError:
            raise
        except Exception as error:
            raise CommandError(f"the handler of {type(event).__name__} fails: {_fault(error)}") from None
        return tuple(self.steps(known.as_actions(answer), self._now(step.context, event)))

    def due(self, steps: Sequence[Step], event: Any = None) -> tuple[Step, ...]:
        """Return steps whose time has come: what had to wait for it is worked out now. Raises `CommandError`."""
        found: list[Step] = []
        for step in steps:
            if isinstance(step, DeferredAction):
                found += self.steps([step.entity], self._now(step.context, event))
            else:
                found.append(step)
        return tuple(found)

    def _now(self, context: Context, event: Any) -> Context:
        return context.copy(is_later=False, locals=SimpleNamespace(event=event))

    # --- groups, files and functions

    def _group(self, group: known.GroupAction, context: Context) -> Iterator[Step]:
        inner, values = context.copy() if group.scoped else context, texts_of(group.launch_configurations, context)
        if group.scoped and not group.forwarding:
            inner.variables.clear()
            inner.reset_configurations(values)
        inner.values.update(values)
        yield from self.steps(group.actions, inner)

    def _include(self, action: known.IncludeLaunchDescription, context: Context) -> Iterator[Step]:
        arguments = action.launch_arguments
        for name, value in arguments.items() if isinstance(arguments, Mapping) else arguments or ():
            context.values[text_of(name, context)] = text_of(value, context)
        source = _source_of(action, context)
        if isinstance(source, Path):
            yield from self._included(source, context)
        else:
            yield from self.steps(source.entities, context)

    def _included(self, file: Path, context: Context) -> Iterator[Step]:
        outer, outer_depth = context.file, context.depth
        if outer_depth >= _DEEPEST:
            raise CommandError(f"{file} is included {_DEEPEST} files deep: does it include itself?")
        context.file, context.depth = file, outer_depth + 1
        with context.in_environment():
            description = self.read(file)
        yield from self.steps(description.entities, context)
        context.file, context.depth = outer, outer_depth

    def _opaque(self, action: known.Action, context: Context) -> Iterator[Step]:
        if context.is_later:
            yield DeferredAction(action, context.copy())
            return
        try:
            with context.in_environment():
                found = action.execute(context)
        except CommandError:
            raise
        except Exception as error:
            kind = type(action).__name__
            raise CommandError(f"the function of an {kind} fails: {_fault(error)}") from None
        yield from self.steps(known.as_actions(found), context)


def _namespace(node: known.Node, context: Context) -> str:
    """Return the namespace that a node gets from the launch file; "" if it keeps its own."""
    if node.namespace is None and context.namespace is None:
        return ""
    name = below(context.namespace, text_of(node.namespace, context) if node.namespace is not None else "")
    return name if name.startswith("/") else f"/{name}"


def _prefix(program: known.LaunchedProgram, executable: str, context: Context) -> list[str]:
    """Return the words before a program's own: those of the file, or of `launch-prefix` if its filter fits."""
    if program.prefix is not None:
        return shlex.split(text_of(program.prefix, context))
    is_meant = re.match(context.value_of("launch-prefix-filter") or "", Path(executable).name)
    return shlex.split(context.value_of("launch-prefix") or "") if is_meant else []


def _fault(error: Exception) -> str:
    return error.message if isinstance(error, CommandError) else f"{type(error).__name__}: {error}"


def _holds(entity: Any, context: Context) -> bool:
    condition = getattr(entity, "condition", None)
    return condition is None or condition.evaluate(context)


def _truth(value: Any, context: Context) -> bool:
    return value if isinstance(value, bool) else truth_of(value, context)


def _seconds(value: Any, what: str, context: Context) -> float:
    text = text_of(value, context)
    try:
        return float(text)
    except ValueError:
        raise CommandError(f"{what} is a number of seconds, and not '{text}'") from None


def _nested(table: Mapping[str, Any], context: Context) -> dict[str, Any]:
    """Return parameters with their values; a table in a table is a group of parameters."""
    return {
        name: _nested(value, context) if isinstance(value, Mapping) else parameter_of(value, context)
        for name, value in table.items()
    }


# --- what starts nothing


def _declare(plan: LaunchPlan, argument: known.DeclareLaunchArgument, context: Context) -> Iterator[Step]:
    if argument.name not in context.values:
        if argument.default_value is None:
            text = f" ({argument.description})" if argument.description else ""
            raise CommandError(f"the launch argument '{argument.name}'{text} is missing: give {argument.name}:=VALUE.")
        context.values[argument.name] = text_of(argument.default_value, context)
    context.asked.add(argument.name)
    value = context.values[argument.name]
    if argument.choices is not None and value not in argument.choices:
        raise CommandError(f"{argument.name}:={value} is not one of: {', '.join(argument.choices)}.")
    yield from ()


def _change(plan: LaunchPlan, action: ContextChange, context: Context) -> Iterator[Step]:
    action.change(context)
    yield from ()


#: How each kind of action is carried out.
_HOW: dict[type, Callable[[LaunchPlan, Any, Context], Iterator[Step]]] = {
    known.Node: LaunchPlan._node,
    known.ComposableNodeContainer: LaunchPlan._composable,
    known.LifecycleNode: LaunchPlan._lifecycle_node,
    known.LoadComposableNodes: LaunchPlan._composable,
    known.LifecycleTransition: LaunchPlan._transitions,
    known.ExecuteProcess: LaunchPlan._execute,
    known.TimerAction: LaunchPlan._timer,
    known.RosTimer: LaunchPlan._ros_timer,
    known.GroupAction: LaunchPlan._group,
    known.IncludeLaunchDescription: LaunchPlan._include,
    known.LaunchDescription: lambda plan, description, context: plan.steps(description.entities, context),
    known.OpaqueFunction: LaunchPlan._opaque,
    known.Action: LaunchPlan._opaque,
    events.RegisterEventHandler: lambda plan, action, context: plan._handler(action.event_handler, context),
    events.UnregisterEventHandler: lambda plan, action, context: iter([HandlerRemoval(action.event_handler)]),
    events.EmitEvent: lambda plan, action, context: iter([Emission(action.event)]),
    known.DeclareLaunchArgument: _declare,
    known.LogInfo: lambda plan, action, context: iter([text_of(action.msg, context)]),
    known.Shutdown: lambda plan, action, context: iter(
        [Emission(events.ShutdownRequested(text_of(action.reason, context)))]
    ),
    ContextChange: _change,
}


def arguments_of(
    entities: Sequence[Any], read: Callable[[Path], known.LaunchDescription], file: Path, depth: int = 0
) -> Iterator[known.DeclareLaunchArgument]:
    """Yield the arguments that a file's description declares, also in groups, and in files that it surely includes."""
    for entity in entities:
        if isinstance(entity, known.DeclareLaunchArgument):
            yield entity
        elif isinstance(entity, known.GroupAction):
            yield from arguments_of(entity.actions, read, file, depth)
        elif isinstance(entity, known.IncludeLaunchDescription) and depth < _DEEPEST:
            with contextlib.suppress(CommandError):  # which file it is depends on an argument
                source = _source_of(entity, Context(file=file))
                inner = source if isinstance(source, known.LaunchDescription) else read(source)
                yield from arguments_of(inner.entities, read, source if isinstance(source, Path) else file, depth + 1)


def _source_of(action: known.IncludeLaunchDescription, context: Context) -> known.LaunchDescription | Path:
    source = action.launch_description_source
    if isinstance(source, known.LaunchDescription):
        return source
    path = source.path if isinstance(source, known.LaunchDescriptionSource) else source
    file = Path(text_of(path, context)).absolute()
    if not file.is_file():
        raise CommandError(f"the launch file {file} does not exist.")
    return file
