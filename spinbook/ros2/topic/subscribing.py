"""What echo, hz, bw and delay share: finding the type of a topic that may not be there yet."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from spinbook.ros2 import interfaces
from spinbook.ros2.names import seen
from spinbook.ros2.refusal import Refusal

if TYPE_CHECKING:
    from spinbook.ros2.graph import Graph


def type_on_graph(graph: Graph, topic: str) -> Any | None:
    """The class of a topic's messages as the graph has it now, None if nobody has the topic.

    Raises `Refusal` where its ends disagree about the type, or where the type is not installed.
    """
    types = graph.topic_types(topic)
    if len(types) > 1:
        raise Refusal(
            f"Cannot echo topic '{topic}', as it contains more than one type: [{', '.join(types)}]",
            f"Ends of different types never connect. `ros2 topic info -v {topic}` shows who uses which.",
        )
    return interfaces.message_class(types[0]) if types else None


def wait_for_type(graph: Graph, topic: str) -> Any:
    """The class of a topic's messages; waits without end, after a warning, for a topic that nobody has."""
    graph.settle(lambda: bool(graph.topic_types(topic)))
    message = type_on_graph(graph, topic)
    if message is None:
        print(f"WARNING: topic [{topic}] does not appear to be published yet", flush=True)
    while message is None:
        graph.spin_until(lambda: bool(graph.topic_types(topic)))
        message = type_on_graph(graph, topic)
    return message


def type_or_refusal(graph: Graph, topic: str) -> Any:
    """The class of a topic's messages. Raises `Refusal` after the real command's two lines if nobody has it."""
    message = type_on_graph(graph, topic)
    if message is None:
        print(f"WARNING: topic [{topic}] does not appear to be published yet", flush=True)
        raise Refusal(
            "Could not determine the type for the passed topic",
            seen("Topics", (found.name for found in graph.topics())),
            f"To wait for it, name the type too: ros2 topic echo {topic} std_msgs/msg/String",
        )
    return message
