"""One process of a graph: its endpoints, their matches, and what they send and receive.

Discovery: a new participant sends `hello`, all others then send it their nodes and endpoints, and each announces those
that it creates or drops. Each participant finds its matches by itself. The writing side decides who gets a message, so
nothing arrives twice, and a late joiner gets the past before the present.
"""

from __future__ import annotations

import itertools
import os
from collections import deque
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Any

from rcl_python import qos as quality
from rcl_python.graph import (
    CLIENT,
    OPPOSITE,
    PUBLISHER,
    SERVICE,
    SUBSCRIPTION,
    EndpointInfo,
    Graph,
    NodeInfo,
    endpoint_from,
    node_from,
    process_of,
    to_plain,
)
from rcl_python.link import Frame, Link, LocalLink
from rcl_python.qos import Profile
from rcl_python.values import (
    RMW_DURATION_INFINITE,
    rmw_incompatible_type_status_t,
    rmw_liveliness_changed_status_t,
    rmw_matched_status_t,
    rmw_offered_deadline_missed_status_t,
    rmw_requested_deadline_missed_status_t,
    rmw_requested_qos_incompatible_event_status_t,
)
from rmw_lockstep.qos import KEEP_ALL, TRANSIENT_LOCAL


@dataclass(frozen=True)
class Arrival:
    """Something that has arrived: its bytes, when it was sent and received (ns since the epoch), and the sender."""

    data: bytes
    sent: int
    came: int
    sequence: int
    source: str


class Statuses:
    """What an endpoint can report as events; each counts what has changed since it was last taken."""

    def __init__(self) -> None:
        self.matched = rmw_matched_status_t()
        self.incompatible = rmw_requested_qos_incompatible_event_status_t()
        self.other_type = rmw_incompatible_type_status_t()
        self.liveliness = rmw_liveliness_changed_status_t()
        self.offered_deadline = rmw_offered_deadline_missed_status_t()
        self.requested_deadline = rmw_requested_deadline_missed_status_t()


def _add(status: object, count: str, number: int) -> None:
    """Change one of a status's counts, and by how much it has changed since it was last taken."""
    for name in (count, f"{count}_change"):
        setattr(status, name, getattr(status, name) + number)


class LocalEndpoint:
    """An endpoint of this process."""

    def __init__(self, participant: Participant, info: EndpointInfo) -> None:
        self.participant = participant
        self.info = info
        profile = info.qos
        kept = None if profile.history == KEEP_ALL else max(profile.depth, 1)
        self.inbox: deque[Arrival] = deque(maxlen=kept if info.kind == SUBSCRIPTION else None)
        remembers = info.kind == PUBLISHER and profile.durability == TRANSIENT_LOCAL
        self.history: deque[Arrival] | None = deque(maxlen=kept) if remembers else None
        self.matched: dict[str, EndpointInfo] = {}
        self.statuses = Statuses()
        self.sequence = 0
        self.due: int | None = None
        """When the next message is due (ns, steady), if the profile has a deadline."""

    def close(self) -> None:
        """Remove the endpoint from the graph."""
        self.participant.remove_endpoint(self)

    def publish(self, data: bytes) -> None:
        """Send a message to every matched subscription, and keep it for late joiners if configured."""
        link = self.participant.link
        with link.lock:
            self.sequence += 1
            message = Arrival(data, link.system(), 0, self.sequence, self.info.gid)
            self._punctual()
            if self.history is not None:
                self.history.append(message)
            if not self.participant.deliver(message, self.matched):
                self.participant.on_kept(self.info)

    def get(self, message: Arrival) -> None:
        """Put what has arrived into the inbox."""
        self._punctual()
        self.inbox.append(message)

    def take(self) -> Arrival | None:
        """Return the oldest thing in the inbox whose lifespan has not passed, or None."""
        with self.participant.link.lock:
            while self.inbox:
                message = self.inbox.popleft()
                sender = self.matched.get(message.source)
                if not sender or not _outlived(message, sender.qos, self.participant.link.system()):
                    return message
        return None

    def meet(self, other: EndpointInfo) -> None:
        """Check whether this endpoint and another match, and remember it if they do."""
        mine = self.info
        if other.kind != OPPOSITE[mine.kind] or other.topic != mine.topic or other.domain != mine.domain:
            return
        # Fast DDS does not report another type either.
        if other.gid in self.matched or other.type != mine.type:
            return
        policy = self._incompatible(other)
        if policy is None:
            self._match(other)
        else:
            _add(self.statuses.incompatible, "total_count", 1)
            self.statuses.incompatible.last_policy_kind = policy

    def part(self, gid: str) -> None:
        """Forget another endpoint, which has gone."""
        if self.matched.pop(gid, None) is None:
            return
        _add(self.statuses.matched, "current_count", -1)
        _add(self.statuses.liveliness, "alive_count", -1)

    def _incompatible(self, other: EndpointInfo) -> Any:
        if self.info.kind == PUBLISHER:
            return quality.first_incompatible(self.info.qos, other.qos)
        if self.info.kind == SUBSCRIPTION:
            return quality.first_incompatible(other.qos, self.info.qos)
        return None

    def _match(self, other: EndpointInfo) -> None:
        self.matched[other.gid] = other
        _add(self.statuses.matched, "total_count", 1)
        _add(self.statuses.matched, "current_count", 1)
        _add(self.statuses.liveliness, "alive_count", 1)
        if self.history and other.qos.durability == TRANSIENT_LOCAL:
            now = self.participant.link.system()
            for message in self.history:
                if not _outlived(message, self.info.qos, now):
                    self.participant.deliver(message, {other.gid: other})

    def _punctual(self) -> None:
        """Restart the time to the next deadline."""
        self.late()
        if 0 < self.info.qos.deadline < RMW_DURATION_INFINITE:
            self.due = self.participant.link.steady() + self.info.qos.deadline

    def late(self) -> None:
        """Count the deadlines that have passed."""
        now = self.participant.link.steady()
        while self.due is not None and self.due <= now:
            self.due += self.info.qos.deadline
            is_publisher = self.info.kind == PUBLISHER
            missed = self.statuses.offered_deadline if is_publisher else self.statuses.requested_deadline
            _add(missed, "total_count", 1)


