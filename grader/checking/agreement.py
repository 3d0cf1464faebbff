"""Compares what a solution creates, and the starter made from it, with the interface that exercise.toml declares."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any

from grader.checking.created import CreationCall, created, texts
from grader.exercise.exercise import Exercise, ExerciseError
from grader.exercise.exercise_toml import line_of
from grader.exercise.starter import hidden_blocks
from grader.scenario.command_line import starts
from grader.scenario.scenario import Scenario
from grader.scenario.world import World
from grader.submission import python_code
from groundwork.words import did_you_mean

#: The name of each kind in a sentence.
_WORDS = {
    "publish": "a publisher on",
    "subscribe": "a subscription to",
    "service": "the service",
    "client": "a client of",
    "action": "the action server",
    "action_client": "an action client of",
    "parameter": "the parameter",
}

_FIX = "Make the two agree: students see exercise.toml, and the checks use it."

#: What rclpy or a library creates without a call in the program.
_OF_LIBRARIES = frozenset(("/clock", "/parameter_events", "/rosout", "/tf", "/tf_static"))


def disagreements(exercise: Exercise) -> Iterator[ExerciseError]:
    """Yield each difference between solution.py and exercise.toml, as far as the source literally says what it creates.

    A line outside the markers is also in the starter. A solution that can't be read yields nothing.
    """
    file = exercise.solution_file
    if file is None or not file.exists() or exercise.nodes:  # a launch file creates nothing itself
        return
    source = file.read_text(encoding="utf-8", errors="replace")
    if python_code.tree_of(source) is None:
        return
    hidden = {number for block in hidden_blocks(source) for number, _ in block}
    declared, made = tuple(_declared(exercise)), created(source, exercise.node_name)
    for call in made:
        if call.name is not None:
            problem = _difference(call, declared, exercise)
            if problem:
                whose = "the solution" if call.line in hidden else "the starter"
                yield ExerciseError(file, f"{whose} {problem}", _FIX, call.line)
    yield from _missing(exercise, file, source, declared, made)


def unheard_commands(exercise: Exercise, scenarios: Iterable[Scenario]) -> Iterator[ExerciseError]:
    """Yield each topic that a scenario tells its world to read, and that nothing publishes."""
    for scenario in scenarios:
        published = _published(exercise, scenario)
        for topic in _told_to_read(scenario.world) if scenario.world and not scenario.companions else ():
            if topic not in published:
                fix = did_you_mean(topic, published, f"There are: {', '.join(published) or 'none'}.")
                problem = f"the world of {scenario.name} reads {topic}, which the program does not publish"
                line = scenario.world.line if scenario.world else 0
                yield ExerciseError(exercise.scenarios_file, problem, fix, line or None)


def _published(exercise: Exercise, scenario: Scenario) -> list[str]:
    names = [topic.name for topic in exercise.outputs]
    spaces = [(start, space) for start in starts(exercise, scenario) for space in ("", start.namespace)]
    full = [start.resolved(f"{space}{name}") for start, space in spaces for name in names]
    return list(dict.fromkeys([*names, *full, *(message.topic for message in scenario.messages)]))


def _told_to_read(world: World) -> Iterator[str]:
    """Yield the topics that a world reads because its arguments name them, as a text or as a key."""
    for topic in world.begin().reads:
        if any(
            topic == argument or (isinstance(argument, dict) and topic in argument)
            for argument in world.arguments.values()
        ):
            yield topic


def _declared(exercise: Exercise) -> Iterator[CreationCall]:
    """Yield what exercise.toml declares, kind by kind, as the call that creates it; `line` is that of the table."""
    toml, counts = exercise.folder / "exercise.toml", dict.fromkeys(_WORDS, -1)

    def line(kind: str) -> int:
        counts[kind] += 1
        return line_of(toml, kind, counts[kind], "") or 1

    for topic in exercise.topics:
        yield CreationCall(topic.direction, line(topic.direction), topic.name, topic.type, topic.qos)
    for end in exercise.endpoints:
        yield CreationCall(end.role, line(end.role), end.name, end.type)
    for parameter in exercise.parameters:
        yield CreationCall("parameter", line("parameter"), parameter.name, parameter.type, default=parameter.default)


def _difference(call: CreationCall, declared: tuple[CreationCall, ...], exercise: Exercise) -> str:
    """Return how it differs from the declaration, to follow the words "the solution"; empty if it does not."""
    verb = "declares" if call.kind == "parameter" else "creates"
    phrase = f"{verb} {_WORDS[call.kind]} {call.name}"
    same = [other for other in declared if (other.kind, other.name) == (call.kind, call.name)]
    if not same:
        # One of several programs may subscribe to what another one publishes, which is declared once.
        of_topic = exercise.programs and call.kind in ("publish", "subscribe")
        same = [other for other in declared if other.name == call.name] if of_topic else []
        if not same:
            return f"{phrase}, which exercise.toml does not declare under [[{call.kind}]]"
    return _other_value(call, same[0], phrase)


def _other_value(call: CreationCall, other: CreationCall, phrase: str) -> str:
    """Return the first of type, QoS and default that differs from the declaration."""
    pairs = [("type", call.type, other.type), ("default", call.default, other.default)]
    if call.kind == other.kind and call.qos and other.qos:
        pairs += [(name, getattr(call.qos, name), getattr(other.qos, name)) for name in vars(other.qos)]
    for name, got, expected in pairs:
        if got is not None and expected is not None and got != expected:
            return f"{phrase} with {name} = {_shown(got)}; exercise.toml has {name} = {_shown(expected)}"
    return ""


def _shown(value: Any) -> str:
    """Return a value as exercise.toml writes it."""
    return f'"{value}"' if isinstance(value, str) else str(value).lower() if isinstance(value, bool) else str(value)


def _missing(
    exercise: Exercise, file: Path, source: str, declared: tuple[CreationCall, ...], made: tuple[CreationCall, ...]
) -> Iterator[ExerciseError]:
    """Yield what is declared, but neither created nor named anywhere in the solution."""
    written = _OF_LIBRARIES | texts(source)
    computed = {call.kind for call in made if call.name is None}
    there = {(call.kind, call.name) for call in made}
    for table in declared:
        name = table.name or ""
        if (table.kind, name) in there or table.kind in computed or {name, name.lstrip("/")} & written:
            continue
        verb = "declare" if table.kind == "parameter" else "create"
        problem = f"{file.name} does not {verb} {_WORDS[table.kind]} {name}, which is declared here"
        yield ExerciseError(exercise.folder / "exercise.toml", problem, _FIX, table.line)
