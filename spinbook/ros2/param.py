"""`ros2 param`: list, get, set, describe, dump, load and delete, through each node's own parameter services."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import click
import yaml

from spinbook.ros2 import asking_parameters as asking
from spinbook.ros2.groups import CONTEXT, Entry, Menu, discovery_options
from spinbook.ros2.middleware import open_graph
from spinbook.ros2.refusal import Refusal

if TYPE_CHECKING:
    from spinbook.ros2.graph import Graph

param = Menu(
    name="param",
    entries={
        "delete": Entry("spinbook.ros2.param:delete", "Delete a parameter of a node."),
        "describe": Entry("spinbook.ros2.param:describe", "What is known of a parameter: type, range."),
        "dump": Entry("spinbook.ros2.param:dump", "All parameters of a node, in a parameter file's YAML."),
        "get": Entry("spinbook.ros2.param:get", "The value of a parameter."),
        "list": Entry("spinbook.ros2.param:list_", "The parameters of one node or of all."),
        "load": Entry("spinbook.ros2.param:load", "Set a node's parameters from a parameter file."),
        "set": Entry("spinbook.ros2.param:set_", "Give a parameter another value."),
    },
    help="""Read and change parameters of running nodes.

    \b
      ros2 param list /joint_state_monitor
      ros2 param get /joint_state_monitor use_sim_time
    """,
)

# By rcl_interfaces/msg/ParameterType: how `describe` names a type, and how `get` begins its line.
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
_hidden_nodes = click.option("-a", "--include-hidden-nodes", is_flag=True, help="Hidden nodes too.")


@click.command(name="list", context_settings=CONTEXT)
@click.argument("node_name", required=False)
@_hidden_nodes
@click.option("--param-type", is_flag=True, help="Show each parameter's type too.")
@discovery_options
def list_(
    node_name: str | None, include_hidden_nodes: bool, param_type: bool, spin_time: float | None, use_sim_time: bool
) -> None:
    """The parameters of one node or of all.

    \b
      ros2 param list /joint_state_monitor
    """
    with open_graph(spin_time=spin_time, use_sim_time=use_sim_time) as graph:
        if node_name is None:
            graph.settle()
            names = sorted({node.full_name for node in graph.nodes() if include_hidden_nodes or not node.hidden})
        else:
            names = [asking.find_node(graph, node_name, include_hidden_nodes)]
        for name in names:
            try:
                client = asking.client_of(graph, name)
                params = sorted(asking.answer(graph, name, client.list_parameters()).result.names)
                types = _described(graph, name, client, params) if param_type else {}
            except Refusal as refusal:
                if node_name is not None:
                    raise
                refusal.show()
                continue
            if node_name is None:
                click.echo(f"{name}:")
            for parameter in params:
                click.echo(f"  {parameter} (type: {types[parameter]})" if param_type else f"  {parameter}")


@click.command(context_settings=CONTEXT)
@click.argument("node_name")
@click.argument("parameter_name")
@_hidden_nodes
@click.option("--hide-type", is_flag=True, help="The value alone.")
@discovery_options
def get(
    node_name: str,
    parameter_name: str,
    include_hidden_nodes: bool,
    hide_type: bool,
    spin_time: float | None,
    use_sim_time: bool,
) -> None:
    """The value of a parameter.

    \b
      ros2 param get /joint_state_monitor use_sim_time
      Boolean value is: False
    """
    with open_graph(spin_time=spin_time, use_sim_time=use_sim_time) as graph:
        name = asking.find_node(graph, node_name, include_hidden_nodes)
        client = asking.client_of(graph, name)
        values = asking.answer(graph, name, client.get_parameters([parameter_name])).values
        if not values:
            raise Refusal("Parameter not set", _parameters_of(graph, name, client))
    kind = values[0].type
    label = _TYPES.get(kind, ("", f"Unknown parameter type '{kind}'"))[1]
    value = _plain(asking.value_of(values[0]))
    if hide_type:
        click.echo(str(value))
    else:
        click.echo(label if value is None else f"{label} {value}")


# Negative values begin as an option does.
@click.command(name="set", context_settings={**CONTEXT, "ignore_unknown_options": True})
@click.argument("node_name")
@click.argument("parameter_name")
@click.argument("value")
@_hidden_nodes
@discovery_options
def set_(
    node_name: str,
    parameter_name: str,
    value: str,
    include_hidden_nodes: bool,
    spin_time: float | None,
    use_sim_time: bool,
) -> None:
    """Give a parameter another value, in YAML: 3 is an integer, 3.0 a double, true a boolean.

    \b
      ros2 param set /joint_state_monitor use_sim_time true
    """
    with open_graph(spin_time=spin_time, use_sim_time=use_sim_time) as graph:
        from rcl_interfaces.msg import Parameter

        name = asking.find_node(graph, node_name, include_hidden_nodes)
        client = asking.client_of(graph, name)
        wanted = Parameter(name=parameter_name, value=asking.parameter_value(value))
        result = asking.answer(graph, name, client.set_parameters([wanted])).results[0]
        if not result.successful:
            raise Refusal(_with_reason("Setting parameter failed", result.reason))
    click.echo(_with_reason("Set parameter successful", result.reason))


@click.command(context_settings=CONTEXT)
@click.argument("node_name")
@click.argument("parameter_name")
@_hidden_nodes
@discovery_options
def delete(
    node_name: str, parameter_name: str, include_hidden_nodes: bool, spin_time: float | None, use_sim_time: bool
) -> None:
    """Delete a parameter of a node, which most nodes refuse for those they declared.

    \b
      ros2 param delete /joint_state_monitor gain
    """
    with open_graph(spin_time=spin_time, use_sim_time=use_sim_time) as graph:
        name = asking.find_node(graph, node_name, include_hidden_nodes)
        client = asking.client_of(graph, name)
        result = asking.answer(graph, name, client.delete_parameters([parameter_name])).results[0]
        if not result.successful:
            raise Refusal(_with_reason("Deleting parameter failed", result.reason))
    click.echo(_with_reason("Deleted parameter successfully", result.reason))


@click.command(context_settings=CONTEXT)
@click.argument("node_name")
@click.argument("parameter_names", nargs=-1, required=True)
@_hidden_nodes
@discovery_options
def describe(
    node_name: str,
    parameter_names: tuple[str, ...],
    include_hidden_nodes: bool,
    spin_time: float | None,
    use_sim_time: bool,
) -> None:
    """What is known of a parameter: its type and range.

    \b
      ros2 param describe /joint_state_monitor use_sim_time
    """
    with open_graph(spin_time=spin_time, use_sim_time=use_sim_time) as graph:
        name = asking.find_node(graph, node_name, include_hidden_nodes)
        client = asking.client_of(graph, name)
        descriptors = asking.answer(graph, name, client.describe_parameters(list(parameter_names))).descriptors
        if not descriptors:
            raise Refusal("Parameter not set", _parameters_of(graph, name, client))
    for descriptor in descriptors:
        for line in _description(descriptor):
            click.echo(line)


@click.command(context_settings=CONTEXT)
@click.argument("node_name")
@_hidden_nodes
@discovery_options
def dump(node_name: str, include_hidden_nodes: bool, spin_time: float | None, use_sim_time: bool) -> None:
    """All parameters of a node, as a parameter file for `ros2 run … --ros-args --params-file FILE`.

    \b
      ros2 param dump /joint_state_monitor > monitor.yaml
    """
    with open_graph(spin_time=spin_time, use_sim_time=use_sim_time) as graph:
        name = asking.find_node(graph, node_name, include_hidden_nodes)
        client = asking.client_of(graph, name)
        names = sorted(asking.answer(graph, name, client.list_parameters()).result.names)
        values = asking.answer(graph, name, client.get_parameters(names)).values if names else []
    tree: dict[str, Any] = {}
    for parameter, value in zip(names, values, strict=True):
        *branches, leaf = parameter.split(".")
        branch = tree
        for step in branches:
            branch = branch.setdefault(step, {})
        branch[leaf] = _plain(asking.value_of(value))
    click.echo(yaml.dump({name: {"ros__parameters": tree}}, default_flow_style=False))


@click.command(context_settings=CONTEXT)
@click.argument("node_name")
@click.argument("parameter_file", type=click.Path(path_type=Path))
@_hidden_nodes
@click.option("--no-use-wildcard", is_flag=True, help="Leave out what the file has under /**.")
@discovery_options
def load(
    node_name: str,
    parameter_file: Path,
    include_hidden_nodes: bool,
    no_use_wildcard: bool,
    spin_time: float | None,
    use_sim_time: bool,
) -> None:
    """Set a running node's parameters from a parameter file, one after the other.

    \b
      ros2 param load /joint_state_monitor monitor.yaml
    """
    with open_graph(spin_time=spin_time, use_sim_time=use_sim_time) as graph:
        name = asking.find_node(graph, node_name, include_hidden_nodes)
        parameters = asking.parameters_of_file(parameter_file, name, use_wildcard=not no_use_wildcard)
        client = asking.client_of(graph, name)
        results = asking.answer(graph, name, client.set_parameters(parameters)).results
    refused = []
    for parameter, result in zip(parameters, results, strict=True):
        outcome = "successful" if result.successful else "failed"
        line = _with_reason(f"Set parameter {parameter.name} {outcome}", result.reason)
        if result.successful:
            click.echo(line)
        else:
            refused.append(line)
    if refused:
        raise Refusal(*refused)


def _parameters_of(graph: Graph, name: str, client: Any) -> str:
    names = sorted(asking.answer(graph, name, client.list_parameters()).result.names)
    return f"Parameters of {name}: {', '.join(names)}."


def _described(graph: Graph, name: str, client: Any, params: list[str]) -> dict[str, str]:
    descriptors = asking.answer(graph, name, client.describe_parameters(params)).descriptors
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


def _plain(value: Any) -> Any:
    return value if isinstance(value, (bool, int, float, str, type(None))) else list(value)


def _with_reason(text: str, reason: str) -> str:
    return f"{text}: {reason}" if reason else text