def _outlived(message: Arrival, profile: Profile, now: int) -> bool:
    return 0 < profile.lifespan < now - message.sent


class Participant:
    """A process's part in the graph. `identity` is unique among all that share a hub."""

    def __init__(self, link: Link, identity: str) -> None:
        self.link = link
        self.identity = identity
        self.graph = Graph()
        self.local: dict[str, LocalEndpoint] = {}
        self.on_signal: Callable[[str], None] = lambda name: None
        self.overhearing: list[Callable[[Frame, bytes], None]] = []
        """Called with each response that arrives, for any client."""
        self.on_kept: Callable[[EndpointInfo], None] = lambda sender: None
        """Called with the sender of each message or request that no other process gets."""
        self._numbers = itertools.count(1)
        self._joined = False

    def join(self) -> None:
        """Send `hello`, once."""
        if not self._joined:
            self._joined = True
            self.link.send({"op": "hello", "from": self.identity})
            self.pump()

    def new_key(self) -> str:
        """Return a key that nothing else has."""
        return f"{self.identity}.{next(self._numbers)}"

    def add_node(self, name: str, namespace: str, domain: int, enclave: str) -> NodeInfo:
        """Announce a node."""
        with self.link.lock:
            info = NodeInfo(self.new_key(), name, namespace, domain, enclave)
            self.graph.nodes[info.key] = info
            self.link.send({"op": "node", **to_plain(info)})
            self._changed()
        return info

    def remove_node(self, key: str) -> None:
        """Announce that a node is gone."""
        with self.link.lock:
            self.graph.nodes.pop(key, None)
            self.link.send({"op": "node_gone", "key": key})
            self._changed()

    def add_endpoint(self, kind: str, node: NodeInfo, topic: str, type_name: str, profile: Profile) -> LocalEndpoint:
        """Announce an endpoint, and find its matches."""
        with self.link.lock:
            self.pump()
            others = self.graph.ends(node.domain, OPPOSITE[kind], topic=topic)
            found = quality.resolved(profile, [end.qos for end in others], publishes=kind == PUBLISHER)
            info = EndpointInfo(self.new_key(), kind, node.key, topic, type_name, found, node.domain)
            mine = self.local[info.gid] = LocalEndpoint(self, info)
            self.graph.endpoints[info.gid] = info
            self.link.send({"op": "endpoint", **to_plain(info)})
            self._introduce(mine)
            self._changed()
        return mine

    def _introduce(self, mine: LocalEndpoint) -> None:
        """Introduce readers first, so that the messages kept by a writer find the reader ready."""
        for other in list(self.graph.endpoints.values()):
            there = self.local.get(other.gid)
            for one, two in ((mine, other), (there, mine.info)):
                if one is not None and one.info.kind in (SUBSCRIPTION, SERVICE, CLIENT):
                    one.meet(two)
            for one, two in ((mine, other), (there, mine.info)):
                if one is not None and one.info.kind == PUBLISHER:
                    one.meet(two)

    def remove_endpoint(self, mine: LocalEndpoint) -> None:
        """Announce that an endpoint is gone."""
        with self.link.lock:
            self.local.pop(mine.info.gid, None)
            self._forget(mine.info.gid)
            self.link.send({"op": "endpoint_gone", "gid": mine.info.gid})
            self._changed()

    def deliver(self, message: Arrival, readers: dict[str, EndpointInfo]) -> bool:
        """Send a message to these subscriptions. Return whether any of them is of another process."""
        far = []
        for gid in readers:
            mine = self.local.get(gid)
            if mine is None:
                far.append(gid)
            else:
                mine.get(self._arrived(message))
        if far:
            head = {"op": "message", "from": message.source, "to": far, "sent": message.sent, "n": message.sequence}
            self.link.send(head, message.data)
        self._changed()
        return bool(far)

    def request(self, client: LocalEndpoint, data: bytes) -> int:
        """Send a request to every matched server; return its number."""
        with self.link.lock:
            client.sequence += 1
            if not self._exchange("request", list(client.matched), client.info.gid, client.sequence, data):
                self.on_kept(client.info)
        return client.sequence

    def respond(self, service: LocalEndpoint, client: str, number: int, data: bytes) -> None:
        """Send a response to the client that sent the request."""
        with self.link.lock:
            self._exchange("response", [client], service.info.gid, number, data)

    def _exchange(self, op: str, to: list[str], source: str, number: int, data: bytes) -> bool:
        now = self.link.system()
        message = Arrival(data, now, now, number, source)
        for gid in to:
            if gid in self.local:
                self.local[gid].inbox.append(message)
        far = [gid for gid in to if gid not in self.local]
        if far:
            self.link.send({"op": op, "from": source, "to": far, "sent": now, "n": number}, data)
        self._changed()
        return bool(far)

    def pump(self, enough: Callable[[], bool] = lambda: False) -> None:
        """Process what others have sent, until nothing is left or `enough` returns true."""
        with self.link.lock:
            for frame, data in self.link.receive():
                getattr(self, f"_on_{frame['op']}")(frame, data)
                if enough():
                    return

    def _arrived(self, message: Arrival) -> Arrival:
        return Arrival(message.data, message.sent, self.link.system(), message.sequence, message.source)

    def _changed(self) -> None:
        self.link.lock.notify_all()

    def _forget(self, gid: str) -> None:
        self.graph.endpoints.pop(gid, None)
        for mine in self.local.values():
            mine.part(gid)

    def _on_hello(self, frame: Frame, data: bytes) -> None:
        for node in list(self.graph.nodes.values()):
            if process_of(node.key) == self.identity:
                self.link.send({"op": "node", **to_plain(node)})
        for mine in list(self.local.values()):
            self.link.send({"op": "endpoint", **to_plain(mine.info)})

    def _on_node(self, frame: Frame, data: bytes) -> None:
        info = node_from(frame)
        self.graph.nodes[info.key] = info

    def _on_node_gone(self, frame: Frame, data: bytes) -> None:
        self.graph.nodes.pop(frame["key"], None)

    def _on_endpoint(self, frame: Frame, data: bytes) -> None:
        info = endpoint_from(frame)
        if info.gid not in self.graph.endpoints:
            self.graph.endpoints[info.gid] = info
            for mine in list(self.local.values()):
                mine.meet(info)

    def _on_endpoint_gone(self, frame: Frame, data: bytes) -> None:
        self._forget(frame["gid"])

    def _on_bye(self, frame: Frame, data: bytes) -> None:
        for end in self.graph.forget_process(frame["from"]):
            self._forget(end.gid)

    def _on_message(self, frame: Frame, data: bytes) -> None:
        for mine in self._here(frame["to"]):
            mine.get(Arrival(data, frame["sent"], self.link.system(), frame["n"], frame["from"]))

    def _on_request(self, frame: Frame, data: bytes) -> None:
        for mine in self._here(frame["to"]):
            mine.inbox.append(Arrival(data, frame["sent"], self.link.system(), frame["n"], frame["from"]))

    def _on_response(self, frame: Frame, data: bytes) -> None:
        for hear in self.overhearing:
            hear(frame, data)
        self._on_request(frame, data)

    def _on_signal(self, frame: Frame, data: bytes) -> None:
        self.on_signal(frame["name"])

    def _here(self, gids: Iterable[str]) -> list[LocalEndpoint]:
        return [self.local[gid] for gid in gids if gid in self.local]


_current = Participant(LocalLink(), f"p{os.getpid()}")


def current() -> Participant:
    """Return the participant of this process."""
    return _current


def use(link: Link, identity: str) -> Participant:
    """Give this process another link, before it makes its first node."""
    global _current
    _current = Participant(link, identity)
    return _current
