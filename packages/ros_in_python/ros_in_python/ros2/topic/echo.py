"""`ros2 topic echo`."""

from __future__ import annotations

import sys
import time
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import click
import yaml

from ros_in_python.field_path import Step
from ros_in_python.ros2 import interfaces
from ros_in_python.ros2.names import absolute
from ros_in_python.ros2.opening import with_graph
from ros_in_python.ros2.qos import QosOptions, profile, qos_options, suiting
from ros_in_python.ros2.topic.selection import (
    check_path,
    field,
    field_path,
    filter_option,
    reading_options,
    type_or_refusal,
)

if TYPE_CHECKING:
    from ros_in_python.ros2.graph import GraphView


@click.command()
@click.argument("topic_name")
@click.argument("message_type", required=False)
@click.option("--once", is_flag=True, help="Print the first message and exit.")
@click.option("--timeout", type=click.FloatRange(min=0, min_open=True), metavar="N", help="Exit after N seconds.")
@click.option("--field", metavar="FIELD", help="Only this field, as in header.stamp or position[0]")
@reading_options
@filter_option
@click.option("-i", "--include-message-info", is_flag=True, help="Time stamps and numbers of each message.")
@click.option("--raw", is_flag=True, help="The bytes as they arrived.")
@click.option("--no-lost-messages", is_flag=True, help="Don't report lost messages.")
@click.option("--lost-messages", is_flag=True, expose_value=False, hidden=True)
@qos_options("sensor_data")
@with_graph
def echo(graph: GraphView, topic_name: str, message_type: str | None, qos: QosOptions, **options: Any) -> None:
    """Print the messages of a topic; Ctrl-C ends it.

    \b
      ros2 topic echo --once /joint_commands
      ros2 topic echo /joint_commands --field position
      ros2 topic echo --csv /joint_commands > joints.csv

    It asks for the QoS that the topic's publishers offer, so that it hears every one.
    """
    name = absolute(topic_name)
    path = field_path(options["field"])
    message = None if message_type is None else interfaces.message_class(message_type)
    profile(qos)  # an unknown name should show at once
    graph.settle(lambda: bool(graph.publishers(name)))
    if message is None:
        message = type_or_refusal(graph, name)
    if not options["raw"]:
        check_path(message, path)
    listen(graph, name, message, path, suiting(graph, name, qos), options)


def listen(
    graph: GraphView, topic: str, message: Any, path: Sequence[Step], profile: Any, options: dict[str, Any]
) -> None:
    """Print what arrives on a topic, as the options say, until it is enough or a signal comes."""
    from rclpy.event_handler import SubscriptionEventCallbacks, UnsupportedEventTypeError

    printed = 0
    options = {"once": False, "timeout": None, "raw": False, "filter_expression": None, **options}
    text = _printer(options)
    passes = options["filter_expression"]
    start = time.monotonic()

    def arrived(data: Any, info: dict[str, Any]) -> None:
        nonlocal printed
        if options["once"] and printed:
            return
        part = data if options["raw"] else field(data, path)
        if passes is None or passes(part):
            sys.stdout.write(text(part, info))
            sys.stdout.flush()
            printed += 1

    # A callback of two arguments gets the message and what is known of it; the annotation in rclpy has one only.
    callback: Any = arrived

    def subscribe(events: Any) -> None:
        graph.node.create_subscription(message, topic, callback, profile, event_callbacks=events, raw=options["raw"])

    try:
        subscribe(SubscriptionEventCallbacks(message_lost=None if options.get("no_lost_messages") else _lost))
    except UnsupportedEventTypeError:
        subscribe(None)

    if graph.spin_until(lambda: bool(options["once"] and printed), options["timeout"]):
        return
    waited = time.monotonic() - start
    if not printed:
        click.echo(f"No message on {topic} within {waited:.0f} s.", err=True)


def _printer(options: dict[str, Any]) -> Any:
    from ros_in_python.ros2.messages import Brevity, is_message, to_csv, to_yaml

    length = None if options["full_length"] else options["truncate_length"]
    brevity = Brevity(length, options["no_arr"], options["no_str"])
    with_info = options.get("include_message_info", False)

    def text(part: Any, info: dict[str, Any]) -> str:
        if not is_message(part):
            about = f"---Got new message, message info:---\n{info}\n---Message data:---\n" if with_info else ""
            return f"{about}{part}\n---\n"
        if options["csv"]:
            about = ",".join(str(value) for value in info.values()) + "," if with_info else ""
            return about + to_csv(part, brevity) + "\n"
        about = f"{yaml.dump(info)}---\n" if with_info else ""
        return about + to_yaml(part, brevity, flow_style=options["flow_style"]) + "---\n"

    return text


def _lost(status: Any) -> None:
    """Report lost messages, with the real command's line ends."""
    print(
        f"A message was lost!!!\n\ttotal count change:{status.total_count_change}\n\ttotal count: {status.total_count}",
        end="---\n",
        flush=True,
    )
