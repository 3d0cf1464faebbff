"""The ROS graph: every node and end point of the hub and of all processes, and which of them match."""

from __future__ import annotations

from collections.abc import Iterable

from rmw_lockstep.hub.frames import CLIENT, PUBLISHER, SERVER, SUBSCRIPTION, EndPoint, Node
from rmw_lockstep.qos import compatible

#: The number of the hub among the processes.
HUB = 0


class Graph:
    """Nodes and end points by their identities."""

    def __init__(self) -> None:
        self.nodes: dict[int, Node] = {}
        self.end_points: dict[int, EndPoint] = {}
        self._by_name: dict[str, list[EndPoint]] = {}
        self._readers: dict[int, tuple[EndPoint, ...]] = {}

    def add_node(self, node: Node) -> None:
        """Add a node."""
        self.nodes[node.id] = node

    def remove_node(self, number: int) -> Node:
        """Remove a node; the caller has to remove the end points that it still had."""
        return self.nodes.pop(number)

    def add(self, end_point: EndPoint) -> None:
        """Add an end point."""
        self.end_points[end_point.id] = end_point
        self._by_name.setdefault(end_point.name, []).append(end_point)
        self._readers.clear()

    def remove(self, number: int) -> EndPoint:
        """Remove an end point."""
        end_point = self.end_points.pop(number)
        same_name = self._by_name[end_point.name]
        same_name.remove(end_point)
        if not same_name:
            del self._by_name[end_point.name]
        self._readers.clear()
        return end_point

    def readers(self, publisher: EndPoint) -> tuple[EndPoint, ...]:
        """Return the subscriptions that get what `publisher` sends. Cached until a change: each message needs it."""
        found = self._readers.get(publisher.id)
        if found is None:
            found = tuple(e for e in self._named(publisher, SUBSCRIPTION) if compatible(publisher.qos, e.qos))
            self._readers[publisher.id] = found
        return found

    def writers(self, subscription: EndPoint) -> tuple[EndPoint, ...]:
        """Return the publishers that `subscription` gets messages from."""
        return tuple(e for e in self._named(subscription, PUBLISHER) if compatible(e.qos, subscription.qos))

    def servers(self, client: EndPoint) -> tuple[EndPoint, ...]:
        """Return the servers that get the requests of `client`."""
        return tuple(self._named(client, SERVER))

    def end_points_of(self, node: int) -> tuple[EndPoint, ...]:
        """Return the end points of a node."""
        return tuple(e for e in self.end_points.values() if e.node == node)

    def program_nodes(self) -> tuple[Node, ...]:
        """Return the nodes that are not the hub's own, by name."""
        return tuple(sorted((n for n in self.nodes.values() if n.id >> 32 != HUB), key=lambda n: n.full_name))

    def program_end_points(self, kinds: Iterable[int] = (PUBLISHER, SUBSCRIPTION, SERVER, CLIENT)) -> list[EndPoint]:
        """Return the end points that are not the hub's own."""
        return [e for e in self.end_points.values() if e.process != HUB and e.kind in kinds]

    def of_program(self, name: str, kind: int) -> list[EndPoint]:
        """Return the program's own end points of this kind and name."""
        return [e for e in self._by_name.get(name, ()) if e.kind == kind and e.process != HUB]

    def _named(self, other: EndPoint, kind: int) -> list[EndPoint]:
        """Return the end points of this kind with the same name and type."""
        return [e for e in self._by_name.get(other.name, ()) if e.kind == kind and e.type == other.type]
