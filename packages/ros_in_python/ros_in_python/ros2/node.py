"""`ros2 node`: list and info."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import click

from ros_in_python.ros2.cli import CommandError, Menu, show_names
from ros_in_python.ros2.names import absolute_node, seen
from ros_in_python.ros2.opening import with_graph

if TYPE_CHECKING:
    from ros_in_python.ros2.graph import GraphView

node = Menu(
    name="node",
    help="""List running nodes, show what one offers.

    \b
      ros2 node list
      ros2 node info /joint_command_publisher
    """,
)


@node.command(name="list")
@click.option("-a", "--all", "include_hidden", is_flag=True, help="Hidden nodes too (an underscore before the name).")
@click.option("-c", "--count-nodes", is_flag=True, help="Print only the number.")
@with_graph
def list_(graph: GraphView, include_hidden: bool, count_nodes: bool) -> None:
    """The nodes that run.

    \b
      ros2 node list
      /joint_command_publisher
    """
    graph.settle()
    names = graph.node_names(include_hidden)
    if len(set(names)) < len(names) and not count_nodes:
        click.echo(
            "WARNING: Be aware that there are nodes in the graph that share an exact name, "
            "which can have unintended side effects.",
            err=True,
        )
    show_names(names, count_nodes)


@node.command()
@click.argument("node_name")
@click.option("--include-hidden", is_flag=True, help="Hidden topics, services and actions too.")
@with_graph
def info(graph: GraphView, node_name: str, include_hidden: bool) -> None:
    """The topics, services and actions of a node.

    \b
      ros2 node info /joint_command_publisher
    """
    # The real command knows nodes by their full names alone.
    full = node_name
    graph.settle(lambda: any(found.full_name == full for found in graph.nodes()))
    same = [found for found in graph.nodes() if found.full_name == full]
    if not same:
        meant = absolute_node(node_name)
        is_there = meant != node_name and any(found.full_name == meant for found in graph.nodes())
        raise CommandError(
            f"Unable to find node '{node_name}'",
            *([f"Its name begins with a slash: ros2 node info {meant}"] if is_there else []),
            seen("Nodes", graph.node_names(include_hidden=False)),
        )
    if len(same) > 1:
        click.echo(
            f'There are {len(same)} nodes in the graph with the exact name "{full}". '
            "You are seeing information about only one of them.",
            err=True,
        )
    sections = _sections(graph, same[0].name, same[0].namespace, include_hidden)
    click.echo(full)
    for title, entries in sections:
        click.echo(f"  {title}:")
        click.echo("\n".join(f"    {name}: {', '.join(types)}" for name, types in entries))


def _sections(graph: GraphView, name: str, namespace: str, include_hidden: bool) -> list[tuple[str, list[Any]]]:
    from rclpy.action import get_action_client_names_and_types_by_node, get_action_server_names_and_types_by_node
    from rclpy.topic_or_service_is_hidden import topic_or_service_is_hidden

    ours = graph.node
    found = [
        ("Subscribers", ours.get_subscriber_names_and_types_by_node(name, namespace)),
        ("Publishers", ours.get_publisher_names_and_types_by_node(name, namespace)),
        ("Service Servers", ours.get_service_names_and_types_by_node(name, namespace)),
        ("Service Clients", ours.get_client_names_and_types_by_node(name, namespace)),
        ("Action Servers", get_action_server_names_and_types_by_node(ours, name, namespace)),
        ("Action Clients", get_action_client_names_and_types_by_node(ours, name, namespace)),
    ]
    return [
        (title, [entry for entry in entries if include_hidden or not topic_or_service_is_hidden(entry[0])])
        for title, entries in found
    ]
