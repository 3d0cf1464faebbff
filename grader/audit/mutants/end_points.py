"""Mutation operators for a node's endpoints: its name, topics, types, quality of service, callbacks and timers."""

from __future__ import annotations

from collections.abc import Iterator

import libcst as cst

from grader.audit.mutants.program import Change, ParsedProgram, argument, called, expression, with_argument, with_body

#: Method -> positions and names of its arguments: type, topic, callback, quality of service.
ENDS = {
    "create_publisher": {"type": (0, "msg_type"), "topic": (1, "topic"), "qos": (2, "qos_profile")},
    "create_subscription": {
        "type": (0, "msg_type"),
        "topic": (1, "topic"),
        "callback": (2, "callback"),
        "qos": (3, "qos_profile"),
    },
    "create_timer": {"period": (0, "timer_period_sec"), "callback": (1, "callback")},
    "create_service": {"type": (0, "srv_type"), "topic": (1, "srv_name"), "callback": (2, "callback")},
    "create_client": {"type": (0, "srv_type"), "topic": (1, "srv_name")},
    "ActionServer": {"type": (1, "action_type"), "topic": (2, "action_name"), "callback": (3, "execute_callback")},
    "ActionClient": {"type": (1, "action_type"), "topic": (2, "action_name")},
}

#: The type to use for an endpoint that does not belong to a topic, and the module of that type.
OTHER_TYPES = {
    "create_service": ("std_srvs.srv.Empty", "std_srvs.srv"),
    "create_client": ("std_srvs.srv.Empty", "std_srvs.srv"),
    "ActionServer": ("test_msgs.action.NestedMessage", "test_msgs.action"),
    "ActionClient": ("test_msgs.action.NestedMessage", "test_msgs.action"),
}

QOS = "rclpy.qos.QoSProfile(depth=10, {}=rclpy.qos.{}.{})"
PROFILES = (
    ("10", "has the usual QoS", ()),
    ("1", "has a queue of 1", ()),
    ("100", "has a queue of 100", ()),
    (QOS.format("reliability", "ReliabilityPolicy", "BEST_EFFORT"), "is not reliable", ("rclpy.qos",)),
    (QOS.format("durability", "DurabilityPolicy", "TRANSIENT_LOCAL"), "is transient local", ("rclpy.qos",)),
)


def topic_name(node: cst.CSTNode, program: ParsedProgram) -> Iterator[Change]:
    """Give an endpoint another topic: misspelled, in a namespace, or another one of the exercise."""
    place = _argument(node, "topic")
    if place is None or not isinstance(place.value, cst.SimpleString):
        return
    name = str(place.value.evaluated_value)
    exercise = program.exercise
    known = [*(topic.name for topic in exercise.topics), *(other.name for other in exercise.endpoints)]
    others = [other for other in known if other != name]
    word = "topic" if "qos" in ENDS[called(node)] else "name"
    for other in (f"{name}s", f"/robot{name}", f"~{name}", *others):
        yield Change(node, place.value, expression(repr(other)), f"has the {word} {other} for {name}")


def message_type(node: cst.CSTNode, program: ParsedProgram) -> Iterator[Change]:
    """Give an endpoint another type."""
    place = _argument(node, "type")
    if place is not None:
        other, module = OTHER_TYPES.get(called(node), ("std_msgs.msg.String", "std_msgs.msg"))
        description = f"has the type {other.rpartition('.')[2]} for {program.text(place.value)}"
        yield Change(node, place.value, expression(other), description, (module,))


def quality_of_service(node: cst.CSTNode, program: ParsedProgram) -> Iterator[Change]:
    """Give an endpoint another depth, or make it best effort or transient local."""
    place = _argument(node, "qos")
    if place is not None:
        for new, description, imports in PROFILES:
            yield Change(node, place.value, expression(new), f"{called(node)} {description}", imports)


def callback_left_out(node: cst.CSTNode, program: ParsedProgram) -> Iterator[Change]:
    """Do not pass messages to the callback."""
    place = _argument(node, "callback")
    if place is not None:
        yield Change(node, place.value, expression("lambda *_: None"), f"does not call {program.text(place.value)}")


def timer_period(node: cst.CSTNode, program: ParsedProgram) -> Iterator[Change]:
    """Double or halve a timer's period."""
    place = _argument(node, "period")
    if place is not None:
        text = program.text(place.value)
        for new in (f"({text}) * 2", f"({text}) / 2"):
            yield Change(node, place.value, expression(new), f"has the period {new}")


def node_name(node: cst.CSTNode, program: ParsedProgram) -> Iterator[Change]:
    """Give the node another name, or a namespace."""
    if isinstance(node, cst.Call) and called(node) in ("__init__", "create_node", "Node") and node.args:
        first = node.args[0]
        if isinstance(first.value, cst.SimpleString):
            name = str(first.value.evaluated_value)
            yield Change(node, first.value, expression(repr(f"{name}_node")), f"the node is called {name + '_node'!r}")
            yield Change(node, node, with_argument(node, "namespace='robot'"), "the node has a namespace")


def one_publisher_a_message(node: cst.CSTNode, program: ParsedProgram) -> Iterator[Change]:
    """Create the publisher again for each message."""
    if isinstance(node, cst.SimpleStatementLine) and "self.create_publisher(" in program.text(node):
        for callback in program.callbacks():
            if isinstance(callback.body, cst.IndentedBlock) and program.has_self(callback.body):
                body = [node.with_changes(leading_lines=[]), *callback.body.body]
                description = "creates a publisher for each message"
                yield Change(callback, callback.body, with_body(callback.body, body), description)


def publisher_on_other_topic(node: cst.CSTNode, program: ParsedProgram) -> Iterator[Change]:
    """Add a publisher on another node's topic."""
    if isinstance(node, cst.SimpleStatementLine) and "self.create_publisher(" in program.text(node):
        kinds = {topic.name: topic.type for topic in program.exercise.inputs} | {"/clock": "rosgraph_msgs/msg/Clock"}
        for topic, kind in kinds.items():
            package, _, name = kind.split("/")
            new = f"self.create_publisher({package}.msg.{name}, '{topic}', 10)"
            description = f"has a publisher on {topic}, too"
            yield program.instead(node, description, node, new, imports=(f"{package}.msg",))


def spinning(node: cst.CSTNode, program: ParsedProgram) -> Iterator[Change]:
    """Spin the node only once; shut down although the signal has already done so."""
    if isinstance(node, cst.Call) and isinstance(node.func, cst.Attribute):
        for old, new in (("spin", "spin_once"), ("try_shutdown", "shutdown")):
            if called(node) == old:
                yield Change(node, node.func.attr, cst.Name(new), f"calls {new}() for {old}()")


def _argument(node: cst.CSTNode, which: str) -> cst.Arg | None:
    """Return an argument of a call that creates an endpoint."""
    place = ENDS.get(called(node), {}).get(which)
    return argument(node, *place) if place else None


OPERATORS = (
    topic_name,
    message_type,
    quality_of_service,
    callback_left_out,
    timer_period,
    node_name,
    one_publisher_a_message,
    publisher_on_other_topic,
    spinning,
)
