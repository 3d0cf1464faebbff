"""Handles each frame: updates the graph and forwards messages to their recipients."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from itertools import count

from rmw_lockstep.hub import frames
from rmw_lockstep.hub.endpoints import (
    DeliveredMessage,
    HubClient,
    HubEndpoint,
    HubPublisher,
    HubServer,
    HubSubscription,
    Moment,
    PendingRequest,
)
from rmw_lockstep.hub.frames import CLIENT, PUBLISHER, SERVER, SUBSCRIPTION, EndpointFrame, NodeFrame
from rmw_lockstep.hub.graph import HUB, HubGraph
from rmw_lockstep.hub.limits import HubUsage, Violation
from rmw_lockstep.hub.link import FRAME_OVERHEAD, ProcessLink
from rmw_lockstep.hub.moment_counter import MomentCounter
from rmw_lockstep.qos import TRANSIENT_LOCAL, QosPolicies
from rmw_lockstep.type_hash import type_hash

#: The calendar time at a clock of 0 (ns).
EPOCH = 1_767_225_600 * 1_000_000_000


@dataclass(frozen=True)
class Route:
    """Where the messages of one publisher go: to the hub's subscriptions, and to processes.

    `shared` is true if another process publishes on the topic under the same node name. Which of the two is faster is
    random, and nothing else distinguishes them.
    """

    node: str
    shared: bool
    subscriptions: list[HubSubscription]
    links: list[ProcessLink]


class Router:
    """Forwards frames between the links to processes and the hub's own endpoints."""

    def __init__(self, use: HubUsage, calendar: Callable[[], int]) -> None:
        """`calendar` is the current calendar time, which stamps the hub's messages (ns)."""
        self.graph = HubGraph()
        self.links: list[ProcessLink] = []
        self.published = 0
        self._certain = 0
        self._use, self._calendar = use, calendar
        self._at_once = MomentCounter(self.graph, use.limits)
        self._numbers = count(1)
        self._ends: dict[int, HubEndpoint] = {}
        self._routes: dict[int, Route] = {}
        self._held: list[tuple[ProcessLink, ProcessLink, bytes]] = []
        self._asked: list[tuple[tuple[int, int], HubServer, PendingRequest]] = []
        self.unserved: list[PendingRequest] = []
        self._begins: dict[tuple[int, int], int] = {}
        self._handlers: dict[int, Callable[[ProcessLink, bytes], None]] = {
            ord("I"): self._idle,
            ord("F"): self._forked,
            ord("D"): self._data,
            ord("K"): self._kept,
            ord("r"): self._replayed,
            ord("J"): self._join,
            ord("N"): self._node,
            ord("n"): self._node_gone,
            ord("E"): self._endpoint,
            ord("e"): self._endpoint_gone,
            ord("Q"): self._request,
            ord("R"): self._response,
            ord("L"): self._alive,
        }

    def handle(self, link: ProcessLink, kind: int, payload: bytes) -> None:
        """Handle one frame from a process. Raises `Violation`."""
        if not link.began:
            self._hello(link, kind, payload)
            return
        handler = self._handlers.get(kind)
        if handler is None:
            raise Violation("protocol", f"a frame of kind {chr(kind)!r} is not for the hub")
        handler(link, payload)

    def _hello(self, link: ProcessLink, kind: int, payload: bytes) -> None:
        if kind != ord("H") or link.hello:
            raise Violation("protocol", "a process sends something other than HELLO before it gets WELCOME")
        link.hello = frames.hello(payload)

    def _forked(self, link: ProcessLink, payload: bytes) -> None:
        child, now = frames.forked(payload)
        self._begins[link.listener, child] = link.moment(link.handled, now)[1]
        link.queue(frames.FORK_SEEN)

    def is_still_forking(self, link: ProcessLink) -> bool:
        """Return whether a new process's parent has not reported yet when it forked it."""
        parents = {(other.listener, other.pid_inside) for other in self.links if other.began}
        return link.order not in self._begins and bool(link.hello) and (link.listener, link.parent_inside) in parents

    def welcome(self, link: ProcessLink, now: int) -> None:
        """Let a process that has sent HELLO begin: when its parent forked it, otherwise at the time `now`."""
        now = self._begins.pop(link.order, now)
        link.begin(now, self.published)
        link.queue(frames.to_welcome(link.number, now, EPOCH))

    def _idle(self, link: ProcessLink, payload: bytes) -> None:
        link.believe(frames.idle(payload))

    # --- the graph

    def _join(self, link: ProcessLink, payload: bytes) -> None:
        if not link.joined:
            link.joined = True
            for node in self.graph.nodes.values():
                if node.id >> 32 != link.number:
                    link.queue(frames.to_node(node))
            for endpoint in self.graph.endpoints.values():
                if endpoint.process != link.number:
                    link.queue(frames.to_endpoint(endpoint))
        link.queue(frames.GRAPH_COMPLETE)

    def _node(self, link: ProcessLink, payload: bytes) -> None:
        node = frames.node(payload)
        self._new(link, node.id, self.graph.nodes)
        self._use.nodes(len(self.graph.nodes))
        link.nodes.add(node.id)
        self.graph.add_node(node)
        self._broadcast(frames.to_node(node), link)

    def _node_gone(self, link: ProcessLink, payload: bytes) -> None:
        number = frames.identity(payload)
        if number not in link.nodes:
            raise Violation("protocol", "a process removes a node that is not its own")
        self._remove_node(link, number)

    def _remove_node(self, link: ProcessLink, number: int) -> None:
        for endpoint in self.graph.endpoints_of(number):
            self._remove_endpoint(link, endpoint.id)
        link.nodes.discard(number)
        self.graph.remove_node(number)
        self._broadcast(frames.to_gone(b"n", number), link)

    def _endpoint(self, link: ProcessLink, payload: bytes) -> None:
        endpoint = frames.endpoint(payload)
        self._new(link, endpoint.id, self.graph.endpoints)
        if endpoint.node not in link.nodes:
            raise Violation("protocol", "an endpoint of a node that is not the process's own")
        self._use.endpoints(len(self.graph.endpoints))
        link.endpoints.add(endpoint.id)
        self._add(endpoint)
        self._broadcast(frames.to_endpoint(endpoint), link)
        if endpoint.kind == SUBSCRIPTION and endpoint.qos.durability == TRANSIENT_LOCAL:
            self._replay(link, endpoint)

    def _replay(self, link: ProcessLink, subscription: EndpointFrame) -> None:
        """Send a new subscription what the hub published before. Processes replay their own messages."""
        for writer in self.graph.writers(subscription):
            publisher = self._ends.get(writer.id)
            if isinstance(publisher, HubPublisher):
                for source_time, cdr in publisher.history:
                    link.queue(frames.to_data(writer.id, subscription.id, source_time, cdr))
                link.queue(frames.to_replayed(writer.id, subscription.id))

    def _endpoint_gone(self, link: ProcessLink, payload: bytes) -> None:
        number = frames.identity(payload)
        if number not in link.endpoints:
            raise Violation("protocol", "a process removes an endpoint that is not its own")
        self._remove_endpoint(link, number)

    def _remove_endpoint(self, link: ProcessLink, number: int) -> None:
        link.endpoints.discard(number)
        self._remove(number)
        self._broadcast(frames.to_gone(b"e", number), link)

    def _new(self, link: ProcessLink, number: int, known: dict[int, NodeFrame] | dict[int, EndpointFrame]) -> None:
        if number >> 32 != link.number or number in known:
            raise Violation("protocol", "an identity that is not the process's own, or is used twice")

    def _add(self, endpoint: EndpointFrame) -> None:
        self.graph.add(endpoint)
        self._routes.clear()

    def _remove(self, number: int) -> None:
        self.graph.remove(number)
        self._routes.clear()

    def _broadcast(self, frame: bytes, origin: ProcessLink | None = None) -> None:
        for link in self.links:
            if link is not origin and link.joined:
                self._pass_on(origin, link, frame)

    def _pass_on(self, origin: ProcessLink | None, to: ProcessLink, frame: bytes) -> None:
        """Keep what one process sends to another until all are idle: see `deliver`."""
        if origin is None:
            to.queue(frame)
        else:
            self._use.unread(len(frame) + FRAME_OVERHEAD)
            self._held.append((origin, to, frame))

    def deliver(self) -> bool:
        """Forward what processes sent to one another, in the order of the senders. Return whether there was anything.

        Processes run in parallel; otherwise it would be random whose message arrives first.
        """
        held, self._held = sorted(self._held, key=lambda one: one[0].order), []
        for _, to, frame in held:
            self._use.unread(-len(frame) - FRAME_OVERHEAD)
            if to in self.links:
                to.queue(frame)
        asked, self._asked = sorted(self._asked, key=lambda one: one[0]), []
        for _, server, request in asked:
            server.serve(request)
        return bool(held or asked)

    def forget(self, link: ProcessLink) -> None:
        """Remove a process that has ended, and everything it had."""
        self.links.remove(link)
        if link.hello:
            self._begins[link.order] = link.now  # it may have become another program, with the same id
        for number in tuple(link.endpoints):
            self._remove_endpoint(link, number)
        for number in tuple(link.nodes):
            self._remove_node(link, number)
        self._routes.clear()

    # --- messages, requests and responses

    def _data(self, link: ProcessLink, payload: bytes) -> None:
        data = frames.data(payload)
        self._use.data(len(data.cdr))
        publisher = self._own(link, data.publisher, PUBLISHER)
        handled, now = link.moment(data.handled, data.now)
        if not data.only:
            self._at_once.count(publisher, now)
        route = self._routes.get(publisher.id) or self._route(publisher)
        ordered = link.is_main(data.thread) and not route.shared
        for subscription in route.subscriptions:
            if data.only in (0, subscription.endpoint.id):
                stage = self._stage(link, handled)
                subscription.take(DeliveredMessage(publisher, route.node, now, stage, handled, ordered, data.cdr))
        if route.links:
            frame = frames.to_data(publisher.id, data.only, data.source_time, data.cdr)
            for other in route.links:
                self._pass_on(link, other, frame)

    def _kept(self, link: ProcessLink, payload: bytes) -> None:
        """Count messages that stayed inside a process."""
        kept = frames.kept(payload)
        sender = self._own(link, kept.sender, PUBLISHER, CLIENT)
        _, now = link.moment(kept.handled, kept.now)
        self._at_once.count(sender, now, kept.number)

    def _replayed(self, link: ProcessLink, payload: bytes) -> None:
        """Tell a late subscription that a process has sent everything its publisher had kept."""
        number, subscription = frames.replayed(payload)
        publisher = self._own(link, number, PUBLISHER)
        other = self._link(subscription >> 32)
        if other is not None and subscription in other.endpoints:
            self._pass_on(link, other, frames.to_replayed(publisher.id, subscription))

    def _own(self, link: ProcessLink, number: int, *kinds: int) -> EndpointFrame:
        endpoint = self.graph.endpoints.get(number) if number in link.endpoints else None
        if endpoint is None or endpoint.kind not in kinds:
            raise Violation("protocol", "a process speaks for an endpoint that is not its own")
        return endpoint

    def _route(self, publisher: EndpointFrame) -> Route:
        readers = self.graph.readers(publisher)
        own = [self._ends[reader.id] for reader in readers if reader.process == HUB]
        others = {reader.process for reader in readers} - {publisher.process}
        subscriptions = [end for end in own if isinstance(end, HubSubscription)]
        links = [link for link in self.links if link.number in others]
        node = self.graph.nodes[publisher.node].full_name
        route = Route(node, self._is_shared(publisher, node), subscriptions, links)
        self._routes[publisher.id] = route
        return route

    def _is_shared(self, publisher: EndpointFrame, node: str) -> bool:
        rivals = self.graph.of_program(publisher.name, PUBLISHER)
        return any(
            rival.process != publisher.process and self.graph.nodes[rival.node].full_name == node for rival in rivals
        )

    def _request(self, link: ProcessLink, payload: bytes) -> None:
        call = frames.call(payload)
        self._use.data(len(call.cdr))
        client = self._own(link, call.client, CLIENT)
        moment = self._moment(link, call)
        self._at_once.count(client, moment.now)
        servers = self.graph.servers(client)
        asked = PendingRequest(client, self.graph.nodes[client.node].full_name, call.number, moment, call.cdr)
        if not servers:
            self.unserved.append(asked)
        for server in servers:
            own = self._ends.get(server.id)
            if isinstance(own, HubServer):
                self._asked.append((link.order, own, asked))
            elif server.process != link.number:
                self._ask(link, server, client.id, call.number, call.source_time, call.cdr)

    def _ask(
        self, origin: ProcessLink | None, server: EndpointFrame, client: int, number: int, source_time: int, cdr: bytes
    ) -> None:
        link = self._link(server.process)
        if link is None:
            return
        self._use.unanswered(1 + sum(len(other.requests) for other in self.links))
        link.requests.add((client, number))
        self._pass_on(origin, link, frames.to_request(server.id, client, number, source_time, cdr))

    def _response(self, link: ProcessLink, payload: bytes) -> None:
        call = frames.call(payload)
        self._use.data(len(call.cdr))
        moment = self._moment(link, call)
        if (call.client, call.number) not in link.requests:
            raise Violation("protocol", "a response to a request that was never sent")
        link.requests.discard((call.client, call.number))
        own = self._ends.get(call.client)
        if isinstance(own, HubClient):
            own.answered(call.number, moment, call.cdr)
            return
        other = self._link(call.client >> 32)
        if other is not None and call.client in other.endpoints:
            self._pass_on(link, other, frames.to_response(call.client, call.number, call.source_time, call.cdr))

    def _moment(self, link: ProcessLink, call: frames.CallFrame) -> Moment:
        handled, now = link.moment(call.handled, call.now)
        return Moment(now, self._stage(link, handled), handled, link.is_main(call.thread))

    def _stage(self, link: ProcessLink, handled: int) -> int:
        """Return the number of the last publication before a moment of a process.

        Processes may pass a message on to one another, so one may act on it before it has handled the message itself.
        So with several processes, everything counts as sent after what was published while all were idle.
        """
        return max(self._certain, link.stage(handled))

    def _alive(self, link: ProcessLink, payload: bytes) -> None:
        publisher = self._own(link, frames.identity(payload), PUBLISHER)
        for other in self._route(publisher).links:
            self._pass_on(link, other, frames.to_gone(b"L", publisher.id))

    def _link(self, number: int) -> ProcessLink | None:
        return next((link for link in self.links if link.number == number), None)

    # --- the hub's own endpoints: see `rmw_lockstep.hub.endpoints.EndpointHost`

    def new_node(self, name: str, namespace: str = "/") -> NodeFrame:
        """Return a new node of the hub."""
        node = NodeFrame(next(self._numbers), name, namespace)
        self.graph.add_node(node)
        self._broadcast(frames.to_node(node))
        return node

    def new_endpoint(self, kind: int, node: NodeFrame, name: str, type: str, qos: QosPolicies) -> EndpointFrame:
        """Return an identity for one of the hub's endpoints."""
        return EndpointFrame(next(self._numbers), kind, node.id, name, type, type_hash(type), qos)

    def add_end(self, end: HubEndpoint) -> None:
        """Add it to the graph."""
        self._ends[end.endpoint.id] = end
        self._add(end.endpoint)
        self._broadcast(frames.to_endpoint(end.endpoint))
        if isinstance(end, HubPublisher):
            self._replay_nothing(end.endpoint)

    def _replay_nothing(self, publisher: EndpointFrame) -> None:
        """Tell existing subscriptions that a new publisher has kept nothing for them."""
        for reader in self.graph.readers(publisher):
            link = self._link(reader.process)
            if link is not None and reader.qos.durability == TRANSIENT_LOCAL:
                link.queue(frames.to_replayed(publisher.id, reader.id))

    def remove_end(self, end: HubEndpoint) -> None:
        """Remove it from the graph."""
        del self._ends[end.endpoint.id]
        self._remove(end.endpoint.id)
        self._broadcast(frames.to_gone(b"e", end.endpoint.id))

    @property
    def serves(self) -> bool:
        """Whether the hub itself answers anything."""
        return any(isinstance(end, HubServer) for end in self._ends.values())

    def matched(self, endpoint: EndpointFrame) -> tuple[EndpointFrame, ...]:
        """Return the processes' endpoints that exchange messages with one of the hub's endpoints."""
        graph = self.graph
        if endpoint.kind == SERVER:
            clients = graph.of_program(endpoint.name, CLIENT)
            return tuple(client for client in clients if client.type == endpoint.type)
        others = {PUBLISHER: graph.readers, SUBSCRIPTION: graph.writers, CLIENT: graph.servers}[endpoint.kind]
        return tuple(other for other in others(endpoint) if other.process != HUB)

    def publish(self, publisher: HubPublisher, cdr: bytes) -> int:
        """Queue a message for every process that subscribes, or may subscribe by the time the message arrives."""
        self.published += 1
        self._at_once.begin()
        if self._use.connections > 1:
            self._certain = self.published
        source_time = self._calendar()
        publisher.history.append((source_time, cdr))
        frame = frames.to_data(publisher.endpoint.id, 0, source_time, cdr)
        processes = {reader.process for reader in self.graph.readers(publisher.endpoint)}
        for link in self.links:
            if link.joined and (link.number in processes or link.idle is None):
                link.queue(frame)
            link.mark(self.published)
        return self.published

    def request(self, client: HubClient, number: int, cdr: bytes) -> bool:
        """Queue a request; return False if it has no server."""
        servers = self.matched(client.endpoint)
        for server in servers:
            self._ask(None, server, client.endpoint.id, number, self._calendar(), cdr)
        return bool(servers)

    def respond(self, client: int, number: int, cdr: bytes) -> None:
        """Queue one of the hub's responses to a process."""
        link = self._link(client >> 32)
        if link is not None:
            link.queue(frames.to_response(client, number, self._calendar(), cdr))
