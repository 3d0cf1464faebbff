"""Nodes: their names, their parameters from arguments, and what they see of the graph."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partialmethod
from typing import Any

from rcl_python import logs, names, participant, qos
from rcl_python.arguments import Arguments, Remap, parse, remapped, remapped_node
from rcl_python.context import Context
from rcl_python.endpoints import Publisher
from rcl_python.graph import CLIENT, PUBLISHER, SERVICE, SUBSCRIPTION, EndpointInfo, NodeInfo, names_and_types
from rcl_python.handle import Destroyable
from rcl_python.parameters import applies
from rcl_python.values import NodeNameNonExistentError, RCLError, at
from rmw_lockstep.type_hash import type_hash

_FEEDBACK = "/_action/feedback"
_FEEDBACK_TYPE = "_FeedbackMessage"


class Node(Destroyable):
    """A node. Raises ValueError for an invalid name or namespace."""

    def __init__(
        self,
        name: str,
        namespace: str,
        context: Context,
        cli_args: Sequence[str] | None,
        use_global_arguments: bool,
        enable_rosout: bool,
    ) -> None:
        self._destroyed = True
        own = parse(cli_args or [])
        own.refuse_unknown()
        context.require_valid("error creating node", "rcl/node.c:137")
        # A node's own arguments come first; parameters that come later win.
        self.sources: list[Arguments] = [own, *([context.arguments] if use_global_arguments else [])]
        self.remaps: list[Remap] = [rule for source in self.sources for rule in source.remaps]
        self._name_it(name, namespace)
        self.context = context
        enclave = context.arguments.enclave
        self.info: NodeInfo = participant.current().add_node(self.name, self.namespace, context.domain, enclave)
        self._rosout: Publisher | None = None
        if enable_rosout and context.arguments.rosout:
            self._open_rosout()
        super().__init__()

    def _name_it(self, name: str, namespace: str) -> None:
        _refuse("node name", names.node_name_fault(name), 156)
        namespace = namespace if namespace.startswith("/") else f"/{namespace}"
        fault = names.namespace_fault(namespace)
        if fault:
            raise ValueError(
                f"invalid node namespace: {at(f'{fault[0]}, result: {_namespace_result(fault[0])}', 'rcl/node.c:184')}"
            )
        self.name = remapped_node(self.remaps, "__node", name) or name
        self.namespace = remapped_node(self.remaps, "__ns", name) or namespace

    def _open_rosout(self) -> None:
        from rcl_interfaces.msg import Log

        self._rosout = Publisher(self, Log, "/rosout", qos.ROSOUT)
        logs.add_rosout(self.logger_name(), self._rosout.publish)

    def _destroy(self) -> None:
        if self._rosout is not None:
            logs.remove_rosout(self.logger_name(), self._rosout.publish)
            self._rosout.destroy_when_not_in_use()
        participant.current().remove_node(self.info.key)

    def get_node_name(self) -> str:
        """Return the name without its namespace."""
        return self.name

    def get_namespace(self) -> str:
        """Return the namespace, `/` for none."""
        return self.namespace

    def get_fully_qualified_name(self) -> str:
        """Return the namespace and the name."""
        return f"{self.namespace.rstrip('/')}/{self.name}"

    def logger_name(self) -> str:
        """Return the name of the node's logger: its full name with dots."""
        return self.get_fully_qualified_name().strip("/").replace("/", ".")

    def resolve(self, name: str, kind: str, only_expand: bool = False) -> str:
        """Return the absolute name of a topic or a service (`kind`), remapped."""
        absolute = names.expand(name, self.name, self.namespace)
        return absolute if only_expand else remapped(self.remaps, kind, absolute, self.name, self.namespace)

    def get_parameters(self, parameter_class: Any) -> dict[str, Any]:
        """Return the parameters that the arguments give this node: name -> Parameter."""
        found: dict[str, Any] = {}
        for source in reversed(self.sources):
            for pattern, name, value in source.parameters:
                if applies(pattern, self.get_fully_qualified_name()):
                    found[name] = parameter_class(name, parameter_class.Type.from_parameter_value(value), value)
        return found

    def get_node_names_and_namespaces(self) -> list[tuple[str, str]]:
        """Return every node of the domain."""
        return [(node.name, node.namespace) for node in self.seen().nodes_in(self.info.domain)]

    def get_node_names_and_namespaces_with_enclaves(self) -> list[tuple[str, str, str]]:
        """Return every node of the domain, and its enclave."""
        return [(node.name, node.namespace, node.enclave) for node in self.seen().nodes_in(self.info.domain)]

    def seen(self) -> Any:
        """Return the graph as it is now."""
        here = participant.current()
        here.pump()
        return here.graph

    def _count(self, kind: str, plural: str, argument: str, topic: str) -> int:
        """Return how many endpoints of this kind a topic or a service has. Raises RCLError for an invalid name."""
        fault = names.full_topic_fault(topic)
        if fault:
            reason = at(f"{argument} argument is invalid: {fault[0]}", "rmw_count.cpp:60")
            raise RCLError(f"Error in rcl_count_{plural}: {reason}")
        return len(self.seen().ends(self.info.domain, kind, topic=topic))

    get_count_publishers = partialmethod(_count, PUBLISHER, "publishers", "topic_name")
    get_count_subscribers = partialmethod(_count, SUBSCRIPTION, "subscribers", "topic_name")
    get_count_services = partialmethod(_count, SERVICE, "services", "service_name")
    get_count_clients = partialmethod(_count, CLIENT, "clients", "service_name")

    def get_action_names_and_types(self) -> list[tuple[str, list[str]]]:
        """Return every action that a server or a client has."""
        return _actions(self.seen().ends(self.info.domain, PUBLISHER, SUBSCRIPTION))

    def get_action_server_names_and_types_by_node(self, name: str, namespace: str) -> list[tuple[str, list[str]]]:
        """Return the actions that a node serves."""
        return _actions(ends_of(self, name, namespace, PUBLISHER, "action server"))

    def get_action_client_names_and_types_by_node(self, name: str, namespace: str) -> list[tuple[str, list[str]]]:
        """Return the actions that a node calls."""
        return _actions(ends_of(self, name, namespace, SUBSCRIPTION, "action client"))


