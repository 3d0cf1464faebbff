"""Asking a node for its parameters, and the values that come back."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import yaml

from spinbook.ros2.refusal import Refusal

if TYPE_CHECKING:
    from spinbook.ros2.graph import Graph

#: Seconds that a node's parameter services get to appear, and then to answer.
READY, ANSWER = 5.0, 10.0

# By rcl_interfaces/msg/ParameterType.
_VALUE_FIELDS = (
    "",
    "bool_value",
    "integer_value",
    "double_value",
    "string_value",
    "byte_array_value",
    "bool_array_value",
    "integer_array_value",
    "double_array_value",
    "string_array_value",
)


def find_node(graph: Graph, node_name: str, include_hidden: bool) -> str:
    """The full name of a running node. Raises `Refusal` with those that run if it does not."""
    from spinbook.ros2.names import absolute_node, seen

    full = absolute_node(node_name)

    def visible() -> list[str]:
        return [node.full_name for node in graph.nodes() if include_hidden or not node.hidden]

    graph.settle(lambda: full in visible())
    if full not in visible():
        raise Refusal("Node not found", seen("Nodes", visible()))
    return full


def client_of(graph: Graph, name: str) -> Any:
    """A client of a node's parameter services that the node knows. Raises `Refusal` if it has none."""
    from rclpy.parameter_client import AsyncParameterClient

    client = AsyncParameterClient(graph.node, name)
    if not graph.spin_until(client.services_are_ready, READY):
        raise Refusal(
            f"Wait for service timed out waiting for parameter services for node {name}",
            "The node has none (start_parameter_services=False), or is ending.",
        )
    graph.wait_until_known(name)
    return client


def answer(graph: Graph, name: str, future: Any) -> Any:
    """What a node replied. Raises `Refusal` if it is silent."""
    if not graph.spin_until(future.done, ANSWER):
        raise Refusal(
            f"The node {name} did not answer within {ANSWER:.0f} s.",
            "A node answers while it spins: it may be stuck in a callback, or never call rclpy.spin.",
        )
    if future.exception() is not None or future.result() is None:
        raise Refusal(f"Exception while calling service of node '{name}': {future.exception()}")
    return future.result()


def parameter_value(text: str) -> Any:
    """What was typed as a rcl_interfaces/msg/ParameterValue, of the type that YAML gives it."""
    from rclpy.parameter import get_parameter_value

    try:
        return get_parameter_value(text)
    except yaml.YAMLError:
        from rcl_interfaces.msg import ParameterType, ParameterValue

        # Not YAML, so a text, as the real command takes it.
        return ParameterValue(type=ParameterType.PARAMETER_STRING, string_value=text)


def parameters_of_file(file: Path, node: str, *, use_wildcard: bool) -> list[Any]:
    """What a parameter file says for a node (full name), as rcl_interfaces/msg/Parameter. Raises `Refusal`."""
    from rclpy.parameter import parameter_dict_from_yaml_file

    try:
        found = parameter_dict_from_yaml_file(str(file), use_wildcard, target_nodes=[node])
    except OSError as error:
        raise Refusal(f"{file}: {error.strerror}") from None
    except yaml.YAMLError as error:
        raise Refusal(f"{file} is not valid YAML: {error}") from None
    except (RuntimeError, TypeError, AttributeError, ValueError) as error:
        raise Refusal(
            f"{file} has no parameters for {node}: {error}",
            f"It needs the node's name, then ros__parameters, then the parameters: {node}: {{ros__parameters: {{…}}}}",
        ) from None
    return list(found.values())


def value_of(value: Any) -> Any:
    """The value of a rcl_interfaces/msg/ParameterValue as the message has it; None if it is not set."""
    return getattr(value, _VALUE_FIELDS[value.type]) if 0 < value.type < len(_VALUE_FIELDS) else None
