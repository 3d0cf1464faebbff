"""What of the ROS graph is the student's, as a recording has it."""

from __future__ import annotations

from grader.recording import EndPoint
from rmw_lockstep.hub import PUBLISHER, SUBSCRIPTION, Hub
from rmw_lockstep.hub.graph import Graph

#: Topics that every node has by itself.
OWN_TO_ROS = ("/rosout", "/parameter_events")


def nodes(graph: Graph) -> tuple[str, ...]:
    """Full names of the student's nodes, such as `/joint_velocity`, sorted."""
    return tuple(node.full_name for node in graph.program_nodes())


def end_points(graph: Graph) -> tuple[EndPoint, ...]:
    """The student's publishers and subscriptions, sorted; those that every node has are left out."""
    found = (
        EndPoint(
            node=graph.nodes[end_point.node].full_name,
            kind="publisher" if end_point.kind == PUBLISHER else "subscription",
            topic=end_point.name,
            type=end_point.type,
            reliability=end_point.qos.reliability_name,
            durability=end_point.qos.durability_name,
        )
        for end_point in graph.program_end_points((PUBLISHER, SUBSCRIPTION))
        if end_point.name not in OWN_TO_ROS
    )
    return tuple(sorted(found, key=lambda one: (one.topic, one.kind, one.node)))


def deaf_to_the_clock(hub: Hub) -> list[str]:
    """Nodes that do not take their time from /clock. A node of rclpy subscribes to it when `use_sim_time` is true."""
    listening = {one.node for one in hub.graph.of_program("/clock", SUBSCRIPTION)}
    return [node.full_name for node in hub.graph.program_nodes() if node.id not in listening]


def has(graph: Graph, service: str, kind: int) -> bool:
    """Whether the student's program has an end point of this kind for a service."""
    return any(graph.of_program(service, kind))
