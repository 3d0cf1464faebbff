"""`ros2 topic info`."""

from __future__ import annotations

import click

from spinbook.ros2.cli import CONTEXT, CommandError, discovery_options
from spinbook.ros2.opening import open_graph


@click.command(context_settings=CONTEXT)
@click.argument("topic_name")
@click.option("-v", "--verbose", is_flag=True, help="Each end's node, type and QoS.")
@discovery_options
def info(topic_name: str, verbose: bool, spin_time: float | None, use_sim_time: bool) -> None:
    """Who publishes and subscribes, with which QoS.

    \b
      ros2 topic info -v /joint_commands
    """
    with open_graph(spin_time=spin_time, use_sim_time=use_sim_time) as graph:
        from spinbook.ros2.graph import absolute, seen

        name = absolute(topic_name)
        graph.settle(lambda: bool(graph.topic_types(name)))
        types = graph.topic_types(name)
        publishers, subscriptions = graph.publishers(name), graph.subscriptions(name)
        if not types:
            raise CommandError(
                f"Unknown topic '{topic_name}'", seen("Topics", (topic.name for topic in graph.topics()))
            )
    gap = "\n\n" if verbose else "\n"
    click.echo(f"Type: {types[0] if len(types) == 1 else list(types)}{gap}", nl=False)
    for what, ends in (("Publisher", publishers), ("Subscription", subscriptions)):
        click.echo(f"{what} count: {len(ends)}{gap}", nl=False)
        if verbose:
            for end in ends:
                click.echo(f"{end}{gap}", nl=False)
