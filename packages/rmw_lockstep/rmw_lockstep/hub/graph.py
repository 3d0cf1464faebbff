"""The ROS graph: every node and endpoint of the hub and of all processes, and which of them match."""

from __future__ import annotations

from rmw_lockstep.hub.frames import PUBLISHER, SERVER, SUBSCRIPTION, EndpointFrame, NodeFrame
from rmw_lockstep.qos import compatible

#: The number of the hub among the processes.
HUB = 0


class HubGraph:
    """Nodes and endpoints by their identities."""

    def __init__(self) -> None:
        self.nodes: dict[int, NodeFrame] = {}
        self.endpoints: dict[int, EndpointFrame] = {}
        self._by_name: dict[str, dict[int, EndpointFrame]] = {}
        self._readers: dict[int, tuple[EndpointFrame, ...]] = {}

    def add_node(self, node: NodeFrame) -> None:
        """Add a node."""
        self.nodes[node.id] = node

    def remove_node(self, number: int) -> NodeFrame:
        """Remove a node. The caller must remove its endpoints."""
        return self.nodes.pop(number)

    def add(self, endpoint: EndpointFrame) -> None:
        """Add an endpoint."""
        self.endpoints[endpoint.id] = endpoint
        self._by_name.setdefault(endpoint.name, {})[endpoint.id] = endpoint
        self._readers.clear()

    def remove(self, number: int) -> EndpointFrame:
        """Remove an endpoint."""
        endpoint = self.endpoints.pop(number)
        same_name = self._by_name[endpoint.name]
        del same_name[number]
        if not same_name:
            del self._by_name[endpoint.name]
        self._readers.clear()
        return endpoint

    def readers(self, publisher: EndpointFrame) -> tuple[EndpointFrame, ...]:
        """Return the subscriptions that get what `publisher` sends. Cached, as each message needs it."""
        found = self._readers.get(publisher.id)
        if found is None:
            found = tuple(e for e in self._named(publisher, SUBSCRIPTION) if compatible(publisher.qos, e.qos))
            self._readers[publisher.id] = found
        return found

    def writers(self, subscription: EndpointFrame) -> tuple[EndpointFrame, ...]:
        """Return the publishers that `subscription` gets messages from."""
        return tuple(e for e in self._named(subscription, PUBLISHER) if compatible(e.qos, subscription.qos))

    def servers(self, client: EndpointFrame) -> tuple[EndpointFrame, ...]:
        """Return the servers that get the requests of `client`."""
        return tuple(self._named(client, SERVER))

    def endpoints_of(self, node: int) -> tuple[EndpointFrame, ...]:
        """Return the endpoints of a node."""
        return tuple(e for e in self.endpoints.values() if e.node == node)

    def program_nodes(self) -> tuple[NodeFrame, ...]:
        """Return the nodes that are not the hub's own, by name."""
        return tuple(sorted((n for n in self.nodes.values() if n.id >> 32 != HUB), key=lambda n: n.full_name))

    def program_endpoints(self) -> list[EndpointFrame]:
        """Return the endpoints that are not the hub's own."""
        return [e for e in self.endpoints.values() if e.process != HUB]

    def of_program(self, name: str, kind: int) -> list[EndpointFrame]:
        """Return the program's own endpoints of this kind and name."""
        return [e for e in self._by_name.get(name, {}).values() if e.kind == kind and e.process != HUB]

    def _named(self, other: EndpointFrame, kind: int) -> list[EndpointFrame]:
        """Return the endpoints of this kind with the same name and type."""
        return [e for e in self._by_name.get(other.name, {}).values() if e.kind == kind and e.type == other.type]
