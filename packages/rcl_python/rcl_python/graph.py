"""The graph of nodes as one process sees it: the nodes, and who publishes, subscribes, serves and calls what."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import Any

from rcl_python.qos import Profile

PUBLISHER, SUBSCRIPTION, SERVICE, CLIENT = "publisher", "subscription", "service", "client"
OPPOSITE = {PUBLISHER: SUBSCRIPTION, SUBSCRIPTION: PUBLISHER, SERVICE: CLIENT, CLIENT: SERVICE}


@dataclass(frozen=True)
class NodeInfo:
    """A node: the key by which endpoints refer to it, and its names."""

    key: str
    name: str
    namespace: str
    domain: int = 0
    enclave: str = "/"


@dataclass(frozen=True)
class EndpointInfo:
    """One end of a topic or a service. `gid` is unique among all processes and begins with the process's identity."""

    gid: str
    kind: str
    node: str
    topic: str
    type: str
    qos: Profile
    domain: int = 0

    @property
    def process(self) -> str:
        """The identity of the process that has it."""
        return process_of(self.gid)


def process_of(key: str) -> str:
    """Return the identity of the process that made a gid or a node's key."""
    return key.rpartition(".")[0]


def to_plain(info: NodeInfo | EndpointInfo) -> dict[str, Any]:
    """Return the info ready for JSON."""
    return dataclasses.asdict(info)


def node_from(plain: dict[str, Any]) -> NodeInfo:
    """Return the node that `to_plain` was called on."""
    return NodeInfo(**_fields(NodeInfo, plain))


def endpoint_from(plain: dict[str, Any]) -> EndpointInfo:
    """Return the endpoint that `to_plain` was called on."""
    fields = _fields(EndpointInfo, plain)
    return EndpointInfo(**{**fields, "qos": Profile(**fields["qos"])})


def _fields(kind: Any, plain: dict[str, Any]) -> dict[str, Any]:
    return {item.name: plain[item.name] for item in dataclasses.fields(kind)}


@dataclass
class Graph:
    """Every known node and endpoint, of this process and of others."""

    nodes: dict[str, NodeInfo] = field(default_factory=dict)
    endpoints: dict[str, EndpointInfo] = field(default_factory=dict)

    def ends(self, domain: int, *kinds: str, topic: str | None = None, node: str | None = None) -> list[EndpointInfo]:
        """Return the endpoints of these kinds in a domain, for one topic or one node if given."""
        return [
            end
            for end in self.endpoints.values()
            if end.kind in kinds
            and end.domain == domain
            and (topic is None or end.topic == topic)
            and (node is None or end.node == node)
        ]

    def nodes_in(self, domain: int) -> list[NodeInfo]:
        """Return the nodes in a domain."""
        return [node for node in self.nodes.values() if node.domain == domain]

    def named(self, domain: int, name: str, namespace: str) -> list[NodeInfo]:
        """Return the nodes with this name."""
        return [node for node in self.nodes_in(domain) if (node.name, node.namespace) == (name, namespace)]

    def forget_process(self, process: str) -> list[EndpointInfo]:
        """Drop everything of a process; return its endpoints."""
        for key in [key for key in self.nodes if process_of(key) == process]:
            del self.nodes[key]
        gone = [end for end in self.endpoints.values() if end.process == process]
        for end in gone:
            del self.endpoints[end.gid]
        return gone


def names_and_types(ends: Iterable[EndpointInfo], *, mangled: bool = False) -> list[tuple[str, list[str]]]:
    """Return topics, or services, and their types, both sorted. `mangled` gives them as in DDS."""
    found: dict[str, set[str]] = {}
    for end in ends:
        name, kind = (f"rt{end.topic}", dds_type(end.type)) if mangled else (end.topic, end.type)
        found.setdefault(name, set()).add(kind)
    return [(name, sorted(found[name])) for name in sorted(found)]


def dds_type(kind: str) -> str:
    """Return the name of a type in DDS: std_msgs/msg/String is std_msgs::msg::dds_::String_."""
    package, middle, name = kind.split("/")
    return f"{package}::{middle}::dds_::{name}_"
