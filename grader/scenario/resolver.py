"""Completes a scenario with the types that exercise.toml declares, and checks every value in it."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import replace
from typing import Any, NoReturn, TypeVar

from grader.exercise.computing_limit import computing_limit
from grader.exercise.exercise import Exercise, ExerciseError, ServiceOrAction
from grader.exercise.imported_files import with_modules
from grader.exercise.modules import error_in, see_that_students_have
from grader.recording.events import Fields
from grader.recording.types import CHANGE_STATE, TRANSITIONS, message_class
from grader.scenario.code import AuthorCode
from grader.scenario.command_line import programs_of
from grader.scenario.scenario import (
    SECOND,
    START,
    CancelAll,
    CancelGoal,
    ComeBack,
    Companion,
    GetParameter,
    Kill,
    Leave,
    Message,
    Request,
    Scenario,
    SendGoal,
    SetParameter,
    StartProgram,
    Step,
    Subscribe,
    ToWorld,
    Transition,
)
from grader.scenario.servers import ActionServer, GoalScript, Reply, Server
from grader.scenario.values import InvalidValue, checked_fields
from grader.scenario.world import World
from interface_compiler import prefixes

_NAMESPACE = re.compile(r"(/?[A-Za-z_][A-Za-z0-9_]*)+/?|/")
_TYPE = re.compile(r"[a-z][a-z0-9_]*/(?P<kind>msg|srv|action)/[A-Z][A-Za-z0-9]*")
_KINDS = {"msg": "message", "srv": "service", "action": "action"}

#: How long a scenario may last, in seconds of simulated time. Later ends are slips, such as nanoseconds for seconds.
LONGEST_S = 3600

Typed = TypeVar("Typed", Message, Request, SendGoal, Subscribe, Server, ActionServer)


def resolved(exercise: Exercise, scenario: Scenario) -> Scenario:
    """Return `scenario` with all types filled in and its files read.

    Raises `ExerciseError`, which names the line of scenarios.py, for every mistake.
    """
    return Resolver(exercise, scenario).scenario()


class Resolver:
    """Resolves one scenario."""

    def __init__(self, exercise: Exercise, scenario: Scenario) -> None:
        self._exercise, self._scenario = exercise, scenario
        self._topics = {topic.name: topic.type for topic in (*exercise.outputs, *exercise.inputs)}
        self._known: dict[str, frozenset[str]] = {}

    def scenario(self) -> Scenario:
        """Return the resolved scenario: see `resolved`."""
        original = self._scenario
        self._timing()
        self._within_its_end()
        self._parameters()
        self._see_namespaces()
        self._see_programs()
        self._see_launch()
        found = replace(
            original,
            messages=tuple(self._message(message) for message in original.messages),
            servers=tuple(self._server(server) for server in original.servers),
            companions=tuple(self._companion(one) for one in original.companions),
            steps=(),
        )
        steps = tuple(self._step(step) for step in original.steps)
        self._see_world()
        return replace(found, steps=steps)

    def _see_launch(self) -> None:
        """Refuse what a launch file sets by itself."""
        names = ("programs", "parameters", "remappings", "namespace")
        for name in names if self._exercise.nodes else ():
            if getattr(self._scenario, name):
                fix = 'Leave it to the launch file. A scenario gives it launch arguments: arguments=("speed:=2.0",).'
                self._fault(0, f"{name} is given, but the submission is a launch file", fix)

    # --- what goes wrong

    def _fault(self, line: int, found: str, fix: str) -> NoReturn:
        place = line or self._scenario.line
        raise ExerciseError(self._exercise.scenarios_file, found, fix, place or None)

    def _timing(self) -> None:
        scenario = self._scenario
        if not scenario.messages and not scenario.steps and not scenario.duration:
            fix = "Add steps or messages, or give it a duration, such as duration=5.0."
            self._fault(0, f"the scenario {scenario.name} has no messages, no other steps and no duration", fix)
        for name in ("duration", "rate"):
            value = getattr(scenario, name)
            if value is not None and (isinstance(value, bool) or not isinstance(value, (int, float)) or value < 0):
                self._fault(0, f"{name}={value!r}", "Give a number that is not negative.")
        if scenario.rate == 0:
            self._fault(0, "rate=0", "Give how often /clock is published, such as rate=20.0 (Hz), or leave it out.")
        if scenario.seconds > LONGEST_S:
            fix = f"Give at most {LONGEST_S} s of simulated time."
            self._fault(0, f"the scenario {scenario.name} lasts {scenario.seconds:g} s", fix)
        if scenario.computer_time not in ("apart", "simulated"):
            self._fault(0, f"computer_time={scenario.computer_time!r}", 'Give "apart" or "simulated".')

    def _within_its_end(self) -> None:
        """Refuse what would never happen, because the scenario is over before."""
        scenario = self._scenario
        if not scenario.duration:
            return
        end = START + round(scenario.duration * SECOND)
        for step in scenario.content:
            if step.at > end:
                self._too_late(getattr(step, "line", 0), "a step", (step.at - START) / SECOND)
        for program in scenario.programs:
            self._check_times(0, program.id, starts=program.starts, killed=program.killed)
        for server in scenario.servers:
            self._check_times(server.line, server.name, appears=server.appears, gone=server.gone, back=server.back)

    def _check_times(self, line: int, name: str, **times: float | None) -> None:
        for word, seconds in times.items():
            if seconds is not None and seconds > self._scenario.duration:
                self._too_late(line, f"{word} of {name}", seconds)

    def _too_late(self, line: int, event: str, seconds: float) -> NoReturn:
        name, duration = self._scenario.name, self._scenario.duration
        found = f"{event} comes {seconds:g} s after the start, but the scenario {name} ends after {duration:g} s"
        self._fault(line, found, "Give it a longer duration, or an earlier step.")

    def _parameters(self) -> None:
        programs = [entry for one in self._scenario.programs for entry in one.parameters.items()]
        for name, value in [*self._scenario.parameters.items(), *programs]:
            if not isinstance(value, (bool, int, float, str, list, tuple)):
                found = f"the parameter {name} is {type(value).__name__}"
                self._fault(0, found, "Give a number, a text, a bool or a list of these.")

    # --- types

    def _typed(self, step: Typed, name: str, kind: str, declared: str | None, table: str) -> Typed:
        """Return `step` with its type, which is of this kind."""
        type_name = step.type or declared
        if not type_name:
            fix = f"Declare it in exercise.toml under [[{table}]], or write its type after its name."
            self._fault(step.line, f"the type of {name} is not known", fix)
        match = _TYPE.fullmatch(type_name)
        if not match:
            fix = f"Write a type as {_EXAMPLES[kind]!r}."
            self._fault(step.line, f"{type_name!r} is not the name of a {_KINDS[kind]} type", fix)
        if match["kind"] != kind:
            fix = f"Write a type as {_EXAMPLES[kind]!r}."
            article = "an" if match["kind"] == "action" else "a"
            text = f"{type_name!r} is the type of {article} {_KINDS[match['kind']]}, but {name} needs that of a "
            self._fault(step.line, text + _KINDS[kind], fix)
        package, _, rest = type_name.partition("/")
        if rest not in self._interfaces_of(package):
            fix = "Check its name. If the course has just defined it, run: spinbook build"
            self._fault(step.line, f"there is no type {type_name} here", fix)
        return replace(step, type=type_name)

    def _interfaces_of(self, package: str) -> frozenset[str]:
        """Return the package's types; cached for all messages of a scenario, because this reads files."""
        if package not in self._known:
            self._known[package] = prefixes.interfaces_of(package, prefixes.installed())
        return self._known[package]

    def _type_of(self, name: str, endpoints: Sequence[ServiceOrAction]) -> str | None:
        return next((one.type for one in endpoints if one.name == name), None)

    def _check(self, line: int, name: str, kind: Any, fields: Fields, type_name: str) -> Fields:
        try:
            return checked_fields(kind, fields, type_name)
        except InvalidValue as error:
            self._fault(line, f"{name}: {error.problem}", error.fix)

    # --- messages and steps

    def _message(self, original: Message) -> Message:
        message = self._typed(original, original.topic, "msg", self._topics.get(original.topic), "subscribe")
        fields = self._check(original.line, original.topic, message_class(message.type), original.fields, message.type)
        return replace(message, fields=fields)

    def _step(self, step: Step) -> Step:
        if isinstance(step, Request):
            return self._request(step)
        if isinstance(step, Transition):
            return self._transition(step)
        if isinstance(step, SendGoal):
            return self._goal(step)
        if isinstance(step, Subscribe):
            return self._typed(step, step.topic, "msg", self._topics.get(step.topic), "publish")
        if isinstance(step, CancelGoal):
            self._see_goal(step)
        if isinstance(step, CancelAll) and not self._type_of(step.action, self._exercise.of_role("action")):
            self._fault(step.line, f"there is no action {step.action}", "Declare it in exercise.toml under [[action]].")
        if isinstance(step, (SetParameter, GetParameter)) and not step.node:
            return replace(step, node=self._node())
        if isinstance(step, (Kill, StartProgram)):
            self._see_program(step)
        if isinstance(step, (Leave, ComeBack)):
            self._see_peer(step)
        if isinstance(step, ToWorld):
            self._see_method(step)
        return step

    def _node(self) -> str:
        namespace = self._scenario.namespace.rstrip("/")
        return f"{namespace}/{self._exercise.node_name.lstrip('/')}"

    def _request(self, step: Request) -> Request:
        declared = self._type_of(step.service, self._exercise.of_role("service"))
        request = self._typed(step, step.service, "srv", declared, "service")
        kind = message_class(request.type).Request
        return replace(
            request, fields=self._check(step.line, step.service, kind, step.fields, f"{request.type}_Request")
        )

    def _transition(self, step: Transition) -> Request:
        if step.name not in TRANSITIONS:
            self._fault(step.line, f"there is no transition {step.name!r}", f"There are: {', '.join(TRANSITIONS)}.")
        service = f"{step.node or self._node()}/{CHANGE_STATE}"
        fields = {"transition": {"label": step.name}}
        return self._request(Request(step.at, service, "lifecycle_msgs/srv/ChangeState", fields, line=step.line))

    def _goal(self, step: SendGoal) -> SendGoal:
        declared = self._type_of(step.action, self._exercise.of_role("action"))
        goal = self._typed(step, step.action, "action", declared, "action")
        kind = message_class(goal.type).Goal
        return replace(goal, fields=self._check(step.line, step.action, kind, step.fields, f"{goal.type}_Goal"))

    def _see_goal(self, step: CancelGoal) -> None:
        before = [one for one in self._scenario.steps if isinstance(one, SendGoal) and one.at <= step.at]
        if not 1 <= step.number <= len(before):
            found = f"goal {step.number!r} is cancelled, but {len(before)} goals have been sent by then"
            self._fault(step.line, found, "Goals count from 1, in the order in which they are sent.")

    def _see_program(self, step: Kill | StartProgram) -> None:
        known = [one.id for one in programs_of(self._exercise, self._scenario)]
        if step.program not in known:
            fix = f"There are: {', '.join(known)}." if known else "Declare each program in exercise.toml: [[program]]."
            self._fault(step.line, f"there is no program {step.program!r}", fix)

    def _see_namespaces(self) -> None:
        for namespace in (self._scenario.namespace, *(one.namespace for one in self._scenario.programs)):
            if namespace and not _NAMESPACE.fullmatch(namespace):
                self._fault(
                    0, f"namespace={namespace!r}", 'Give a namespace of letters, digits and _, such as "/left".'
                )

    def _see_programs(self) -> None:
        files = [part.file for part in self._exercise.programs] or [self._exercise.file_name]
        names: list[str] = []
        for one in self._scenario.programs:
            if one.file not in files:
                self._fault(0, f"there is no program {one.file!r}", f"There are: {', '.join(files)}.")
            if one.id in names:
                fix = 'Give each its own name, such as Program("robot.py", name="left", namespace="/left").'
                self._fault(0, f"two programs are called {one.id!r}", fix)
            names.append(one.id)

    def _see_method(self, step: ToWorld) -> None:
        world = self._scenario.world
        if world is None:
            self._fault(step.line, f"there is no world to {step.method}", "Give the scenario a world.")
        try:
            getattr(world.begin(), step.method)(**step.arguments)
        except Exception as error:
            subject, fix = f"the world's {step.method} fails", "Look at the arguments."
            file = self._exercise.scenarios_file
            raise error_in(error, self._exercise.folder, file, subject, fix, step.line) from None

    def _see_peer(self, step: Leave | ComeBack) -> None:
        known = [message.topic for message in self._scenario.messages]
        known += [server.name for server in self._scenario.servers]
        known += [subscriber.name for subscriber in self._scenario.steps if isinstance(subscriber, Subscribe)]
        if step.name not in known:
            fix = f"There are: {', '.join(dict.fromkeys(known)) or 'none'}."
            self._fault(step.line, f"nothing here is called {step.name!r}", fix)

    # --- peers

    def _server(self, server: Server | ActionServer) -> Server | ActionServer:
        if isinstance(server, Server):
            return self._service_server(server)
        if not isinstance(server, ActionServer):
            self._fault(0, f"servers has {server!r}", "Give Server(…) and ActionServer(…).")
        return self._action_server(server)

    def _service_server(self, server: Server) -> Server:
        declared = self._type_of(server.service, self._exercise.of_role("client"))
        server = self._typed(server, server.service, "srv", declared, "client")
        if isinstance(server.replies, AuthorCode):
            return server
        assert isinstance(server.replies, tuple)
        return replace(server, replies=tuple(self._reply(server, reply) for reply in server.replies))

    def _reply(self, server: Server, reply: Reply) -> Reply:
        if not isinstance(reply, Reply):
            self._fault(server.line, f"replies has {reply!r}", "Give reply(…) or no_reply().")
        if reply.fields is None:
            return reply
        kind = message_class(server.type).Response
        fields = self._check(server.line, server.service, kind, reply.fields, f"{server.type}_Response")
        return replace(reply, fields=fields)

    def _action_server(self, server: ActionServer) -> ActionServer:
        declared = self._type_of(server.action, self._exercise.of_role("action_client"))
        server = self._typed(server, server.action, "action", declared, "action_client")
        if not server.goals:
            self._fault(server.line, f"{server.action}: no script for a goal", "Give goals=succeeds(…), for example.")
        return replace(server, goals=tuple(self._script(server, script) for script in server.scripts))

    def _script(self, server: ActionServer, script: GoalScript) -> GoalScript:
        kind = message_class(server.type)
        result = self._check(server.line, server.action, kind.Result, script.result, f"{server.type}_Result")
        feedback = tuple(
            (after, self._check(server.line, server.action, kind.Feedback, fields, f"{server.type}_Feedback"))
            for after, fields in script.feedback
        )
        return replace(script, result=result, feedback=feedback)

    def _companion(self, companion: Companion) -> Companion:
        file = self._exercise.folder / companion.file
        if not file.is_file():
            self._fault(0, f"there is no file {companion.file} in the exercise's folder", "Write the companion there.")
        own, *modules = with_modules([file])
        see_that_students_have([own, *modules])
        texts = {module.name: module.read_text(encoding="utf-8") for module in modules}
        return replace(companion, text=own.read_text(encoding="utf-8"), modules=texts)

    def _world_fault(self, world: World, error: Exception) -> NoReturn:
        subject, fix = f"the world {world.code.name} fails", "It needs reads, publishes, hear(), step() and state()."
        file, line = self._exercise.scenarios_file, world.line or self._scenario.line
        raise error_in(error, self._exercise.folder, file, subject, fix, line) from None

    def _see_world(self) -> None:
        world = self._scenario.world
        if world is None:
            return
        if isinstance(world.period, bool) or not isinstance(world.period, (int, float)) or not world.period > 0:
            self._fault(world.line, f"the world's period={world.period!r}", "Give seconds, such as period=0.02.")
        try:
            with computing_limit():
                model = world.begin()
                topics = {**model.reads, **model.publishes}
                model.step(world.period)
                state = model.state()
                truth = model.truth() if hasattr(model, "truth") else {}
        except Exception as error:
            self._world_fault(world, error)
        if not isinstance(truth, dict) or not _is_plain(truth):
            fix = 'Return a dictionary of numbers, texts and lists, such as {"x": float(self.x)}.'
            self._fault(world.line, f"{world.code.name}.truth() returns {truth!r}", fix)
        for topic, type_name in topics.items():
            self._typed(Message(0, topic, type_name, {}, line=world.line), topic, "msg", None, "subscribe")
        for topic, fields in state.items():
            if topic not in model.publishes:
                fix = f"Its publishes has: {', '.join(model.publishes) or 'nothing'}."
                self._fault(world.line, f"{world.code.name}.state() has {topic!r}", fix)
            kind = message_class(topics[topic])
            self._check(world.line, f"{world.code.name}.state() for {topic}", kind, fields, topics[topic])


def _is_plain(value: Any) -> bool:
    """Return whether a recording can keep a value."""
    if isinstance(value, dict):
        return all(isinstance(key, str) and _is_plain(part) for key, part in value.items())
    if isinstance(value, (list, tuple)):
        return all(map(_is_plain, value))
    return value is None or isinstance(value, (bool, int, float, str))


_EXAMPLES = {
    "msg": "std_msgs/msg/String",
    "srv": "std_srvs/srv/SetBool",
    "action": "example_interfaces/action/Fibonacci",
}
