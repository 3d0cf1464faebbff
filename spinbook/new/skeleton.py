"""Writes a program with the interface of exercise.toml, but without the task's content: the first draft of a solution.

The code for the interface is outside the solution's markers, so that a starter made from it has each topic, service,
action and parameter with its type and quality of service. What it does with them is a TODO between markers.
"""

from __future__ import annotations

import json
import re
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace

from grader.exercise.exercise import (
    Direction,
    Durability,
    Exercise,
    Parameter,
    ProgramFile,
    Reliability,
    Role,
    ServiceOrAction,
    Topic,
)
from grader.scenario.command_line import starts
from grader.scenario.scenario import Scenario

#: A program's endpoint, and what an __init__ does for it.
_ENTRY = {
    "service": "self.{name}_service = self.create_service({type}, {topic}, self.on_{name})",
    "client": "self.{name}_client = self.create_client({type}, {topic})",
    "action": "self.{name}_server = ActionServer(self, {type}, {topic}, self.execute_{name})",
    "action_client": "self.{name}_client = ActionClient(self, {type}, {topic})",
}

_ENUMS: dict[Reliability | Durability, str] = {
    "best_effort": "reliability=ReliabilityPolicy.BEST_EFFORT",
    "transient_local": "durability=DurabilityPolicy.TRANSIENT_LOCAL",
}

_VERBS: dict[Direction | Role, str] = {
    "subscribe": "subscribe to",
    "publish": "publish on",
    "service": "serve",
    "client": "call",
    "action": "serve the action",
    "action_client": "send goals to",
}

#: What a node without callbacks still needs.
_TIMER = "        # TODO: create a timer, and write what it calls."

#: The code between a program's imports and its end. The author fills in what is between a solution's markers.
_BODY = '''\
class {class_name}(Node):
    """TODO: what the node does."""

    def __init__(self):
        super().__init__("{node}")
{init}
{methods}

def main():
    rclpy.init()
    node = {class_name}()
    try:
        rclpy.spin({spun})
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == "__main__":
    main()
'''

#: A launch file's code. The author says which program each node is.
_LAUNCH = '''\
"""{title}"""

from launch import LaunchDescription
from launch_ros.actions import Node


def generate_launch_description():
    return LaunchDescription(
        [
            # BEGIN SOLUTION
{nodes}
            # END SOLUTION
        ]
    )
'''


@dataclass(frozen=True)
class _Callback:
    """A method that the program's endpoints call."""

    name: str
    arguments: str
    about: str
    last: str = ""


def skeleton(exercise: Exercise) -> str:
    """Return the text of a solution with the exercise's interface: a program, several, or a launch file.

    exercise.toml does not say which of several programs has which topic: comments then list them for the author.
    """
    if exercise.nodes:
        return _LAUNCH.format(title=_sentence(exercise.title), nodes="\n".join(map(_launched, exercise.nodes)))
    if not exercise.programs:
        node = ProgramFile(exercise.file_name, exercise.node_name, exercise.class_name)
        return _program(exercise.title, node, exercise.topics, exercise.endpoints, exercise.parameters)
    todo = [f"        # TODO: {line}, if it is this node that does." for line in _listed(exercise)]
    parts = (
        f"# file: {program.file}\n{_filled(exercise.title, program, _imports((), ()), _marked(todo), '')}"
        for program in exercise.programs
    )
    return "\n\n".join(parts)


def with_relative_names(exercise: Exercise, scenarios: Iterable[Scenario]) -> Exercise:
    """Return the exercise with names without a slash if scenarios start the program in a namespace.

    A name that such a scenario itself uses as it is, such as a map that all robots share, keeps its slash.
    """
    spaces = [scenario for scenario in scenarios if any(start.namespace for start in starts(exercise, scenario))]
    if not spaces:
        return exercise
    worlds = [scenario.world.begin() for scenario in spaces if scenario.world]
    steps = [step for scenario in spaces for step in (*scenario.content, *scenario.servers)]
    shared = {getattr(step, part, "") for step in steps for part in ("topic", "service", "action")}
    shared |= {name for world in worlds for name in (*world.reads, *world.publishes)}
    shared -= {to for scenario in spaces for start in starts(exercise, scenario) for to in start.remappings.values()}

    def relative(name: str) -> str:
        return name if name in shared else name.removeprefix("/")

    return replace(
        exercise,
        topics=tuple(replace(topic, name=relative(topic.name)) for topic in exercise.topics),
        endpoints=tuple(replace(end, name=relative(end.name)) for end in exercise.endpoints),
    )


def _launched(node: str) -> str:
    namespace, _, name = node.rpartition("/")
    within = f', namespace="{namespace}"' if namespace else ""
    return f'            Node(package="TODO", executable="TODO", name="{name}"{within}),'


def _listed(exercise: Exercise) -> Iterator[str]:
    for topic in exercise.topics:
        quality = ", ".join(policy.replace("_", " ") for policy in (topic.reliability, topic.durability))
        yield f"{_VERBS[topic.direction]} {topic.name} ({topic.type}, depth {topic.depth}, {quality})"
    for endpoint in exercise.endpoints:
        yield f"{_VERBS[endpoint.role]} {endpoint.name} ({endpoint.type})"
    for parameter in exercise.parameters:
        yield f"declare the parameter {parameter.name}"


