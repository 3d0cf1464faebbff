"""Helpers for a program's part of the ROS graph: its nodes, its endpoints and their QoS, and how it ends."""

from __future__ import annotations

from typing import Literal, NoReturn

from grader.checking.cause import UNKNOWN, Cause, as_cause
from grader.checking.existing_names import OF_EVERY_NODE
from grader.checking.hint_texts import hints
from grader.checking.recorded_run import RecordedRun
from grader.checking.verdict import Finding, Wrong
from grader.recording.events import ProgramStart
from grader.recording.recording import Endpoint

Kind = Literal["publisher", "subscription", "server", "client", "action server", "action client"]

#: Kind of endpoint -> what a node does with it, and the words before a list of all its endpoints of this kind.
_WORDS = {
    "publisher": ("publish on", "It publishes on"),
    "subscription": ("subscribe to", "It subscribes to"),
    "server": ("have a service", "Its services are"),
    "client": ("have a client of", "It has clients of"),
    "action server": ("have an action", "Its actions are"),
    "action client": ("have an action client of", "It has action clients of"),
}

#: The topic on which the grader publishes simulated time. Every program that uses simulated time subscribes to it.
CLOCK = "/clock"

#: What a node with a life cycle publishes when its state changes.
_TRANSITION_EVENT = "lifecycle_msgs/msg/TransitionEvent"
#: Its own endpoints on these topics. A publisher on /clock is not among them: the student created it.
_OWN = {
    ("subscription", CLOCK),
    ("publisher", "/rosout"),
    ("publisher", "/parameter_events"),
    ("subscription", "/parameter_events"),
}

_KINDS: dict[str, Kind] = {
    "publish": "publisher",
    "subscribe": "subscription",
    "service": "server",
    "client": "client",
    "action": "action server",
    "action_client": "action client",
}


def end_points(run: RecordedRun, kind: Kind, name: str = "") -> list[Endpoint]:
    """Return the student's endpoints of a kind, such as "publisher" or "action server"; with `name`, of that topic.

    Example: `run.end_points("publisher", "/out")[0].depth`
    """
    return [end for end in run.recording.end_points if end.kind == kind and name in ("", end.topic)]


def publishers(run: RecordedRun, topic: str) -> list[Endpoint]:
    """Return the student's publishers on `topic`.

    Example: `run.publishers("/out")[0].reliability`
    """
    return end_points(run, "publisher", topic)


def subscriptions(run: RecordedRun, topic: str) -> list[Endpoint]:
    """Return the student's subscriptions to `topic`.

    Example: `len(run.subscriptions("/in"))`
    """
    return end_points(run, "subscription", topic)


def topics(run: RecordedRun, kind: Kind) -> list[str]:
    """Return the names of all topics that the student's nodes publish ("publisher") or subscribe to ("subscription").

    The subscription to `/clock` is left out unless the exercise is about it, because the grader makes rclpy create it.

    Example: `run.topics("publisher")`
    """
    ours = {CLOCK} - {topic.name for topic in run.exercise.topics} if kind == "subscription" else set()
    return sorted({end.topic for end in end_points(run, kind)} - ours)


def must_be_as_declared(run: RecordedRun) -> None:
    """Check that the program has the nodes and the interface of exercise.toml, its QoS and depths, and nothing else.

    Example: `run.must_be_as_declared()`
    """
    must_have_interface(run, only=True)
    must_have_nodes(run)
    must_have_qos(run, depth=True)


def must_have_interface(run: RecordedRun, *names: str, only: bool = False) -> None:
    """Check that the node has every topic, service and action of exercise.toml, or those with these `names`, each with
    its type.

    With `only`, it must have no others, and one endpoint of each. Of several programs, each node must have at most one.
    Raises ValueError for a name that exercise.toml does not declare.

    Example: `run.must_have_interface(only=True)`
    """
    declared = [(_KINDS[topic.direction], topic.name, topic.type) for topic in run.exercise.topics]
    declared += [(_KINDS[end.role], end.name, end.type) for end in run.exercise.endpoints]
    if unknown := set(names) - {name for _, name, _ in declared}:
        raise ValueError(f"exercise.toml does not declare {', '.join(sorted(unknown))}")
    declared = [end for end in declared if not names or end[1] in names]
    declared = [(kind, _in(run, kind, name, start), type_) for kind, name, type_ in declared for start in _starts(run)]
    for kind, name, type_ in declared:
        mine = end_points(run, kind, name)
        if not mine:
            _lacks(run, kind, name)
        for end in mine:
            if end.type != type_:
                text = f"your {kind} on {name} has another type. Expected {type_}, got {end.type}."
                _wrong(text, type_, end.type, _TYPE)
    if only:
        _has_no_others(run, [(kind, name) for kind, name, _ in declared])


