"""`ros2 param`: list, get, set, describe, dump and delete, through each node's parameter services."""

from __future__ import annotations

import functools
import re
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any, cast

import click
import yaml

from ros_in_python.ros2.cli import CommandError, F, Menu
from ros_in_python.ros2.opening import with_graph
from ros_in_python.ros2.typed_names import existing_node

if TYPE_CHECKING:
    from ros_in_python.ros2.graph import GraphView


#: Time limit for a node's parameter services to appear, and then to answer, in seconds.
READY, ANSWER = 5.0, 10.0

# By rcl_interfaces/msg/ParameterType: the type's name in `describe`, and how `get` begins its line.
_TYPES = {
    0: ("not set", "Parameter not set."),
    1: ("boolean", "Boolean value is:"),
    2: ("integer", "Integer value is:"),
    3: ("double", "Double value is:"),
    4: ("string", "String value is:"),
    5: ("byte array", "Byte values are:"),
    6: ("boolean array", "Boolean values are:"),
    7: ("integer array", "Integer values are:"),
    8: ("double array", "Double values are:"),
    9: ("string array", "String values are:"),
}


def client_of(graph: GraphView, name: str) -> Any:
    """Return a client of a node's parameter services that the node knows. Raises `CommandError` if it has none."""
    from rclpy.parameter_client import AsyncParameterClient

    client = AsyncParameterClient(graph.node, name)
    if not graph.spin_until(client.services_are_ready, READY):
        raise CommandError(
            f"Wait for service timed out waiting for parameter services for node {name}",
            "The node has none (start_parameter_services=False), or is ending.",
        )
    graph.wait_until_known(name)
    return client


def answer(graph: GraphView, name: str, future: Any) -> Any:
    """Return a node's reply. Raises `CommandError` if there is none."""
    if not graph.spin_until(future.done, ANSWER):
        raise CommandError(
            f"The node {name} did not answer within {ANSWER:.0f} s.",
            "A node answers while it spins: it may be stuck in a callback, or never call rclpy.spin.",
        )
    if future.exception() is not None or future.result() is None:
        raise CommandError(f"Exception while calling service of node '{name}': {future.exception()}")
    return future.result()


def parameter_value(text: str) -> Any:
    """Return what was typed as a rcl_interfaces/msg/ParameterValue, of the type that YAML gives it."""
    from rclpy.parameter import get_parameter_value

    try:
        return get_parameter_value(text)
    except yaml.YAMLError:
        from rcl_interfaces.msg import ParameterType, ParameterValue

        # Not YAML, so a text, as the real command takes it.
        return ParameterValue(type=ParameterType.PARAMETER_STRING, string_value=text)


def parameters_of_file(file: Path, node: str, *, use_wildcard: bool) -> list[Any]:
    """Return a node's (full name) parameters in a file, as rcl_interfaces/msg/Parameter. Raises `CommandError`."""
    from rclpy.parameter import parameter_dict_from_yaml_file

    try:
        written = yaml.safe_load(file.read_text(encoding="utf-8"))
        owners = [owner for owner in (["/**"] if use_wildcard else []) + [node] if owner in written]
        parameters = parameter_dict_from_yaml_file(str(file), target_nodes=owners or [node])
    except OSError as error:
        raise CommandError(f"{file}: {error.strerror}") from None
    except yaml.YAMLError as error:
        raise CommandError(f"{file} is not valid YAML: {error}") from None
    except (RuntimeError, TypeError, AttributeError, ValueError) as error:
        raise CommandError(
            f"{file} has no parameters for {node}: {error}",
            f"It needs the node's name, then ros__parameters, then the parameters: {node}: {{ros__parameters: {{…}}}}",
        ) from None
    return list(parameters.values())


param = Menu(
    name="param",
    help="""Read and change parameters of running nodes.

    \b
      ros2 param list /joint_state_monitor
      ros2 param get /joint_state_monitor use_sim_time
    """,
)

_hidden_nodes = click.option("-a", "--include-hidden-nodes", is_flag=True, help="Hidden nodes too.")


def _existing(graph: GraphView, node_name: str, include_hidden: bool) -> str:
    return existing_node(graph, lambda: graph.node_names(include_hidden), node_name)


