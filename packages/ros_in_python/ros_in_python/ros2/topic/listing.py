"""`ros2 topic list`, `find`, `info` and `type`: which topics there are, and who takes part in them."""

from __future__ import annotations

from typing import TYPE_CHECKING

import click

from ros_in_python.ros2 import interfaces
from ros_in_python.ros2.cli import show_names
from ros_in_python.ros2.opening import with_graph
from ros_in_python.ros2.typed_names import existing, listing_options, show, show_of_type, show_types_option

if TYPE_CHECKING:
    from ros_in_python.ros2.graph import GraphView


@click.command(name="list")
@show_types_option
@click.option("-v", "--verbose", is_flag=True, help="Count publishers and subscribers.")
@listing_options("topic")
@with_graph
def list_(graph: GraphView, show_types: bool, verbose: bool, only_count: bool, include_hidden: bool) -> None:
    """All topics.

    \b
      ros2 topic list -t
      /joint_commands [sensor_msgs/msg/JointState]
    """
    graph.settle()
    topics = [topic for topic in graph.topics() if include_hidden or not topic.hidden]
    if only_count or not verbose:
        show(topics, show_types=show_types, only_count=only_count)
    elif topics:
        published = [(str(topic), len(graph.publishers(topic.name))) for topic in topics]
        subscribed = [(str(topic), len(graph.subscriptions(topic.name))) for topic in topics]
        click.echo(_counted("Published topics:", published, "publisher"))
        click.echo(_counted("Subscribed topics:", subscribed, "subscriber"))


def _counted(title: str, topics: list[tuple[str, int]], noun: str) -> str:
    lines = [f" * {topic} {count} {noun}{'s' if count > 1 else ''}" for topic, count in topics if count]
    return "".join(f"{line}\n" for line in (title, *lines))


@click.command()
@click.argument("topic_type")
@listing_options("topic")
@with_graph
def find(graph: GraphView, topic_type: str, only_count: bool, include_hidden: bool) -> None:
    """The topics of a type.

    \b
      ros2 topic find sensor_msgs/msg/JointState
      /joint_commands
    """
    show_of_type(graph, graph.topics, interfaces.full_name(topic_type, "msg"), only_count, include_hidden)


@click.command()
@click.argument("topic_name")
@click.option("-v", "--verbose", is_flag=True, help="Show node, type and QoS of each publisher and subscription.")
@with_graph
def info(graph: GraphView, topic_name: str, verbose: bool) -> None:
    """Who publishes and subscribes, with which QoS.

    \b
      ros2 topic info -v /joint_commands
    """
    topic = existing(graph, graph.topics, "topic", topic_name)
    gap = "\n\n" if verbose else "\n"
    click.echo(f"Type: {topic.types[0] if len(topic.types) == 1 else list(topic.types)}{gap}", nl=False)
    ends_by_role = {"Publisher": graph.publishers(topic.name), "Subscription": graph.subscriptions(topic.name)}
    for role, ends in ends_by_role.items():
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
    show_names(existing(graph, graph.topics, "topic", topic_name).types, only_count=False)
