"""`ros2 topic list`, `find`, `info` and `type`: which topics there are, and who takes part in them."""

from __future__ import annotations

from typing import TYPE_CHECKING

import click

from ros_in_python.ros2 import interfaces
from ros_in_python.ros2.cli import CommandError, show_names
from ros_in_python.ros2.names import absolute, seen
from ros_in_python.ros2.opening import with_graph

if TYPE_CHECKING:
    from ros_in_python.ros2.graph import GraphView


@click.command(name="list")
@click.option("-t", "--show-types", is_flag=True, help="Show each topic's type too.")
@click.option("-v", "--verbose", is_flag=True, help="Count publishers and subscribers.")
@click.option("-c", "--count-topics", is_flag=True, help="Print only the number of topics.")
@click.option("-a", "--include-hidden-topics", is_flag=True, help="Also hidden topics (an underscore before a part).")
@with_graph
def list_(graph: GraphView, show_types: bool, verbose: bool, count_topics: bool, include_hidden_topics: bool) -> None:
    """All topics.

    \b
      ros2 topic list -t
      /joint_commands [sensor_msgs/msg/JointState]
    """
    graph.settle()
    topics = [topic for topic in graph.topics() if include_hidden_topics or not topic.hidden]
    if count_topics or not verbose:
        show_names([str(topic) if show_types else topic.name for topic in topics], count_topics)
    elif topics:
        published = [(str(topic), len(graph.publishers(topic.name))) for topic in topics]
        subscribed = [(str(topic), len(graph.subscriptions(topic.name))) for topic in topics]
        click.echo(_counted("Published topics:", published, "publisher"))
        click.echo(_counted("Subscribed topics:", subscribed, "subscriber"))


def _counted(title: str, topics: list[tuple[str, int]], what: str) -> str:
    lines = [f" * {topic} {count} {what}{'s' if count > 1 else ''}" for topic, count in topics if count]
    return "".join(f"{line}\n" for line in (title, *lines))


@click.command()
@click.argument("topic_type")
@click.option("-c", "--count-topics", is_flag=True, help="Print only the number.")
@click.option("-a", "--include-hidden-topics", is_flag=True, help="Also hidden topics (an underscore before a part).")
@with_graph
def find(graph: GraphView, topic_type: str, count_topics: bool, include_hidden_topics: bool) -> None:
    """The topics of a type.

    \b
      ros2 topic find sensor_msgs/msg/JointState
      /joint_commands
    """
    type_name = interfaces.full_name(topic_type, "msg")
    graph.settle(lambda: any(type_name in topic.types for topic in graph.topics()))
    topics = [topic for topic in graph.topics() if include_hidden_topics or not topic.hidden]
    show_names([topic.name for topic in topics if type_name in topic.types], count_topics)


@click.command()
@click.argument("topic_name")
@click.option("-v", "--verbose", is_flag=True, help="Show node, type and QoS of each publisher and subscription.")
@with_graph
def info(graph: GraphView, topic_name: str, verbose: bool) -> None:
    """Who publishes and subscribes, with which QoS.

    \b
      ros2 topic info -v /joint_commands
    """
    name = absolute(topic_name)
    types = _types(graph, name, topic_name)
    publishers, subscriptions = graph.publishers(name), graph.subscriptions(name)
    gap = "\n\n" if verbose else "\n"
    click.echo(f"Type: {types[0] if len(types) == 1 else list(types)}{gap}", nl=False)
    for role, ends in (("Publisher", publishers), ("Subscription", subscriptions)):
        click.echo(f"{role} count: {len(ends)}{gap}", nl=False)
        if verbose:
            for end in ends:
                click.echo(f"{end}{gap}", nl=False)


@click.command(name="type")
@click.argument("topic_name")
@with_graph
def type_(graph: GraphView, topic_name: str) -> None:
    """The type of a topic.

    \b
      ros2 topic type /joint_commands
      sensor_msgs/msg/JointState
    """
    show_names(_types(graph, absolute(topic_name), topic_name), only_count=False)


def _types(graph: GraphView, name: str, written: str) -> tuple[str, ...]:
    """Return the types of the topic `name`, once it exists. Raises `CommandError`, which calls it `written`."""
    graph.settle(lambda: bool(graph.topic_types(name)))
    types = graph.topic_types(name)
    if not types:
        raise CommandError(f"Unknown topic '{written}'", seen("Topics", (topic.name for topic in graph.topics())))
    return types