def must_have_qos(run: RecordedRun, topic: str = "", depth: bool = False) -> None:
    """Check that the node's endpoints on `topic`, or on all topics, have the reliability and durability of
    exercise.toml; with `depth`, the depth of their queues, too.

    Example: `run.must_have_qos("/out", depth=True)`
    """
    chosen = [declared for declared in run.exercise.topics if topic in ("", declared.name)]
    if topic and not chosen:
        raise ValueError(f"exercise.toml does not declare {topic}: there is no QoS to compare with.")
    for declared in chosen:
        expected = f"{declared.reliability} and {declared.durability}"
        kind = _KINDS[declared.direction]
        names = {_in(run, kind, declared.name, start) for start in _starts(run)}
        for end in [end for end in end_points(run, kind) if end.topic in names]:
            got = f"{end.reliability} and {end.durability}"
            if got != expected:
                text = f"your {end.kind} on {end.topic} is {got}. Expected {expected}."
                _wrong(text, expected, got, _of_qos(end, declared.durability))
            if depth and end.depth != declared.depth:
                expected, got = f"a depth of {declared.depth}", f"{end.depth}" if end.depth else "one that keeps all"
                text = f"your {end.kind} on {end.topic} has another queue. Expected {expected}, got {got}."
                _wrong(text, expected, got)


def must_have_nodes(run: RecordedRun) -> None:
    """Check that the program creates the node of exercise.toml (of each of its programs) and no other.

    Example: `run.must_have_nodes()`
    """
    starts = run.recording.programs
    names = [f"{one.namespace.strip('/')}/{one.node.lstrip('/')}" for one in starts]
    names = (
        names
        or [*run.exercise.nodes]
        or [program.node for program in run.exercise.programs]
        or [run.exercise.node_name]
    )
    expected = tuple(sorted(f"/{name.lstrip('/')}" for name in names))
    got, text = ", ".join(run.nodes) or "none", ""
    if lacking := [name for name in expected if name not in run.nodes]:
        text = f"there is no node {lacking[0]}. Expected {', '.join(expected)}, got {got}."
    elif len(run.nodes) > len(expected):
        text = f"your program creates other nodes, too. Expected {', '.join(expected)}, got {got}."
    if text:
        _wrong(text, ", ".join(expected), got, _of_launched(run) or _NODES)


def must_publish_on_no_others(run: RecordedRun) -> None:
    """Check that the program publishes on no topics other than those of exercise.toml.

    Example: `run.must_publish_on_no_others()`
    """
    declared = {_in(run, "publisher", topic.name, start) for topic in run.exercise.outputs for start in _starts(run)}
    if others := sorted({end.topic for end in end_points(run, "publisher")} - declared):
        text = f"your node publishes on other topics, too. Expected none, got {', '.join(others)}."
        _wrong(text, "none", ", ".join(others), Cause("", *hints("other_topics")))


def must_end_on_ctrl_c(run: RecordedRun) -> None:
    """Check that the program ends within 2 s of Ctrl-C, without a traceback. The scenario needs `interrupt=True`.

    Example: `run.must_end_on_ctrl_c()`
    """
    if not run.ending.interrupted:
        raise ValueError(f"the scenario {run.scenario} sends no Ctrl-C. Add interrupt=True to it.")
    if not run.ending.ended_in_time:
        text = "your program was still running 2 s after Ctrl-C. Expected an end within 2 s."
        _wrong(text, "an end within 2 s", "none", _STILL_RUNS)
    if run.ending.traceback:
        text = f"after Ctrl-C your program printed a traceback: {run.ending.traceback}"
        _wrong(text, "no traceback", run.ending.traceback, _TRACEBACK)


def must_survive(run: RecordedRun, program: str = "") -> None:
    """Check that no program of the submission ends by itself; with `program` (its file), check only that one.

    Example: `run.must_survive()`
    """
    for exit_ in run.recording.exits:
        if exit_.by == "itself" and program in ("", exit_.program):
            how = f"with code {exit_.code}" if exit_.signal is None else f"by signal {exit_.signal}"
            text = f"{exit_.program} ended by itself, {how}, but must continue."
            run.wrong_at(exit_.at, text, "", "to go on", f"an end {how}")


def _starts(run: RecordedRun) -> tuple[ProgramStart, ...]:
    return run.recording.programs or (ProgramStart("", ""),)