def _of_a_node(command: F) -> F:
    """Give a command the graph, and the full name and a client of the node that is its argument `node_name`."""

    @functools.wraps(command)
    def run(graph: GraphView, node_name: str, include_hidden_nodes: bool, **named: Any) -> Any:
        name = _existing(graph, node_name, include_hidden_nodes)
        return command(graph, name, client_of(graph, name), **named)

    return cast("F", _hidden_nodes(with_graph(run)))


@param.command(name="list")
@click.argument("node_name", required=False)
@_hidden_nodes
@click.option("--param-prefixes", "prefixes", multiple=True, metavar="NAME", help="Only those below NAME: NAME.x")
@click.option("--param-type", is_flag=True, help="Show each parameter's type too.")
@click.option("--filter", "expression", default="", metavar="REGEX", help="Only those whose names match.")
@with_graph
def list_(
    graph: GraphView,
    node_name: str | None,
    include_hidden_nodes: bool,
    prefixes: tuple[str, ...],
    param_type: bool,
    expression: str,
) -> None:
    """The parameters of one node or of all.

    \b
      ros2 param list /joint_state_monitor
      ros2 param list /arm --param-prefixes left --filter "left.k.*"
    """
    matches = _matcher(expression)
    if node_name is None:
        graph.settle()
        names = sorted(set(graph.node_names(include_hidden_nodes)))
    else:
        names = [_existing(graph, node_name, include_hidden_nodes)]
    for name in names:
        try:
            client = client_of(graph, name)
            listed = answer(graph, name, client.list_parameters(prefixes=list(prefixes) or None)).result.names
            params = sorted(filter(matches, listed))
            types = _described(graph, name, client, params) if param_type else {}
        except CommandError as refusal:
            if node_name is not None:
                raise
            refusal.show()
            continue
        if node_name is None:
            click.echo(f"{name}:")
        for parameter in params:
            click.echo(f"  {parameter} (type: {types[parameter]})" if param_type else f"  {parameter}")


@param.command()
@click.argument("node_name")
@click.argument("parameter_name")
@click.option("--hide-type", is_flag=True, help="The value alone.")
@_of_a_node
def get(graph: GraphView, name: str, client: Any, parameter_name: str, hide_type: bool) -> None:
    """The value of a parameter.

    \b
      ros2 param get /joint_state_monitor use_sim_time
      Boolean value is: False
    """
    from rclpy.parameter import parameter_value_to_python

    values = answer(graph, name, client.get_parameters([parameter_name])).values
    if not values:
        raise CommandError("Parameter not set", _parameters_of(graph, name, client))
    label, value = _TYPES[values[0].type][1], parameter_value_to_python(values[0])
    if hide_type:
        click.echo(str(value))
    else:
        click.echo(label if value is None else f"{label} {value}")


# Negative values begin as an option does.
@param.command(name="set", context_settings={"ignore_unknown_options": True})
@click.argument("node_name")
@click.argument("parameter_name")
@click.argument("value")
@_of_a_node
def set_(graph: GraphView, name: str, client: Any, parameter_name: str, value: str) -> None:
    """Give a parameter another value, in YAML: 3 is an integer, 3.0 a double, true a boolean.

    \b
      ros2 param set /joint_state_monitor use_sim_time true
    """
    from rcl_interfaces.msg import Parameter

    parameter = Parameter(name=parameter_name, value=parameter_value(value))
    result = answer(graph, name, client.set_parameters([parameter])).results[0]
    if result.successful:
        click.echo(_with_reason("Set parameter successful", result.reason))
    else:
        # As ROS 2's own command: a node that refuses a value has answered, and the command has not failed.
        click.echo(_with_reason("Setting parameter failed", result.reason), err=True)


@param.command()
@click.argument("node_name")
@click.argument("parameter_name")
@_of_a_node
def delete(graph: GraphView, name: str, client: Any, parameter_name: str) -> None:
    """Delete a parameter of a node, which most nodes refuse for those they declared.

    \b
      ros2 param delete /joint_state_monitor gain
    """
    result = answer(graph, name, client.delete_parameters([parameter_name])).results[0]
    if not result.successful:
        raise CommandError(_with_reason("Deleting parameter failed", result.reason))
    click.echo(_with_reason("Deleted parameter successfully", result.reason))


