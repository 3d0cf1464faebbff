"""`ros2 lifecycle`: the state of nodes with a life cycle, and its changes.

States and transitions: https://design.ros2.org/articles/node_lifecycle.html
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import click

from ros_in_python.ros2.cli import CommandError, Menu, show_names
from ros_in_python.ros2.opening import with_graph
from ros_in_python.ros2.typed_names import existing_node

if TYPE_CHECKING:
    from ros_in_python.ros2.graph import GraphView

#: The service that each node with a life cycle has.
_GET_STATE = "lifecycle_msgs/srv/GetState"

lifecycle = Menu(
    name="lifecycle",
    help="""Look at nodes with a life cycle, and change their state.

    \b
      ros2 lifecycle nodes
      ros2 lifecycle get /camera
      ros2 lifecycle set /camera configure
    """,
)
_hidden_nodes = click.option("--include-hidden-nodes", is_flag=True, help="Hidden nodes too.")


@lifecycle.command()
@click.option("-a", "--all", "include_hidden_nodes", is_flag=True, help="Hidden nodes too.")
@click.option("-c", "--count-nodes", is_flag=True, help="Print only the number.")
@with_graph
def nodes(graph: GraphView, include_hidden_nodes: bool, count_nodes: bool) -> None:
    """All nodes with a life cycle.

    \b
      ros2 lifecycle nodes
    """
    graph.settle()
    show_names(_nodes(graph, include_hidden_nodes), count_nodes)


@lifecycle.command()
@click.argument("node_name", required=False)
@_hidden_nodes
@with_graph
def get(graph: GraphView, node_name: str | None, include_hidden_nodes: bool) -> None:
    """The state of one node, or of all with a life cycle.

    \b
      ros2 lifecycle get /camera
      unconfigured [1]
    """
    if node_name is not None:
        click.echo(_state(graph, _existing(graph, node_name, include_hidden_nodes)))
        return
    graph.settle()
    for name in _nodes(graph, include_hidden_nodes):
        click.echo(f"{name}: {_state(graph, name)}")


@lifecycle.command(name="list")
@click.argument("node_name")
@click.option("-a", "--all", "all_transitions", is_flag=True, help="Those of all states, not only of the current one.")
@_hidden_nodes
@with_graph
def list_(graph: GraphView, node_name: str, all_transitions: bool, include_hidden_nodes: bool) -> None:
    """The transitions that a node can make now.

    \b
      ros2 lifecycle list /camera
    """
    name = _existing(graph, node_name, include_hidden_nodes)
    service = "get_transition_graph" if all_transitions else "get_available_transitions"
    for offered in call(graph, name, "GetAvailableTransitions", service).available_transitions:
        start, goal = offered.start_state.label, offered.goal_state.label
        click.echo(f"- {_named(offered.transition)}\n\tStart: {start}\n\tGoal: {goal}")


@lifecycle.command(name="set")
@click.argument("node_name")
@click.argument("transition")
@_hidden_nodes
@with_graph
def set_(graph: GraphView, node_name: str, transition: str, include_hidden_nodes: bool) -> None:
    """Make a node do a transition, given by its name or its number.

    \b
      ros2 lifecycle set /camera configure
    """
    name = _existing(graph, node_name, include_hidden_nodes)
    possible = call(graph, name, "GetAvailableTransitions", "get_available_transitions").available_transitions
    chosen = [each.transition for each in possible if transition in (each.transition.label, str(each.transition.id))]
    if not chosen:
        raise CommandError(
            "Unknown transition requested, available ones are:",
            *(f"- {_named(each.transition)}" for each in possible),
            f"The node is {_state(graph, name)}.",
        )
    result = call(graph, name, "ChangeState", "change_state", transition=chosen[0])
    if not result.success:
        raise CommandError("Transitioning failed", "The node's callback returned a failure or an error: see its log.")
    click.echo("Transitioning successful")


def _nodes(graph: GraphView, include_hidden: bool) -> list[str]:
    named = {service.name.removesuffix("/get_state") for service in graph.services() if _GET_STATE in service.types}
    return sorted(named.intersection(graph.node_names(include_hidden)))


def _existing(graph: GraphView, node_name: str, include_hidden: bool) -> str:
    return existing_node(graph, lambda: _nodes(graph, include_hidden), node_name, "Nodes with a life cycle")


def call(graph: GraphView, node: str, kind: str, service: str, **fields: Any) -> Any:
    """Return a node's answer to a service of its life cycle. Raises `CommandError` if there is none."""
    from lifecycle_msgs import srv

    from ros_in_python.ros2.param import READY, answer

    client = graph.node.create_client(getattr(srv, kind), f"{node}/{service}")
    if not graph.spin_until(client.service_is_ready, READY):
        raise CommandError(f"The node {node} has no service {service}: is it ending?")
    graph.wait_until_known(node)
    return answer(graph, node, client.call_async(getattr(srv, kind).Request(**fields)))


def _state(graph: GraphView, node: str) -> str:
    return _named(call(graph, node, "GetState", "get_state").current_state)


def _named(thing: Any) -> str:
    return f"{thing.label} [{thing.id}]"
