"""A node graph and its JSON form: sorted and without times, so that the same graph always gives the same JSON."""

from __future__ import annotations

import json
from collections.abc import Iterable
from dataclasses import asdict, dataclass

from groundwork.plain_data import restored


@dataclass(frozen=True, order=True)
class GraphEndpoint:
    """A node's publisher or subscription on a topic.

    `type` is "package/msg/Name". `connected` is False if no endpoint on the other side has the same type and a
    compatible QoS.
    """

    node: str
    type: str
    connected: bool


#: Topics that every node has, which say nothing about its purpose.
INTERNAL = ("/rosout", "/parameter_events")


def one_each(ends: Iterable[GraphEndpoint]) -> tuple[GraphEndpoint, ...]:
    """Return one endpoint per node and type, sorted. It is connected if any of these is."""
    connected: dict[tuple[str, str], bool] = {}
    for end in ends:
        connected[end.node, end.type] = connected.get((end.node, end.type), False) or end.connected
    return tuple(sorted(GraphEndpoint(node, kind, fits) for (node, kind), fits in connected.items()))


@dataclass(frozen=True, order=True)
class GraphTopic:
    """A topic with its endpoints, one per node and type on each side. `rate_hz` is rounded; None if not measured."""

    name: str
    publishers: tuple[GraphEndpoint, ...]
    subscriptions: tuple[GraphEndpoint, ...]
    rate_hz: float | None = None

    @property
    def types(self) -> list[str]:
        """The types of its endpoints, the publishers' first."""
        return list(dict.fromkeys(end.type for end in (*self.publishers, *self.subscriptions)))


@dataclass(frozen=True, order=True)
class GraphNode:
    """A node by its full name, and the ids of the first and the last cell after which it was running, if known."""

    name: str
    first_cell: str = ""
    last_cell: str = ""


@dataclass(frozen=True)
class NodeGraph:
    """Nodes in the order of their first cells, then by name, and topics by name.

    Hidden nodes and what every node has (/rosout …) are left out.
    """

    nodes: tuple[GraphNode, ...]
    topics: tuple[GraphTopic, ...]

    def to_json(self) -> str:
        """Return the graph as indented JSON; the same for the same graph."""
        return json.dumps(asdict(self), ensure_ascii=False, indent=1, sort_keys=True) + "\n"

    @classmethod
    def from_json(cls, text: str) -> NodeGraph:
        """Read what `to_json` wrote.

        Raises:
            ValueError: if the text is not such a graph.
        """
        try:
            return restored(cls, json.loads(text))
        except (KeyError, TypeError, AttributeError) as error:
            raise ValueError(f"not a node graph: {error!r}") from error