@param.command()
@click.argument("node_name")
@click.argument("parameter_names", nargs=-1, required=True)
@_of_a_node
def describe(graph: GraphView, name: str, client: Any, parameter_names: tuple[str, ...]) -> None:
    """What is known of a parameter: its type and range.

    \b
      ros2 param describe /joint_state_monitor use_sim_time
    """
    descriptors = answer(graph, name, client.describe_parameters(list(parameter_names))).descriptors
    if not descriptors:
        raise CommandError("Parameter not set", _parameters_of(graph, name, client))
    for descriptor in descriptors:
        for line in _description(descriptor):
            click.echo(line)


@param.command()
@click.argument("node_name")
@_of_a_node
def dump(graph: GraphView, name: str, client: Any) -> None:
    """All parameters of a node, as a parameter file for `ros2 run … --ros-args --params-file FILE`.

    \b
      ros2 param dump /joint_state_monitor > monitor.yaml
    """
    from rclpy.parameter import parameter_value_to_python

    names = sorted(answer(graph, name, client.list_parameters()).result.names)
    values = answer(graph, name, client.get_parameters(names)).values if names else []
    tree: dict[str, Any] = {}
    for parameter, value in zip(names, values, strict=True):
        *branches, leaf = parameter.split(".")
        branch = tree
        for step in branches:
            branch = branch.setdefault(step, {})
        branch[leaf] = parameter_value_to_python(value)
    click.echo(yaml.dump({name: {"ros__parameters": tree}}, default_flow_style=False))


@param.command()
@click.argument("node_name")
@click.argument("parameter_file", type=click.Path(path_type=Path))
@click.option("--no-use-wildcard", is_flag=True, help="Leave out what the file has under /**.")
@_of_a_node
def load(graph: GraphView, name: str, client: Any, parameter_file: Path, no_use_wildcard: bool) -> None:
    """Set a running node's parameters from a parameter file, one after another.

    \b
      ros2 param load /joint_state_monitor monitor.yaml
    """
    parameters = parameters_of_file(parameter_file, name, use_wildcard=not no_use_wildcard)
    results = answer(graph, name, client.set_parameters(parameters)).results
    refused = []
    for parameter, result in zip(parameters, results, strict=True):
        outcome = "successful" if result.successful else "failed"
        line = _with_reason(f"Set parameter {parameter.name} {outcome}", result.reason)
        if result.successful:
            click.echo(line)
        else:
            refused.append(line)
    if refused:
        raise CommandError(*refused)


def _matcher(expression: str) -> Callable[[str], Any]:
    try:
        return re.compile(expression).match
    except re.error as error:
        raise CommandError(f"'{expression}' is not a valid regular expression: {error}") from None


def _parameters_of(graph: GraphView, name: str, client: Any) -> str:
    names = sorted(answer(graph, name, client.list_parameters()).result.names)
    return f"Parameters of {name}: {', '.join(names)}."


def _described(graph: GraphView, name: str, client: Any, params: list[str]) -> dict[str, str]:
    descriptors = answer(graph, name, client.describe_parameters(params)).descriptors
    return {descriptor.name: _TYPES[descriptor.type][0] for descriptor in descriptors}


def _description(descriptor: Any) -> list[str]:
    lines = [f"Parameter name: {descriptor.name}", f"  Type: {_TYPES[descriptor.type][0]}"]
    if descriptor.description:
        lines.append(f"  Description: {descriptor.description}")
    lines.append("  Constraints:")
    if descriptor.read_only:
        lines.append("    Read only: true")
    for limits in [*descriptor.floating_point_range, *descriptor.integer_range][:1]:
        lines += [f"    Min value: {limits.from_value}", f"    Max value: {limits.to_value}"]
        if limits.step:
            lines.append(f"    Step: {limits.step}")
    if descriptor.additional_constraints:
        lines.append(f"    Additional constraints: {descriptor.additional_constraints}")
    return lines


def _with_reason(text: str, reason: str) -> str:
    return f"{text}: {reason}" if reason else text