def _refuse(what: str, fault: names.Fault, line: int) -> None:
    if fault:
        raise ValueError(f"invalid {what}: {at(fault[0], f'rcl/node.c:{line}')}")


def _namespace_result(text: str) -> int:
    """Return rmw's number for a fault of a namespace (rmw/validate_namespace.h)."""
    endings = [
        "must not be empty",
        "lead with a '/'",
        "unless only a '/'",
        "alphanumerics, '_', or '/'",
        "repeated '/'",
    ]
    return next((number for number, ending in enumerate(endings, 1) if ending in text), 6)


def _actions(ends: Sequence[EndpointInfo]) -> list[tuple[str, list[str]]]:
    found = [
        (topic.removesuffix(_FEEDBACK), [kind.removesuffix(_FEEDBACK_TYPE) for kind in kinds])
        for topic, kinds in names_and_types(ends)
        if topic.endswith(_FEEDBACK)
    ]
    return sorted(found)


def ends_of(node: Node, name: str, namespace: str, kind: str, role: str) -> list[EndpointInfo]:
    """Return a node's endpoints of one kind. Raises NodeNameNonExistentError if no node has that name."""
    graph = node.seen()
    owners = graph.named(node.info.domain, name, namespace)
    if not owners:
        raise NodeNameNonExistentError(f"cannot get {role} names and types for nonexistent node: error not set")
    return [end for owner in owners for end in graph.ends(node.info.domain, kind, node=owner.key)]


def topic_names_and_types(node: Node, no_demangle: bool) -> list[tuple[str, list[str]]]:
    """Return every topic and its types."""
    return names_and_types(node.seen().ends(node.info.domain, PUBLISHER, SUBSCRIPTION), mangled=no_demangle)


def service_names_and_types(node: Node) -> list[tuple[str, list[str]]]:
    """Return every service and its types."""
    return names_and_types(node.seen().ends(node.info.domain, SERVICE, CLIENT))


def topics_of(
    kind: str, role: str, node: Node, no_demangle: bool, name: str, namespace: str
) -> list[tuple[str, list[str]]]:
    """Return the topics of which a node has endpoints of this kind, and their types."""
    return names_and_types(ends_of(node, name, namespace, kind, role), mangled=no_demangle)


def services_of(kind: str, role: str, node: Node, name: str, namespace: str) -> list[tuple[str, list[str]]]:
    """Return the services of which a node has endpoints of this kind, and their types."""
    return names_and_types(ends_of(node, name, namespace, kind, role))


#: How rclpy numbers what has an endpoint (rmw/types.h).
_ENDPOINT_TYPES = {PUBLISHER: 1, SUBSCRIPTION: 2}


def infos_by_topic(kind: str, node: Node, topic: str, no_mangle: bool) -> list[dict[str, object]]:
    """Return the publishers on a topic, or the subscribers to it, with their profiles."""
    graph = node.seen()
    return [_info(graph, end) for end in graph.ends(node.info.domain, kind, topic=topic)]


def _info(graph: Any, end: EndpointInfo) -> dict[str, object]:
    owner = graph.nodes.get(end.node)
    version, *digest = type_hash(end.type)
    return {
        "node_name": owner.name if owner else "_NODE_NAME_UNKNOWN_",
        "node_namespace": owner.namespace if owner else "_NODE_NAMESPACE_UNKNOWN_",
        "topic_type": end.type,
        "topic_type_hash": {"version": version, "value": bytes(digest)},
        "endpoint_type": _ENDPOINT_TYPES[end.kind],
        "endpoint_gid": _gid(end.gid),
        "qos_profile": qos.reported(end.qos).to_dict(),
    }


def _gid(text: str) -> list[int]:
    """Return sixteen numbers that no other endpoint has."""
    process, _, number = text.rpartition(".")
    return list(process.encode()[-12:].rjust(12, b"\0") + int(number).to_bytes(4, "big"))


def resolve_name(node: Node, name: str, only_expand: bool, is_service: bool) -> str:
    """Return a topic's or service's absolute name, remapped unless `only_expand`. Raises RCLError if it is invalid."""
    if not isinstance(name, str):
        raise TypeError("rclpy_resolve_name(): incompatible function arguments.")
    try:
        return node.resolve(name, "service" if is_service else "topic", only_expand)
    except ValueError as error:
        raise RCLError(f"failed to resolve name: {error}") from None


def remap_topic_name(node: Node, name: str) -> str:
    """Return a topic's absolute name after remapping."""
    return remapped(node.remaps, "topic", name, node.name, node.namespace)
