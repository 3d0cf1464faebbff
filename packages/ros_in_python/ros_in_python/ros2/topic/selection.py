"""Which messages of which topic: its type, a field of each message, a condition on them."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any

import click

from ros_in_python.field_path import NoSuchField, Step, fields_in, steps_of, value_at, written
from ros_in_python.ros2 import interfaces
from ros_in_python.ros2.cli import CommandError, F
from ros_in_python.ros2.names import seen

if TYPE_CHECKING:
    from ros_in_python.ros2.graph import GraphView

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

    def passes(message: Any) -> bool:
        try:
            # The person at the terminal wrote it, for their own process.
            return bool(eval(code, {"m": message}))
        except Exception as error:
            raise CommandError(f"--filter {text!r} failed: {error}", "The message is called m.") from None

    return passes


filter_option: Callable[[F], F] = click.option(
    "--filter",
    "filter_expression",
    callback=_compile,
    metavar="EXPR",
    help="Only messages for which this Python expression is true; the message is m.",
)


#: The number of elements or characters that are shown, unless a person asks for more.
LENGTH = 128


def reading_options(command: F) -> F:
    """Add the options that say how messages are printed."""
    for option in (
        click.option(
            "-l",
            "--truncate-length",
            type=click.IntRange(min=0),
            default=LENGTH,
            show_default=True,
            help="Elements or characters to show before '...'.",
        ),
        click.option("-f", "--full-length", is_flag=True, help="Print arrays and strings whole."),
        click.option("--no-str", is_flag=True, help="Print only the length of strings."),
        click.option("--no-arr", is_flag=True, help="Print only the type and length of arrays."),
        click.option("--flow-style", is_flag=True, help="Arrays on one line."),
        click.option("--csv", is_flag=True, help="One line per message, values separated by commas."),
    ):
        command = option(command)
    return command


def field_path(text: str | None) -> tuple[Step, ...]:
    """Return the steps of `--field pose.position`. Raises `CommandError` if it has no name in it."""
    if text is None:
        return ()
    try:
        steps = steps_of(".".join(filter(None, text.split("."))))
    except ValueError:
        steps = ()
    if not steps:
        raise CommandError(
            f"Invalid field value '{text}'", "Expected names with dots between, as in header.stamp or position[0]"
        )
    return steps


def check_path(message: Any, path: Sequence[Step]) -> None:
    """Raise `CommandError` if a message class has no such field, with the fields that it has."""
    from ros_in_python.ros2.messages import field_names, is_message, type_name

    value = message()
    for step in path:
        if isinstance(step, int):
            return  # how many elements there are is only known of a message that arrives
        if step not in fields_in(value):
            kind = type(value).__name__
            owner, names = (type_name(value), field_names(value)) if is_message(value) else (kind, "none")
            raise CommandError(
                f"Invalid field '{written(path)}': '{kind}' object has no attribute '{step}'",
                f"Fields of {owner}: {names}.",
            )
        value = getattr(value, step)


def field(message: Any, path: Sequence[Step]) -> Any:
    """Return the field of a message that `path` leads to. Raises `CommandError` if there is no such field."""
    try:
        return value_at(message, path)
    except IndexError:
        raise CommandError(f"Invalid field '{written(path)}': the list has no such element in this message") from None
    except NoSuchField as error:
        raise CommandError(f"Invalid field '{written(path)}': {error}") from None


def type_on_graph(graph: GraphView, topic: str) -> Any | None:
    """Return the class of a topic's messages as the graph has it now, None if there is no such topic.

    Raises `CommandError` if its ends disagree about the type, or where the type is not installed.
    """
    types = graph.topic_types(topic)
    if len(types) > 1:
        raise CommandError(
            f"Cannot echo topic '{topic}', as it contains more than one type: [{', '.join(types)}]",
            f"Ends of different types never connect. `ros2 topic info -v {topic}` shows who uses which.",
        )
    return interfaces.message_class(types[0]) if types else None


def wait_for_type(graph: GraphView, topic: str) -> Any:
    """Return the class of a topic's messages; if there is no such topic, warn and wait for it, without a limit."""
    graph.settle(lambda: bool(graph.topic_types(topic)))

    message = type_on_graph(graph, topic)
    if message is None:
        print(f"WARNING: topic [{topic}] does not appear to be published yet", flush=True)
    while message is None:
        graph.spin_until(lambda: bool(graph.topic_types(topic)))
        message = type_on_graph(graph, topic)
    return message


def type_or_refusal(graph: GraphView, topic: str) -> Any:
    """Return the class of a topic's messages. Raises `CommandError`, after the real one's warning, if there is none."""
    message = type_on_graph(graph, topic)
    if message is None:
        print(f"WARNING: topic [{topic}] does not appear to be published yet", flush=True)
        raise CommandError(
            "Could not determine the type for the passed topic",
            seen("Topics", (found.name for found in graph.topics())),
            f"To wait for it, name the type too: ros2 topic echo {topic} std_msgs/msg/String",
        )
    return message
