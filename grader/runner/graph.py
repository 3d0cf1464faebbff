"""The student's part of the ROS graph, as a recording has it."""

from __future__ import annotations

from collections.abc import Callable

from grader.recording.recording import Endpoint, EndPointKind
from grader.recording.types import OWN_SERVICES
from rmw_lockstep.hub import CLIENT, PUBLISHER, SERVER, SUBSCRIPTION, EndpointFrame, Hub
from rmw_lockstep.hub.graph import HubGraph
from rmw_lockstep.qos import INFINITE, KEEP_ALL

#: Topics that every node has.
OWN_TO_ROS = ("/rosout", "/parameter_events")

#: The name of the service through which an action takes goals, below the action's name.
SEND_GOAL = "/_action/send_goal"

_KINDS: dict[int, EndPointKind] = {
    PUBLISHER: "publisher",
    SUBSCRIPTION: "subscription",
    SERVER: "server",
    CLIENT: "client",
}


def _nobody(process: int) -> bool:
    return False


def nodes(graph: HubGraph, ours: Callable[[int], bool] = _nobody) -> tuple[str, ...]:
    """Return the full names of the student's nodes, such as `/joint_velocity`, sorted; without processes in `ours`."""
    return tuple(node.full_name for node in graph.program_nodes() if not ours(node.id >> 32))


def end_points(graph: HubGraph, ours: Callable[[int], bool] = _nobody) -> tuple[Endpoint, ...]:
    """Return the student's end points, sorted, without those that every node has; those of an action count as one."""
    found = [
        recorded
        for endpoint in graph.program_endpoints()
        if not ours(endpoint.process) and (recorded := _recorded(endpoint, graph.nodes[endpoint.node].full_name))
    ]
    return tuple(sorted(found, key=lambda one: (one.topic, one.kind, one.node)))


def _recorded(endpoint: EndpointFrame, node: str) -> Endpoint | None:
    kind, name, type_name = _KINDS[endpoint.kind], endpoint.name, endpoint.type
    if name.endswith(SEND_GOAL) and endpoint.kind in (SERVER, CLIENT):
        kind = "action server" if endpoint.kind == SERVER else "action client"
        name, type_name = name.removesuffix(SEND_GOAL), type_name.removesuffix("_SendGoal")
    elif (
        name in OWN_TO_ROS
        or "/_action/" in name
        or type_name.startswith("lifecycle_msgs/srv/")
        or (endpoint.kind == SERVER and name.removeprefix(f"{node}/") in OWN_SERVICES)
    ):
        return None
    qos = endpoint.qos
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
    """Return the nodes that do not take their time from /clock. rclpy subscribes to it when `use_sim_time` is true."""
    listening = {one.node for one in hub.graph.of_program("/clock", SUBSCRIPTION)}
    return [node.full_name for node in hub.graph.program_nodes() if node.id not in listening]
