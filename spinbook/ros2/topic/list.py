"""`ros2 topic list`."""

from __future__ import annotations

import click

from spinbook.ros2.cli import CONTEXT, discovery_options
from spinbook.ros2.opening import open_graph


@click.command(name="list", context_settings=CONTEXT)
@click.option("-t", "--show-types", is_flag=True, help="Show each topic's type too.")
@click.option("-v", "--verbose", is_flag=True, help="Count publishers and subscribers.")
@click.option("-c", "--count-topics", is_flag=True, help="Print how many topics there are, no more.")
@click.option("-a", "--include-hidden-topics", is_flag=True, help="Those with an underscore before a part too.")
@discovery_options
def list_(
    show_types: bool,
    verbose: bool,
    count_topics: bool,
    include_hidden_topics: bool,
    spin_time: float | None,
    use_sim_time: bool,
) -> None:
    """The topics there are.

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
