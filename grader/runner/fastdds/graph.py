"""What of the ROS graph is the student's: everything that does not belong to the rig's own participant."""

from __future__ import annotations

import secrets
from collections import Counter
from typing import Any, Literal

from std_msgs.msg import Empty

from grader.recording import EndPoint

#: The first 12 bytes of an end point's identity name its DDS participant.
PARTICIPANT = 12

#: Topics that every node has by itself.
OWN_TO_ROS = ("/rosout", "/parameter_events")


class Graph:
    """Sees the graph through `node`, and tells the student's part of it from the rig's."""

    def __init__(self, node: Any, own_nodes: list[str]) -> None:
        self._node = node
        self._own_nodes = Counter(own_nodes)
        # On a topic that nobody can know beforehand, the only publisher is the rig's own.
        topic = f"/rig_{secrets.token_hex(16)}"
        publisher = node.create_publisher(Empty, topic, 1)
        mine = node.get_publishers_info_by_topic(topic)
        node.destroy_publisher(publisher)
        assert len(mine) == 1, "the rig does not find its own publisher"
        self._participant = bytes(mine[0].endpoint_gid[:PARTICIPANT])

    def nodes(self) -> list[str]:
        """Full names of the student's nodes, such as `/joint_velocity`, sorted."""
        names = Counter(
            f"{namespace.rstrip('/')}/{name}" for name, namespace in self._node.get_node_names_and_namespaces()
        )
        return sorted((names - self._own_nodes).elements())

    def services(self, node: str) -> set[str]:
        """Full names of the services of one of the student's nodes."""
        namespace, _, name = node.rpartition("/")
        try:
            return {service for service, _ in self._node.get_service_names_and_types_by_node(name, namespace or "/")}
        except Exception:  # rclpy raises NodeNameNonExistentError when the node has just gone
            return set()

    def end_points(self) -> tuple[EndPoint, ...]:
        """The student's publishers and subscriptions, sorted; those that every node has are left out."""
        found: list[EndPoint] = []
        for topic, _ in self._node.get_topic_names_and_types():
            if topic not in OWN_TO_ROS:
                found += self._of(topic, "publisher", self._node.get_publishers_info_by_topic(topic))
                found += self._of(topic, "subscription", self._node.get_subscriptions_info_by_topic(topic))
        return tuple(sorted(found, key=lambda end_point: (end_point.topic, end_point.kind, end_point.node)))

    def _of(self, topic: str, kind: Literal["publisher", "subscription"], infos: list[Any]) -> list[EndPoint]:
        return [
            EndPoint(
                node=f"{info.node_namespace.rstrip('/')}/{info.node_name}",
                kind=kind,
                topic=topic,
                type=info.topic_type,
                reliability=info.qos_profile.reliability.name.lower(),
                durability=info.qos_profile.durability.name.lower(),
            )
            for info in infos
            if bytes(info.endpoint_gid[:PARTICIPANT]) != self._participant
        ]
