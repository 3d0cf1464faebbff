"""Real ROS 2 in place of the hub: the grader's endpoints become those of an rclpy node, to try a program out."""

from __future__ import annotations

import time
from collections.abc import Callable
from functools import partial
from itertools import count
from typing import Any

from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from rclpy.serialization import deserialize_message, serialize_message

from grader.recording.types import message_class
from rmw_lockstep.hub import (
    DeliveredMessage,
    HubClient,
    HubNode,
    HubPublisher,
    HubServer,
    HubSubscription,
    PendingRequest,
    QosPolicies,
)
from rmw_lockstep.hub.endpoints import HubEndpoint, Moment
from rmw_lockstep.hub.frames import EndpointFrame, NodeFrame
from rmw_lockstep.qos import BEST_EFFORT, TRANSIENT_LOCAL

#: The parts of an action, by the ending of the type's name (ROS 2 design, "Actions").
_OF_ACTIONS = {"SendGoal": "SendGoalService", "GetResult": "GetResultService", "FeedbackMessage": "FeedbackMessage"}


class RealRos:
    """Does for the grader's endpoints what the hub does in a grading, in real time (see `EndpointHost`)."""

    def __init__(self, node: Node) -> None:
        self._node = node
        self._real: dict[int, Any] = {}
        self._clients: dict[int, Any] = {}
        self._headers: dict[tuple[int, int], Any] = {}
        self._ids, self._requests, self._stage = count(1), count(1), 0

    @property
    def unserved(self) -> tuple[PendingRequest, ...]:
        """Nobody sees a request for which there is no server."""
        return ()

    def node(self) -> HubNode:
        """Return the node as the grader's side uses it."""
        return HubNode(self, NodeFrame(0, self._node.get_name(), self._node.get_namespace()))

    def new_endpoint(self, kind: int, node: NodeFrame, name: str, type: str, qos: QosPolicies) -> EndpointFrame:
        """Describe a new endpoint."""
        return EndpointFrame(next(self._ids), kind, node.id, name, type, b"", qos)

    def add_end(self, end: HubEndpoint) -> None:
        """Create the rclpy endpoint."""
        one, node = end.endpoint, self._node
        kind, group = _class(one.type), ReentrantCallbackGroup()
        if isinstance(end, HubPublisher):
            self._real[one.id] = node.create_publisher(kind, one.name, _profile(one.qos))
        elif isinstance(end, HubSubscription):
            take = partial(self._deliver, end)
            self._real[one.id] = node.create_subscription(
                kind, one.name, take, _profile(one.qos), raw=True, callback_group=group
            )
        elif isinstance(end, HubServer):
            self._real[one.id] = service = node.create_service(kind, one.name, _later, callback_group=group)
            # rclpy answers when the callback returns; coroutines, which may answer later, it polls without a pause.
            service.send_response = partial(self._serve, end)  # type: ignore[method-assign]
        elif isinstance(end, HubClient):
            client = node.create_client(kind, one.name, callback_group=group)
            self._real[one.id] = self._clients[one.id] = client

    def remove_end(self, end: HubEndpoint) -> None:
        """Remove the rclpy endpoint."""
        real = self._real.pop(end.endpoint.id, None)
        destroy: dict[type[HubEndpoint], Callable[[Any], object]] = {
            HubPublisher: self._node.destroy_publisher,
            HubSubscription: self._node.destroy_subscription,
            HubServer: self._node.destroy_service,
            HubClient: self._node.destroy_client,
        }
        if real is not None:
            destroy[type(end)](real)

    def missing_servers(self) -> list[str]:
        """Return the services and actions that the grader's side calls and that nobody serves."""
        missing = (client.srv_name for client in self._clients.values() if not client.service_is_ready())
        return sorted({name.partition("/_action/")[0] for name in missing})

    def _moment(self) -> Moment:
        return Moment(time.monotonic_ns(), self._stage, 0, True)

    def _deliver(self, end: HubSubscription, cdr: bytes) -> None:
        now, stage, handled, ordered = self._moment()
        end.take(DeliveredMessage(end.endpoint, "", now, stage, handled, ordered, cdr))

    def _serve(self, end: HubServer, request: Any, header: Any) -> None:
        number = next(self._requests)
        self._headers[end.endpoint.id, number] = header
        end.serve(PendingRequest(end.endpoint, "", number, self._moment(), serialize_message(request)))

    def publish(self, publisher: HubPublisher, cdr: bytes) -> int:
        """Publish a message; return its number."""
        self._real[publisher.endpoint.id].publish(cdr)
        self._stage += 1
        return self._stage

    def request(self, client: HubClient, number: int, cdr: bytes) -> bool:
        """Send a request. Return False if there is no server."""
        real = self._real[client.endpoint.id]
        if not real.service_is_ready():
            return False
        asked = real.call_async(deserialize_message(cdr, real.srv_type.Request))
        asked.add_done_callback(lambda done: client.answered(number, self._moment(), serialize_message(done.result())))
        return True

    def respond(self, client: int, number: int, cdr: bytes) -> None:
        """Answer a request."""
        service = self._real[client]
        response = deserialize_message(cdr, service.srv_type.Response)
        type(service).send_response(service, response, self._headers.pop((client, number)))

    def matched(self, endpoint: EndpointFrame) -> tuple[EndpointFrame, ...]:
        """Return one entry for each subscription of a publisher."""
        real = self._real.get(endpoint.id)
        return (endpoint,) * (real.get_subscription_count() if real is not None else 0)


def _later(request: Any, response: Any) -> Any:
    """Return the request in place of a response: the service's own `send_response` takes it, and answers later."""
    return request


def _class(type_name: str) -> Any:
    whole, _, part = type_name.rpartition("_")
    if "/action/" in type_name and part in _OF_ACTIONS:
        return getattr(message_class(whole).Impl, _OF_ACTIONS[part])
    return message_class(type_name)


def _profile(qos: QosPolicies) -> QoSProfile:
    return QoSProfile(
        depth=max(1, qos.depth),
        reliability=ReliabilityPolicy.BEST_EFFORT if qos.reliability == BEST_EFFORT else ReliabilityPolicy.RELIABLE,
        durability=DurabilityPolicy.TRANSIENT_LOCAL if qos.durability == TRANSIENT_LOCAL else DurabilityPolicy.VOLATILE,
    )
