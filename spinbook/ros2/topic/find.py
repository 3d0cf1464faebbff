"""`ros2 topic find`."""

from __future__ import annotations

import click

from spinbook.ros2 import interfaces
from spinbook.ros2.cli import CONTEXT, discovery_options
from spinbook.ros2.opening import open_graph


@click.command(context_settings=CONTEXT)
@click.argument("topic_type")
@click.option("-c", "--count-topics", is_flag=True, help="Print how many there are, no more.")
@click.option("-a", "--include-hidden-topics", is_flag=True, help="Those with an underscore before a part too.")
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
