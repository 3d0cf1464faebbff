"""A small process of a program that speaks the protocol, in a thread of the test, to test the hub without any C++."""

from __future__ import annotations

import os
import socket
import struct
import threading
import time
from collections.abc import Callable
from pathlib import Path

import pytest

from rmw_lockstep.hub import Hub, Violation

QOS = struct.Struct("<BIBBBqqq")
INFINITE = 2**63 - 1
RELIABLE, BEST_EFFORT, TRANSIENT_LOCAL, VOLATILE = 1, 2, 1, 2


def frame(kind: bytes, payload: bytes = b"") -> bytes:
    return struct.pack("<IB", len(payload) + 1, kind[0]) + payload


def text(value: str | bytes) -> bytes:
    encoded = value.encode() if isinstance(value, str) else value
    return struct.pack("<I", len(encoded)) + encoded


def hello(pid: int = 1, parent: int = 0, version: int = 3) -> bytes:
    return frame(b"H", struct.pack("<IIIB", version, pid, parent, 1))


def node(number: int, name: str | bytes = "node", namespace: str = "/") -> bytes:
    return frame(b"N", struct.pack("<Q", number) + text(name) + text(namespace))


def endpoint(
    number: int,
    kind: int,
    of: int,
    name: str | bytes = "/topic",
    type_name: str = "std_msgs/msg/String",
    reliability: int = RELIABLE,
    durability: int = VOLATILE,
) -> bytes:
    qos = QOS.pack(1, 10, reliability, durability, 1, INFINITE, INFINITE, INFINITE)
    return frame(b"E", struct.pack("<QBQ", number, kind, of) + text(name) + text(type_name) + bytes(33) + qos)


def data(publisher: int, cdr: bytes = b"", handled: int = 1, now: int = 0, thread: int = 1, only: int = 0) -> bytes:
    return frame(b"D", struct.pack("<QQqQqI", publisher, only, 0, handled, now, thread) + cdr)


def response(client: int, number: int, cdr: bytes = b"") -> bytes:
    return frame(b"R", struct.pack("<QqqQqI", client, number, 0, 1, 0, 1) + cdr)


def idle(handled: int, now: int = 0, next_: int = -1, flags: int = 0, children: tuple[int, ...] = ()) -> bytes:
    payload = struct.pack("<QqqIIIBQH", handled, now, next_, 1, 0, 0, flags, 1, len(children))
    return frame(b"I", payload + struct.pack(f"<{len(children)}I", *children))


class Waits:
    """Ends a test that would wait forever."""

    def __init__(self) -> None:
        self._deadline = time.monotonic() + 60

    def __call__(self) -> None:
        assert time.monotonic() < self._deadline, "the hub waits forever"


class Raw:
    """A bare connection to the hub, to send anything at all."""

    def __init__(self, path: Path) -> None:
        self.socket = socket.socket(socket.AF_UNIX)
        self.socket.settimeout(60)
        self.socket.connect(str(path))

    def send(self, *frames: bytes) -> None:
        self.socket.sendall(b"".join(frames))

    def read(self) -> tuple[bytes, bytes]:
        """Return one of the hub's frames, as kind and payload. Raises EOFError at the end of the connection."""
        length, kind = struct.unpack("<IB", self._exactly(5))
        return bytes([kind]), self._exactly(length - 1)

    def _exactly(self, count: int) -> bytes:
        found = b""
        while len(found) < count:
            piece = self.socket.recv(count - len(found))
            if not piece:
                raise EOFError
            found += piece
        return found

    def close(self) -> None:
        self.socket.close()


def welcomed(raw: Raw, hub: Hub) -> Raw:
    """Return the same connection, after its HELLO has been answered."""
    raw.send(hello())
    while not hub.links or not hub.links[0].sent:
        hub.pause()
    assert raw.read()[0] == b"W"
    return raw


def violation(hub: Hub) -> Violation:
    """Return why the hub stopped."""
    with pytest.raises(Violation) as caught:
        hub.wait_until_idle()
    return caught.value


def busy(hub: Hub) -> None:
    """Report that something has been sent to the program, so what it reported is no longer true."""
    for link in hub.links:
        link.idle = None


class Process:
    """An honest process. It does what `on` says for each kind of frame, and wakes at the times in `wakes`.

    `does(process)` of a wake-up runs at its time; both may publish. Everything happens in a thread of its own.
    """

    def __init__(self, path: Path, pid: int = 1, joins: bool = True) -> None:
        self.raw = Raw(path)
        self.pid = pid
        self.on: dict[bytes, Callable[[Process, bytes], object]] = {}
        self.wakes: list[tuple[int, Callable[[Process], None]]] = []
        self.children: tuple[int, ...] = ()
        self.seen: list[tuple[int, bytes, bytes]] = []
        self.number = self.now = self.handled = self._count = 0
        self._lock = threading.RLock()
        self.raw.send(hello(pid, os.getpid()))
        self._joins = joins
        self._thread = threading.Thread(target=self._run, daemon=True)

    def start(self) -> Process:
        self._thread.start()
        return self

    def identity(self) -> int:
        self._count += 1
        return self.number << 32 | self._count

    def wake(self, at: int, does: Callable[[Process], None]) -> None:
        self.wakes.append((at, does))
        self.wakes.sort(key=lambda wake: wake[0])

    def make(self, name: str, *ends: tuple[int, str, dict[str, int]]) -> list[int]:
        """Announce a node with endpoints of `(kind, topic, qos)`. Returns their identities, the node's first."""
        numbers = [self.identity()]
        frames = [node(numbers[0], name)]
        for kind, topic, qos in ends:
            numbers.append(self.identity())
            frames.append(endpoint(numbers[-1], kind, numbers[0], topic, **qos))  # type: ignore[arg-type]
        self.raw.send(*frames)
        return numbers

    def publish(self, publisher: int, cdr: bytes, thread: int = 1, only: int = 0) -> None:
        self.raw.send(data(publisher, cdr, self.handled, self.now, thread, only))

    def say_idle(self) -> None:
        next_ = self.wakes[0][0] if self.wakes else -1
        self.raw.send(idle(self.handled, self.now, next_, children=self.children))

    def _run(self) -> None:
        try:
            while True:
                kind, payload = self.raw.read()
                self.seen.append((self.now, kind, payload))
                self._handle(kind, payload)
                self.handled += 1
                if kind in self.on:
                    self.on[kind](self, payload)
                self.say_idle()
        except (EOFError, OSError):
            pass

    def _handle(self, kind: bytes, payload: bytes) -> None:
        if kind == b"W":
            _, self.number, self.now, _ = struct.unpack("<IIqq", payload)
            if self._joins:
                self.raw.send(frame(b"J"))
        elif kind == b"T":
            (until,) = struct.unpack("<q", payload[:8])
            while self.wakes and self.wakes[0][0] <= until:
                at, does = self.wakes.pop(0)
                self.now = max(at, self.now)
                does(self)
            self.now = until

    def kinds(self) -> str:
        """Return the kinds of the frames that arrived, in order."""
        return "".join(kind.decode() for _, kind, _ in self.seen)

    def end(self) -> None:
        self.raw.socket.shutdown(socket.SHUT_RDWR)
        self._thread.join(20)
        self.raw.close()
