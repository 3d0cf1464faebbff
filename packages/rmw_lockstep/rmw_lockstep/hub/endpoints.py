"""The hub's own nodes and their endpoints, by which a test or a grader takes part in the graph."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from typing import NamedTuple, Protocol

from rmw_lockstep.hub.frames import EndpointFrame, NodeFrame
from rmw_lockstep.qos import KEEP_ALL, TRANSIENT_LOCAL, QosPolicies


class DeliveredMessage(NamedTuple):
    """A message that arrived from a process.

    `now` is the time of the process (ns). `stage` is the number of the hub's last publication that the process had
    handled. `handled` counts the hub's frames that it had handled. `ordered` is true if the
    order of this node's messages on this topic is reproducible: the main thread of its process sent this one, and no
    other process publishes there under the same node name.
    """

    publisher: EndpointFrame
    node: str
    now: int
    stage: int
    handled: int
    ordered: bool
    cdr: bytes


class Moment(NamedTuple):
    """When a process sent something: see `DeliveredMessage`. `main` is true if its main thread sent it."""

    now: int
    stage: int
    handled: int
    main: bool


class PendingRequest(NamedTuple):
    """A request that arrived from a process; `node` is the full name of the client's node."""

    client: EndpointFrame
    node: str
    number: int
    moment: Moment
    cdr: bytes


class EndpointHost(Protocol):
    """What the endpoints need from the hub."""

    def publish(self, publisher: HubPublisher, cdr: bytes) -> int: ...
    def request(self, client: HubClient, number: int, cdr: bytes) -> bool: ...
    def respond(self, client: int, number: int, cdr: bytes) -> None: ...
    def matched(self, endpoint: EndpointFrame) -> tuple[EndpointFrame, ...]: ...
    def add_end(self, end: HubEndpoint) -> None: ...
    def remove_end(self, end: HubEndpoint) -> None: ...
    def new_endpoint(self, kind: int, node: NodeFrame, name: str, type: str, qos: QosPolicies) -> EndpointFrame: ...


class HubEndpoint:
    """One of the hub's endpoints."""

    def __init__(self, post: EndpointHost, endpoint: EndpointFrame) -> None:
        self.endpoint = endpoint
        self._post = post
        post.add_end(self)

    @property
    def matched(self) -> tuple[EndpointFrame, ...]:
        """The processes' endpoints that it exchanges messages with."""
        return self._post.matched(self.endpoint)

    def close(self) -> None:
        """Remove it from the graph."""
        self._post.remove_end(self)


class HubPublisher(HubEndpoint):
    """Publishes serialized messages. It keeps those that its QoS promises to later subscriptions."""

    def __init__(self, post: EndpointHost, endpoint: EndpointFrame) -> None:
        keeps = endpoint.qos.durability == TRANSIENT_LOCAL
        depth = None if endpoint.qos.history == KEEP_ALL else max(1, endpoint.qos.depth)
        self.history: deque[tuple[int, bytes]] = deque(maxlen=depth if keeps else 0)
        super().__init__(post, endpoint)

    def publish(self, cdr: bytes) -> int:
        """Queue a message; return its number among all that the hub has published: see `DeliveredMessage.stage`."""
        return self._post.publish(self, cdr)


class HubSubscription(HubEndpoint):
    """Keeps messages in the order in which they arrived, or passes them to `take`."""

    def __init__(
        self, post: EndpointHost, endpoint: EndpointFrame, take: Callable[[DeliveredMessage], None] | None = None
    ) -> None:
        self.heard: list[DeliveredMessage] = []
        self.take = take or self.heard.append
        super().__init__(post, endpoint)


class HubClient(HubEndpoint):
    """Calls a service. Responses are in `answers`, by the number that `call` returned, and their times in `moments`."""

    def __init__(self, post: EndpointHost, endpoint: EndpointFrame) -> None:
        self.answers: dict[int, bytes] = {}
        self.moments: dict[int, Moment] = {}
        self._number = 0
        super().__init__(post, endpoint)

    def call(self, cdr: bytes) -> int | None:
        """Queue a request and return its number; None when there is no such service."""
        self._number += 1
        return self._number if self._post.request(self, self._number, cdr) else None

    def answered(self, number: int, moment: Moment, cdr: bytes) -> None:
        """Take the response to a request."""
        self.moments[number] = moment
        self.answers[number] = cdr


class HubServer(HubEndpoint):
    """Answers requests by calling `answer` with the serialized request, which returns the serialized response.

    Without `answer` requests are kept in `asked`, in the order in which they arrived, for `respond`. Both happen only
    when the whole program is idle: what it does meanwhile does not depend on how fast the hub is.
    """

    def __init__(
        self, post: EndpointHost, endpoint: EndpointFrame, answer: Callable[[bytes], bytes] | None = None
    ) -> None:
        self.asked: list[PendingRequest] = []
        self._answer = answer
        super().__init__(post, endpoint)

    def serve(self, asked: PendingRequest) -> None:
        """Take one request."""
        if self._answer:
            self.respond(asked, self._answer(asked.cdr))
        else:
            self.asked.append(asked)

    def respond(self, asked: PendingRequest, cdr: bytes) -> None:
        """Queue the response to a request."""
        self._post.respond(asked.client.id, asked.number, cdr)


class HubNode:
    """One of the hub's nodes."""

    def __init__(self, post: EndpointHost, node: NodeFrame) -> None:
        self.node = node
        self._post = post

    def publisher(self, topic: str, type_name: str, qos: QosPolicies) -> HubPublisher:
        """Return a new publisher of messages such as `std_msgs/msg/String`."""
        return HubPublisher(self._post, self._post.new_endpoint(0, self.node, topic, type_name, qos))

    def subscription(
        self, topic: str, type_name: str, qos: QosPolicies, take: Callable[[DeliveredMessage], None] | None = None
    ) -> HubSubscription:
        """Return a new subscription."""
        return HubSubscription(self._post, self._post.new_endpoint(1, self.node, topic, type_name, qos), take)

    def server(self, service: str, type_name: str, answer: Callable[[bytes], bytes] | None = None) -> HubServer:
        """Return a new server of a service such as `std_srvs/srv/Trigger`."""
        return HubServer(self._post, self._post.new_endpoint(2, self.node, service, type_name, QosPolicies()), answer)

    def client(self, service: str, type_name: str) -> HubClient:
        """Return a new client of a service."""
        return HubClient(self._post, self._post.new_endpoint(3, self.node, service, type_name, QosPolicies()))
