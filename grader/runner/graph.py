"""The student's part of the ROS graph, as a recording has it."""

from __future__ import annotations

from collections.abc import Callable

from grader.recording.recording import Endpoint, EndPointKind
from grader.recording.types import OWN_SERVICES
from rmw_lockstep.hub import CLIENT, PUBLISHER, SERVER, SUBSCRIPTION, Hub
from rmw_lockstep.hub import EndPoint as OnHub
from rmw_lockstep.hub.graph import Graph
from rmw_lockstep.qos import INFINITE, KEEP_ALL

#: Topics that every node has.
OWN_TO_ROS = ("/rosout", "/parameter_events")

#: How the service is called by which an action takes goals.
SEND_GOAL = "/_action/send_goal"

_KINDS: dict[int, EndPointKind] = {
    PUBLISHER: "publisher",
    SUBSCRIPTION: "subscription",
    SERVER: "server",
    CLIENT: "client",
}


def _nobody(process: int) -> bool:
    return False


def nodes(graph: Graph, ours: Callable[[int], bool] = _nobody) -> tuple[str, ...]:
    """Return the full names of the student's nodes, such as `/joint_velocity`, sorted; without processes in `ours`."""
    return tuple(node.full_name for node in graph.program_nodes() if not ours(node.id >> 32))


def end_points(graph: Graph, ours: Callable[[int], bool] = _nobody) -> tuple[Endpoint, ...]:
    """Return the student's end points, sorted, without those that every node has; those of an action count as one."""
    found = [
        recorded
        for end_point in graph.program_end_points()
        if not ours(end_point.process) and (recorded := _recorded(end_point, graph.nodes[end_point.node].full_name))
    ]
    return tuple(sorted(found, key=lambda one: (one.topic, one.kind, one.node)))


def _recorded(end_point: OnHub, node: str) -> Endpoint | None:
    kind, name, type_name = _KINDS[end_point.kind], end_point.name, end_point.type
    if name.endswith(SEND_GOAL) and end_point.kind in (SERVER, CLIENT):
        kind = "action server" if end_point.kind == SERVER else "action client"
        name, type_name = name.removesuffix(SEND_GOAL), type_name.removesuffix("_SendGoal")
    elif (
        name in OWN_TO_ROS
        or "/_action/" in name
        or (end_point.kind == SERVER and name.removeprefix(f"{node}/") in OWN_SERVICES)
    ):
        return None
    qos = end_point.qos
    return Endpoint(
        node=node,
        kind=kind,
        topic=name,
        type=type_name,
        reliability=qos.reliability_name,
        durability=qos.durability_name,
        depth=0 if qos.history == KEEP_ALL else qos.depth,
        deadline=_limit(qos.deadline),
        lifespan=_limit(qos.lifespan),
    )


def _limit(nanoseconds: int) -> int | None:
    return nanoseconds if 0 < nanoseconds < INFINITE else None


def deaf_to_the_clock(hub: Hub) -> list[str]:
    """Return the nodes that don't take their time from /clock. rclpy subscribes to it when `use_sim_time` is true."""
    listening = {one.node for one in hub.graph.of_program("/clock", SUBSCRIPTION)}
    return [node.full_name for node in hub.graph.program_nodes() if node.id not in listening]
