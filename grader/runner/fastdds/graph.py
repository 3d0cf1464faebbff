"""The student's part of the ROS graph, and calls of the student's services without an executor."""

from __future__ import annotations

import secrets
from collections import Counter
from collections.abc import Sequence
from typing import Any, Literal

from rclpy.impl.implementation_singleton import rclpy_implementation
from rclpy.node import Node
from std_msgs.msg import Empty

from grader.recording.recording import EndPoint

#: The first 12 bytes of an end point's identity name its DDS participant.
PARTICIPANT = 12

#: Topics that every node has.
OWN_TO_ROS = ("/rosout", "/parameter_events")


class Graph:
    """Sees the graph through `node`, and separates the student's part of it from the runner's."""

    def __init__(self, node: Any, own_nodes: list[str]) -> None:
        self._node = node
        self._own_nodes = Counter(own_nodes)
        # On a topic with an unpredictable name, the only publisher is the runner's own.
        topic = f"/rig_{secrets.token_hex(16)}"
        publisher = node.create_publisher(Empty, topic, 1)
        mine = node.get_publishers_info_by_topic(topic)
        node.destroy_publisher(publisher)
        assert len(mine) == 1, "the runner does not find its own publisher"
        self._participant = bytes(mine[0].endpoint_gid[:PARTICIPANT])

    def nodes(self) -> list[str]:
        """Return the full names of the student's nodes, such as `/joint_velocity`, sorted."""
        names = Counter(
            f"{namespace.rstrip('/')}/{name}" for name, namespace in self._node.get_node_names_and_namespaces()
        )
        return sorted((names - self._own_nodes).elements())

    def services(self, node: str) -> set[str]:
        """Return the full names of the services of one of the student's nodes."""
        namespace, _, name = node.rpartition("/")
        try:
            return {service for service, _ in self._node.get_service_names_and_types_by_node(name, namespace or "/")}
        except Exception:  # rclpy raises NodeNameNonExistentError when the node has just gone
            return set()

    def end_points(self) -> tuple[EndPoint, ...]:
        """Return the student's publishers and subscriptions, sorted, without those that every node has."""
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


NANOSECONDS = 1_000_000_000


class Caller:
    """Calls one service, as often as `call` says, and keeps the last answer."""

    def __init__(self, node: Any, kind: Any, name: str) -> None:
        self._node: Node = node
        self._client = node.create_client(kind, name)
        self._kind = kind
        self._unanswered: set[int] = set()
        self.answer: Any = None

    @property
    def ready(self) -> bool:
        """Whether the service can be called."""
        return bool(self._client.service_is_ready())

    @property
    def handle(self) -> Any:
        """The handle to wait for."""
        return self._client.handle

    @property
    def answered(self) -> bool:
        """Whether all calls are answered."""
        return not self._unanswered

    def call(self, request: Any) -> None:
        """Send a request and return at once."""
        self._unanswered.add(self._client.handle.send_request(request))

    def call_again(self, request: Any) -> None:
        """Send a request that replaces all unanswered ones; their answers no longer count."""
        times, self._unanswered = len(self._unanswered), set()
        for _ in range(times):
            self.call(request)

    def take(self) -> None:
        """Take the answers that have arrived."""
        while self._unanswered:
            header, answer = self._client.handle.take_response(self._kind.Response)
            if header is None:
                return
            number = header.request_id.sequence_number
            if number in self._unanswered:
                self._unanswered.remove(number)
                self.answer = answer

    def close(self) -> None:
        """Destroy the client."""
        self._node.destroy_client(self._client)


class Calls:
    """Pending calls, each of `(caller, request)`, all of one context."""

    def __init__(self, context: Any, calls: Sequence[tuple[Caller, Any]]) -> None:
        self._calls = calls
        self._waiting = rclpy_implementation.WaitSet(0, 0, 0, len(calls), 0, 0, context.handle)

    def ready(self) -> bool:
        """Return whether every service can be called."""
        return all(caller.ready for caller, _ in self._calls)

    def call(self, times: int) -> None:
        """Call every service that often, and return at once."""
        for caller, request in self._calls:
            for _ in range(times):
                caller.call(request)

    def call_again(self) -> None:
        """Repeat what has not been answered.

        An answer is lost if the service has not yet discovered the caller: a service of rclpy that does not find the
        reader of its answer drops it (rmw_fastrtps, `__rmw_send_response`).
        """
        for caller, request in self._calls:
            caller.call_again(request)

    def answered(self) -> bool:
        """Return whether every call is answered."""
        return all(caller.answered for caller, _ in self._calls)

    def wait(self, at_most_s: float) -> None:
        """Wait until an answer arrives, and take what has arrived."""
        self._waiting.clear_entities()
        for caller, _ in self._calls:
            if not caller.answered:
                self._waiting.add_client(caller.handle)
        self._waiting.wait(int(at_most_s * NANOSECONDS))
        for caller, _ in self._calls:
            caller.take()
