"""`ros2 topic type`."""

from __future__ import annotations

import click

from spinbook.ros2.cli import CONTEXT, CommandError, discovery_options
from spinbook.ros2.opening import open_graph


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
        from spinbook.ros2.graph import absolute, seen

        name = absolute(topic_name)
        graph.settle(lambda: bool(graph.topic_types(name)))
        types = graph.topic_types(name)
        if not types:
            raise CommandError(
                f"Unknown topic '{topic_name}'", seen("Topics", (topic.name for topic in graph.topics()))
            )
    for kind in types:
        click.echo(kind)