def _in(run: RecordedRun, kind: Kind, name: str, start: ProgramStart) -> str:
    """Return what a declared name is for a program: in its namespace, unless the program gives it with a slash."""
    absolute = start.resolved(name)
    return absolute if end_points(run, kind, absolute) else start.resolved(f"{start.namespace}{name}")


def _has_no_others(run: RecordedRun, declared: list[tuple[Kind, str]]) -> None:
    # A node with a life cycle publishes its changes of state. If the solution is none, the topic is one too many.
    of_life_cycles = {("publisher", end.topic) for end in run.reference.end_points if end.type == _TRANSITION_EVENT}
    for end in run.recording.end_points:
        if (end.kind, end.topic) not in {*declared, *_OWN, *of_life_cycles}:
            _wrong(f"your node has a {end.kind} on {end.topic}, which is not in the task.", "none", end.topic)
    for kind, name in declared:
        ends = end_points(run, kind, name)
        nodes = [end.node for end in ends] if run.exercise.programs else ["" for _ in ends]
        if len({end.node for end in ends}) > 1 and any(start.namespace for start in _starts(run)):
            expected = ", ".join(start.resolved(f"{start.namespace}{name}") for start in _starts(run))
            text = f"{len(ends)} programs have a {kind} on {name}: a name that begins with / is in no namespace."
            _wrong(f"{text} Expected {expected}.", expected, name)
        if (count := max(map(nodes.count, nodes), default=0)) > 1:
            _wrong(f"your node has {count} {kind}s on {name}. Expected 1.", "1", str(count))


def shown_names(run: RecordedRun, kind: Kind) -> str:
    """Return the names of the endpoints of a kind that the student's nodes create, for a sentence."""
    return ", ".join(name for name in topics(run, kind) if name not in OF_EVERY_NODE) or "none"


def _lacks(run: RecordedRun, kind: Kind, name: str) -> NoReturn:
    does, others = _WORDS[kind]
    names = shown_names(run, kind)
    text = f"your node does not {does} {name}. {others}: {names}."
    other = _OTHER_SIDE[kind]
    if end_points(run, other, name):
        text += f" It has only the other side of {name}, a{'n' * other.startswith('a')} {other}."
    _wrong(text, name, names, _of_launched(run) or lacking(kind))


#: Kind of endpoint -> the kind at the other end of the connection.
_OTHER_SIDE: dict[Kind, Kind] = {
    "publisher": "subscription",
    "subscription": "publisher",
    "server": "client",
    "client": "server",
    "action server": "action client",
    "action client": "action server",
}


def _of_launched(run: RecordedRun) -> Cause:
    """Return with which error a program of a launch file ended: that is why its node is not there."""
    return run.observed if run.exercise.nodes and run.recording.ending.survived else UNKNOWN


#: Kind of endpoint -> the call that creates it.
_CALLS = {
    "publisher": "self.create_publisher(Type, 'name', 10)",
    "subscription": "self.create_subscription(Type, 'name', self.callback, 10)",
    "server": "self.create_service(Type, 'name', self.callback)",
    "client": "self.create_client(Type, 'name')",
    "action server": "ActionServer(self, Type, 'name', self.execute)",
    "action client": "ActionClient(self, Type, 'name')",
}


def lacking(kind: Kind) -> Cause:
    """Return the hints for a node that lacks an endpoint of this kind, or has it under another name."""
    return Cause("", *hints("lacking", kind="service" if kind == "server" else kind, call=_CALLS[kind]))


_TYPE = Cause("", *hints("type"))
_NODES = Cause("", *hints("nodes"))
_STILL_RUNS = Cause("", *hints("still_runs"))
_TRACEBACK = Cause("", *hints("traceback"))


def _wrong(text: str, expected: str, got: str, cause: str | Cause = UNKNOWN) -> NoReturn:
    """End the check: `text` says what is wrong with the program in every scenario."""
    known = as_cause(cause)
    message = f"{text[0].upper()}{text[1:]} {known.seen}".strip()
    raise Wrong(Finding(message, expected=expected, got=got, cause=known.seen, where=known.where, todo=known.todo))


def _of_qos(end: Endpoint, durability: str) -> str:
    if durability == "transient_local" and end.durability != durability and end.kind == "publisher":
        return "A late subscriber gets nothing that it published before."
    if durability == "volatile" and end.durability == "transient_local" and end.kind == "subscription":
        return "A transient local subscription gets nothing from a volatile publisher."
    return ""
