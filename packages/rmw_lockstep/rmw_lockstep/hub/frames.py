"""The frames of PROTOCOL.md: decodes and checks those from a process, and encodes those to a process.

Frames that are sent once per message are NamedTuples: Python creates them five times as fast as frozen dataclasses.
"""

from __future__ import annotations

import re
import struct
from dataclasses import dataclass
from typing import NamedTuple

from rmw_lockstep.hub.limits import Violation
from rmw_lockstep.qos import QosPolicies
from rmw_lockstep.type_hash import HASH_BYTES

VERSION = 3

PUBLISHER, SUBSCRIPTION, SERVER, CLIENT = range(4)

#: No name in ROS 2 may be longer than this (rmw_validate_full_topic_name, rmw_validate_node_name).
LONGEST_NAME = 255

#: A process reports at most this many children.
MOST_CHILDREN = 1_000

HEADER = struct.Struct("<IB")
_HELLO = struct.Struct("<IIIB")
_FORKED = struct.Struct("<Iq")
_WELCOME = struct.Struct("<IIqq")
_ID = struct.Struct("<Q")
_PAIR = struct.Struct("<QQ")
_LENGTH = struct.Struct("<I")
_ENDPOINT = struct.Struct("<QBQ")
_QOS = struct.Struct("<BIBBBqqq")
DATA = struct.Struct("<QQqQqI")
CALL = struct.Struct("<QqqQqI")
KEPT = struct.Struct("<QIQqI")
_IDLE = struct.Struct("<QqqIIIBQH")
OUT_DATA = struct.Struct("<QQq")
OUT_REQUEST = struct.Struct("<QQqq")
OUT_RESPONSE = struct.Struct("<Qqq")
TIME = struct.Struct("<qB")

_NODE_NAME = re.compile(r"[A-Za-z_][A-Za-z0-9_]*")
_NAMESPACE = re.compile(r"/|(/[A-Za-z_][A-Za-z0-9_]*)+")
# Names that "avoid ROS namespace conventions" may begin without a slash.
_TOPIC = re.compile(r"[!-~]+")
_TYPE = re.compile(r"[A-Za-z][A-Za-z0-9_]*(/[A-Za-z0-9_]+)+")

#: Flags of IDLE.
POLLS, KERNEL_SLEEP = 1, 2


@dataclass(frozen=True)
class HelloFrame:
    """Introduces a process. `pid` and `parent` are its own and its parent's id, as the process sees them."""

    version: int
    pid: int
    parent: int
    timed: bool


@dataclass(frozen=True)
class NodeFrame:
    """A node of any process or of the hub."""

    id: int
    name: str
    namespace: str

    @property
    def full_name(self) -> str:
        """For example `/arm/controller`."""
        return f"{self.namespace.rstrip('/')}/{self.name}"


@dataclass(frozen=True)
class EndpointFrame:
    """A publisher, subscription, server or client of any process or of the hub."""

    id: int
    kind: int
    node: int
    name: str
    type: str
    hash: bytes
    qos: QosPolicies

    @property
    def process(self) -> int:
        """The number of the process that it belongs to; 0 is the hub."""
        return self.id >> 32


class DataFrame(NamedTuple):
    """A message, sent when its process had handled `handled` of the hub's frames and its clock showed `now` (ns)."""

    publisher: int
    only: int
    source_time: int
    handled: int
    now: int
    thread: int
    cdr: bytes


class CallFrame(NamedTuple):
    """A request or a response."""

    client: int
    number: int
    source_time: int
    handled: int
    now: int
    thread: int
    cdr: bytes


class KeptFrame(NamedTuple):
    """A count of one endpoint's messages or requests that stayed inside the process at one moment."""

    sender: int
    number: int
    handled: int
    now: int
    thread: int


class IdleFrame(NamedTuple):
    """Reports that a process is idle. `next` is when it will wake by itself (ns), or -1 for never.

    `runs`, in the answer to ASK, differs from an earlier answer if any of its threads has run in between; otherwise 0.
    """

    handled: int
    now: int
    next: int
    in_ros: int
    in_time: int
    others: int
    flags: int
    runs: int
    children: tuple[int, ...]


# --- from a process


def hello(payload: bytes) -> HelloFrame:
    """Decode a HELLO. Raises `Violation` if it is invalid or of an unknown version; so do the functions below."""
    version, pid, parent, timed = _exactly(_HELLO, payload)
    if version != VERSION:
        raise Violation("protocol", f"a process speaks version {version} of the protocol, the hub version {VERSION}")
    return HelloFrame(version, pid, parent, bool(timed))


def forked(payload: bytes) -> tuple[int, int]:
    """Decode a FORKED: the child's id, and the time (ns)."""
    child, now = _exactly(_FORKED, payload)
    return child, now


def node(payload: bytes) -> NodeFrame:
    """Decode a NODE."""
    (number,) = _first(_ID, payload)
    name, at = _string(payload, _ID.size)
    namespace, at = _string(payload, at)
    _end(payload, at)
    _check(_NODE_NAME, name, "a node's name")
    _check(_NAMESPACE, namespace, "a namespace")
    return NodeFrame(number, name, namespace)


def endpoint(payload: bytes) -> EndpointFrame:
    """Decode an ENDPOINT."""
    number, kind, owner = _first(_ENDPOINT, payload)
    if kind > CLIENT:
        raise Violation("protocol", f"there is no endpoint of kind {kind}")
    name, at = _string(payload, _ENDPOINT.size)
    type_name, at = _string(payload, at)
    if len(payload) != at + HASH_BYTES + _QOS.size:
        raise Violation("protocol", "an ENDPOINT frame has the wrong length")
    _check(_TOPIC, name, "the name of a topic or service")
    _check(_TYPE, type_name, "a type")
    qos = QosPolicies(*_QOS.unpack_from(payload, at + HASH_BYTES))
    return EndpointFrame(number, kind, owner, name, type_name, bytes(payload[at : at + HASH_BYTES]), qos)


