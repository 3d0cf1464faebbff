"""`ros2 topic list`, `find`, `info` and `type`: which topics there are, and who takes part in them."""

from __future__ import annotations

from typing import TYPE_CHECKING

import click

from ros_in_python.ros2 import interfaces
from ros_in_python.ros2.cli import CONTEXT, CommandError, discovery_options
from ros_in_python.ros2.opening import open_graph

if TYPE_CHECKING:
    from ros_in_python.ros2.graph import GraphView


@click.command(name="list", context_settings=CONTEXT)
@click.option("-t", "--show-types", is_flag=True, help="Show each topic's type too.")
@click.option("-v", "--verbose", is_flag=True, help="Count publishers and subscribers.")
@click.option("-c", "--count-topics", is_flag=True, help="Print only the number of topics.")
@click.option("-a", "--include-hidden-topics", is_flag=True, help="Also hidden topics (an underscore before a part).")
@discovery_options
def list_(
    show_types: bool,
    verbose: bool,
    count_topics: bool,
    include_hidden_topics: bool,
    spin_time: float | None,
    use_sim_time: bool,
) -> None:
    """All topics.

    \b
      ros2 topic list -t
      /joint_commands [sensor_msgs/msg/JointState]
    """
    with open_graph(spin_time=spin_time, use_sim_time=use_sim_time) as graph:
        from rclpy.topic_or_service_is_hidden import topic_or_service_is_hidden

        graph.settle()
        topics = [
            topic for topic in graph.topics() if include_hidden_topics or not topic_or_service_is_hidden(topic.name)
        ]
        counts = {
            topic.name: (len(graph.publishers(topic.name)), len(graph.subscriptions(topic.name))) for topic in topics
        }
    if count_topics:
        click.echo(str(len(topics)))
    elif verbose:
        if topics:
            published = [(str(topic), counts[topic.name][0]) for topic in topics]
            subscribed = [(str(topic), counts[topic.name][1]) for topic in topics]
            click.echo(_counted("Published topics:", published, "publisher"))
            click.echo(_counted("Subscribed topics:", subscribed, "subscriber"))
    else:
        for topic in topics:
            click.echo(str(topic) if show_types else topic.name)


def _counted(title: str, topics: list[tuple[str, int]], what: str) -> str:
    lines = [f" * {topic} {count} {what}{'s' if count > 1 else ''}" for topic, count in topics if count]
    return "".join(f"{line}\n" for line in (title, *lines))


@click.command(context_settings=CONTEXT)
@click.argument("topic_type")
@click.option("-c", "--count-topics", is_flag=True, help="Print only the number.")
@click.option("-a", "--include-hidden-topics", is_flag=True, help="Also hidden topics (an underscore before a part).")
@discovery_options
def find(
    topic_type: str, count_topics: bool, include_hidden_topics: bool, spin_time: float | None, use_sim_time: bool
) -> None:
    """The topics of a type.

    \b
      ros2 topic find sensor_msgs/msg/JointState
      /joint_commands
    """
    wanted = interfaces.full_name(topic_type, "msg")
    with open_graph(spin_time=spin_time, use_sim_time=use_sim_time) as graph:
        from rclpy.topic_or_service_is_hidden import topic_or_service_is_hidden

        graph.settle(lambda: any(wanted in topic.types for topic in graph.topics()))
        names = [
            topic.name
            for topic in graph.topics()
            if wanted in topic.types and (include_hidden_topics or not topic_or_service_is_hidden(topic.name))
        ]
    for line in [str(len(names))] if count_topics else names:
        click.echo(line)


@click.command(context_settings=CONTEXT)
@click.argument("topic_name")
@click.option("-v", "--verbose", is_flag=True, help="Show node, type and QoS of each publisher and subscription.")
@discovery_options
def info(topic_name: str, verbose: bool, spin_time: float | None, use_sim_time: bool) -> None:
    """Who publishes and subscribes, with which QoS.

    \b
      ros2 topic info -v /joint_commands
    """
    with open_graph(spin_time=spin_time, use_sim_time=use_sim_time) as graph:
        from ros_in_python.ros2.graph import absolute

        name = absolute(topic_name)
        types = _types(graph, name, topic_name)
        publishers, subscriptions = graph.publishers(name), graph.subscriptions(name)
    gap = "\n\n" if verbose else "\n"
    click.echo(f"Type: {types[0] if len(types) == 1 else list(types)}{gap}", nl=False)
    for what, ends in (("Publisher", publishers), ("Subscription", subscriptions)):
        click.echo(f"{what} count: {len(ends)}{gap}", nl=False)
        if verbose:
            for end in ends:
                click.echo(f"{end}{gap}", nl=False)


@click.command(name="type", context_settings=CONTEXT)
@click.argument("topic_name")
@discovery_options
def type_(topic_name: str, spin_time: float | None, use_sim_time: bool) -> None:
    """The type of a topic.

    \b
      ros2 topic type /joint_commands
      sensor_msgs/msg/JointState
    """
    with open_graph(spin_time=spin_time, use_sim_time=use_sim_time) as graph:
        from ros_in_python.ros2.graph import absolute

        types = _types(graph, absolute(topic_name), topic_name)
    for kind in types:
        click.echo(kind)


def _types(graph: GraphView, name: str, written: str) -> tuple[str, ...]:
    """Return the types of the topic `name`, once it exists. Raises `CommandError`, which calls it `written`."""
    from ros_in_python.ros2.graph import seen

    graph.settle(lambda: bool(graph.topic_types(name)))
    types = graph.topic_types(name)
    if not types:
        raise CommandError(f"Unknown topic '{written}'", seen("Topics", (topic.name for topic in graph.topics())))
    return types
