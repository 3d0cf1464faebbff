"""Which messages of which topic: its type, a field of each message, a condition on them."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any, TypeVar

import click

from ros_in_python.ros2 import interfaces
from ros_in_python.ros2.cli import CommandError

if TYPE_CHECKING:
    from ros_in_python.ros2.graph import Graph


F = TypeVar("F", bound=Callable[..., Any])

#: Whether a message is wanted.
Filter = Callable[[Any], bool]


def _compile(context: click.Context, parameter: click.Parameter, text: str | None) -> Filter | None:
    if text is None:
        return None
    try:
        code = compile(text, "--filter", "eval")
    except (SyntaxError, ValueError) as error:
        raise CommandError(
            f"--filter {text!r} is not a valid Python expression: {error}", "As in: --filter 'm.data > 3'"
        ) from None

    def wanted(message: Any) -> bool:
        try:
            # The person at the terminal wrote it, for their own process.
            return bool(eval(code, {"m": message}))
        except Exception as error:
            raise CommandError(f"--filter {text!r} failed: {error}", "The message is called m.") from None

    return wanted


filter_option: Callable[[F], F] = click.option(
    "--filter",
    "filter_expression",
    callback=_compile,
    metavar="EXPR",
    help="Only messages for which this Python expression is true; the message is m.",
)


def field_path(text: str | None) -> list[str]:
    """`--field pose.position` as a list. Raises `CommandError` for one that names nothing."""
    if text is None:
        return []
    path = [part for part in text.split(".") if part]
    if not path:
        raise CommandError(f"Invalid field value '{text}'", "Expected names with dots between, as in header.stamp")
    return path


def check_path(message: Any, path: Sequence[str]) -> None:
    """Raise `CommandError` where a message class has no such field, with the fields it has."""
    from ros_in_python.ros2.messages import field_names, is_message, type_name

    value = message()
    for part in path:
        names = field_names(value) if is_message(value) else "none"
        if not is_message(value) or part not in value.get_fields_and_field_types():
            owner = type_name(value) if is_message(value) else type(value).__name__
            raise CommandError(
                f"Invalid field '{'.'.join(path)}': '{type(value).__name__}' object has no attribute '{part}'",
                f"Fields of {owner}: {names}.",
            )
        value = getattr(value, part)


def field(message: Any, path: Sequence[str]) -> Any:
    """The field of a message that `path` leads to."""
    for part in path:
        message = getattr(message, part)
    return message


def type_on_graph(graph: Graph, topic: str) -> Any | None:
    """The class of a topic's messages as the graph has it now, None if nobody has the topic.

    Raises `CommandError` if its ends disagree about the type, or where the type is not installed.
    """
    types = graph.topic_types(topic)
    if len(types) > 1:
        raise CommandError(
            f"Cannot echo topic '{topic}', as it contains more than one type: [{', '.join(types)}]",
            f"Ends of different types never connect. `ros2 topic info -v {topic}` shows who uses which.",
        )
    return interfaces.message_class(types[0]) if types else None


def wait_for_type(graph: Graph, topic: str) -> Any:
    """The class of a topic's messages; waits without end, after a warning, for a topic that nobody has."""
    graph.settle(lambda: bool(graph.topic_types(topic)))

    message = type_on_graph(graph, topic)
    if message is None:
        print(f"WARNING: topic [{topic}] does not appear to be published yet", flush=True)
    while message is None:
        graph.spin_until(lambda: bool(graph.topic_types(topic)))
        message = type_on_graph(graph, topic)
    return message


def type_or_refusal(graph: Graph, topic: str) -> Any:
    """The class of a topic's messages. Raises `CommandError` after the real command's two lines if nobody has it."""
    from ros_in_python.ros2.graph import seen

    message = type_on_graph(graph, topic)
    if message is None:
        print(f"WARNING: topic [{topic}] does not appear to be published yet", flush=True)
        raise CommandError(
            "Could not determine the type for the passed topic",
            seen("Topics", (found.name for found in graph.topics())),
            f"To wait for it, name the type too: ros2 topic echo {topic} std_msgs/msg/String",
        )
    return message