def identity(payload: bytes) -> int:
    """Decode the identity in a NODE_GONE, ENDPOINT_GONE or ALIVE."""
    (number,) = _exactly(_ID, payload)
    return int(number)


def replayed(payload: bytes) -> tuple[int, int]:
    """Decode a REPLAYED: return its publisher and its subscription."""
    publisher, subscription = _exactly(_PAIR, payload)
    return publisher, subscription


def data(payload: bytes) -> DataFrame:
    """Decode a DATA."""
    return DataFrame._make((*_first(DATA, payload), payload[DATA.size :]))


def call(payload: bytes) -> CallFrame:
    """Decode a REQUEST or a RESPONSE."""
    return CallFrame._make((*_first(CALL, payload), payload[CALL.size :]))


def kept(payload: bytes) -> KeptFrame:
    """Decode a KEPT."""
    return KeptFrame._make(_exactly(KEPT, payload))


def idle(payload: bytes) -> IdleFrame:
    """Decode an IDLE."""
    handled, now, next_, in_ros, in_time, others, flags, runs, count = _first(_IDLE, payload)
    if count > MOST_CHILDREN or len(payload) != _IDLE.size + 4 * count:
        raise Violation("protocol", "an IDLE frame has the wrong length")
    children = struct.unpack_from(f"<{count}I", payload, _IDLE.size) if count else ()
    return IdleFrame(handled, now, next_, in_ros, in_time, others, flags, runs, children)


def _first(form: struct.Struct, payload: bytes) -> tuple[int, ...]:
    try:
        return form.unpack_from(payload)
    except struct.error:
        raise Violation("protocol", "a frame is too short") from None


def _exactly(form: struct.Struct, payload: bytes) -> tuple[int, ...]:
    _end(payload, form.size)
    return form.unpack(payload)


def _end(payload: bytes, at: int) -> None:
    if len(payload) != at:
        raise Violation("protocol", f"a frame has {len(payload)} bytes instead of {at}")


def _string(payload: bytes, at: int) -> tuple[str, int]:
    if len(payload) < at + _LENGTH.size:
        raise Violation("protocol", "a frame is too short")
    (length,) = _LENGTH.unpack_from(payload, at)
    at += _LENGTH.size
    if length > LONGEST_NAME or len(payload) < at + length:
        raise Violation("protocol", f"a name of {length} bytes")
    try:
        return payload[at : at + length].decode("utf-8"), at + length
    except UnicodeDecodeError:
        raise Violation("protocol", "a name that is not UTF-8") from None


def _check(pattern: re.Pattern[str], text: str, what: str) -> None:
    if not pattern.fullmatch(text):
        raise Violation("protocol", f"{text[:50]!r} is not valid as {what}")


# --- from the hub


def frame(kind: bytes, payload: bytes = b"") -> bytes:
    """Return a whole frame."""
    return HEADER.pack(len(payload) + 1, kind[0]) + payload


BARRIER = frame(b"|")
ASK = frame(b"?")
FORK_SEEN = frame(b"F")
GRAPH_COMPLETE = frame(b"g")


def to_welcome(process: int, now: int, epoch: int) -> bytes:
    """Encode a WELCOME."""
    return frame(b"W", _WELCOME.pack(VERSION, process, now, epoch))


def to_node(node: NodeFrame) -> bytes:
    """Encode a NODE."""
    return frame(b"N", _ID.pack(node.id) + _text(node.name) + _text(node.namespace))


def to_endpoint(endpoint: EndpointFrame) -> bytes:
    """Encode an ENDPOINT."""
    qos = endpoint.qos
    policies = _QOS.pack(
        qos.history, qos.depth, qos.reliability, qos.durability, qos.liveliness, qos.deadline, qos.lifespan, qos.lease
    )
    names = _text(endpoint.name) + _text(endpoint.type)
    return frame(b"E", _ENDPOINT.pack(endpoint.id, endpoint.kind, endpoint.node) + names + endpoint.hash + policies)


def to_gone(kind: bytes, number: int) -> bytes:
    """Encode NODE_GONE, ENDPOINT_GONE or ALIVE, by its `kind`."""
    return frame(kind, _ID.pack(number))


def to_replayed(publisher: int, subscription: int) -> bytes:
    """Encode a REPLAYED."""
    return frame(b"r", _PAIR.pack(publisher, subscription))


def to_data(publisher: int, only: int, source_time: int, cdr: bytes) -> bytes:
    """Encode a DATA."""
    return HEADER.pack(OUT_DATA.size + len(cdr) + 1, 68) + OUT_DATA.pack(publisher, only, source_time) + cdr


def to_request(server: int, client: int, number: int, source_time: int, cdr: bytes) -> bytes:
    """Encode a REQUEST."""
    return frame(b"Q", OUT_REQUEST.pack(server, client, number, source_time) + cdr)


def to_response(client: int, number: int, source_time: int, cdr: bytes) -> bytes:
    """Encode a RESPONSE."""
    return frame(b"R", OUT_RESPONSE.pack(client, number, source_time) + cdr)


def to_time(until: int) -> bytes:
    """Encode a TIME, which does not end before `until` (ns)."""
    return frame(b"T", TIME.pack(until, False))


def _text(text: str) -> bytes:
    encoded = text.encode()
    return _LENGTH.pack(len(encoded)) + encoded