def _program(
    title: str,
    node: ProgramFile,
    topics: Sequence[Topic],
    endpoints: Sequence[ServiceOrAction],
    parameters: Sequence[Parameter],
) -> str:
    ends = [line for topic in topics for line in _topic(topic)]
    init = [f"        {line}" for line in (*map(_parameter, parameters), *ends, *map(_end, endpoints))]
    callbacks = [*_callbacks(topics, endpoints)]
    methods = "".join(_method(callback) for callback in callbacks)
    init += [] if callbacks else _marked([_TIMER])
    return _filled(title, node, _imports(topics, endpoints), init, methods)


def _filled(title: str, node: ProgramFile, imports: str, init: Sequence[str], methods: str) -> str:
    class_name = node.class_name or "".join(word.capitalize() for word in node.node.split("_"))
    # With one thread, an action's callback that waits by the node's clock would wait forever.
    spun = "node, MultiThreadedExecutor()" if "MultiThreadedExecutor" in imports else "node"
    body = _BODY.format(class_name=class_name, node=node.node, init="\n".join(init), methods=methods, spun=spun)
    return f'"""{_sentence(title)}"""\n\n{imports}\n\n\n{body}'


def _sentence(title: str) -> str:
    return title if title.endswith((".", "?", "!")) else f"{title}."


def _parameter(parameter: Parameter) -> str:
    if parameter.default is None:
        kind = f"Parameter.Type.{parameter.type.upper()}"
        return f'self.declare_parameter("{parameter.name}", rclpy.parameter.{kind})'
    default = parameter.default
    written = json.dumps(default, ensure_ascii=False) if isinstance(default, str) else repr(default)
    return f'self.declare_parameter("{parameter.name}", {written})'


def _topic(topic: Topic) -> Iterator[str]:
    name, type_, quality = _name(topic.name), topic.type.rpartition("/")[2], _quality(topic)
    if quality != str(topic.depth):
        yield f"{name}_quality = {quality}"
        quality = f"{name}_quality"
    if topic.direction == "publish":
        yield f"self.{name}_publisher = self.create_publisher({type_}, {json.dumps(topic.name)}, {quality})"
    else:
        yield f"self.create_subscription({type_}, {json.dumps(topic.name)}, self.on_{name}, {quality})"


def _quality(topic: Topic) -> str:
    """Return only the depth if that is enough for what is declared."""
    policies = [_ENUMS[policy] for policy in (topic.reliability, topic.durability) if policy in _ENUMS]
    return f"QoSProfile({', '.join([f'depth={topic.depth}', *policies])})" if policies else str(topic.depth)


def _end(endpoint: ServiceOrAction) -> str:
    return _ENTRY[endpoint.role].format(
        name=_name(endpoint.name), type=endpoint.type.rpartition("/")[2], topic=json.dumps(endpoint.name)
    )


def _callbacks(topics: Sequence[Topic], endpoints: Sequence[ServiceOrAction]) -> Iterator[_Callback]:
    for topic in topics:
        if topic.direction == "subscribe":
            yield _Callback(f"on_{_name(topic.name)}", "message", f"Called once for each message on {topic.name}.")
    for endpoint in endpoints:
        name, type_ = _name(endpoint.name), endpoint.type.rpartition("/")[2]
        if endpoint.role == "service":
            about = "Called once for each request. What it returns is sent as the response."
            yield _Callback(f"on_{name}", "request, response", about, "return response")
        elif endpoint.role == "action":
            about = "Called once for each accepted goal. What it returns is the goal's result."
            yield _Callback(f"execute_{name}", "goal_handle", about, f"return {type_}.Result()")


def _method(callback: _Callback) -> str:
    lines = [f"    def {callback.name}(self, {callback.arguments}):", f'        """{callback.about}"""']
    lines += _marked(["        # TODO: write this."], callback.last)
    return "\n" + "\n".join(lines) + "\n"


def _marked(todo: Sequence[str], last: str = "") -> list[str]:
    """Return a block for the author to fill in, below what students read."""
    inside = [f"        {last}"] if last else []
    return [*todo, "        # BEGIN SOLUTION", *inside, "        # END SOLUTION"]


def _imports(topics: Sequence[Topic], endpoints: Sequence[ServiceOrAction]) -> str:
    threads = {"MultiThreadedExecutor" for endpoint in endpoints if endpoint.role == "action"}
    imported = {
        "rclpy.executors": {"ExternalShutdownException", *threads},
        "rclpy.node": {"Node"},
        "rclpy.action": {kind for endpoint in endpoints if (kind := _ACTION_ENDS.get(endpoint.role))},
        "rclpy.qos": {word for topic in topics for word in re.findall(r"QoSProfile|\w+Policy", _quality(topic))},
    }
    for type_ in (*(topic.type for topic in topics), *(endpoint.type for endpoint in endpoints)):
        package, kind, name = type_.split("/")
        imported.setdefault(f"{package}.{kind}", set()).add(name)
    lines = [f"from {module} import {', '.join(sorted(names))}" for module, names in sorted(imported.items()) if names]
    return "\n".join(["import rclpy", *lines])


_ACTION_ENDS: dict[Role, str] = {"action": "ActionServer", "action_client": "ActionClient"}


def _name(topic: str) -> str:
    """Return the name of a topic, a service or an action as a part of a Python name."""
    return re.sub(r"\W+", "_", topic).strip("_").lower()
