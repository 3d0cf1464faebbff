"""A hub between processes that run over rcl_python, like the page between its workers: over a Unix socket.

A process joins it when it starts with `over_hub` on PYTHONPATH and RCL_PYTHON_HUB naming the socket.
"""

from __future__ import annotations

import contextlib
import json
import os
import socket
import struct
import threading
import time
from collections import deque
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from rcl_python.graph import process_of
from rcl_python.link import Frame

HUB = "RCL_PYTHON_HUB"
_LENGTHS = struct.Struct("<II")


def _write(connection: socket.socket, head: bytes, data: bytes) -> None:
    connection.sendall(_LENGTHS.pack(len(head), len(data)) + head + data)


def _frames(connection: socket.socket) -> Iterator[tuple[bytes, bytes]]:
    """Yield the frames that arrive, until the other side is gone."""
    with contextlib.suppress(OSError), connection.makefile("rb") as stream:
        while len(lengths := stream.read(_LENGTHS.size)) == _LENGTHS.size:
            head, data = _LENGTHS.unpack(lengths)
            yield stream.read(head), stream.read(data)


class SocketLink:
    """The link of one process."""

    def __init__(self, address: str, identity: str) -> None:
        self.lock = threading.Condition(threading.RLock())
        self._arrived: deque[tuple[Frame, bytes]] = deque()
        self._socket = socket.socket(socket.AF_UNIX)
        self._socket.connect(address)
        _write(self._socket, identity.encode(), b"")
        threading.Thread(target=self._hear, daemon=True).start()

    def _hear(self) -> None:
        for head, data in _frames(self._socket):
            with self.lock:
                self._arrived.append((json.loads(head), data))
                self.lock.notify_all()

    def send(self, frame: Frame, data: bytes = b"") -> None:
        """Send a frame to the hub."""
        _write(self._socket, json.dumps(frame).encode(), bytes(data))

    def receive(self) -> Iterator[tuple[Frame, bytes]]:
        """Yield what has arrived."""
        while self._arrived:
            yield self._arrived.popleft()

    def wait(self, nanoseconds: int | None) -> None:
        """Wait for a frame, for another thread, or until the time is up."""
        if not self._arrived:
            self.lock.wait(None if nanoseconds is None else nanoseconds / 1e9)

    def breathe(self, looks: bool, news: bool) -> int:
        """Frames and signals come in by themselves."""
        return 0

    def steady(self) -> int:
        """The steady clock (ns)."""
        return time.monotonic_ns()

    def system(self) -> int:
        """The system clock (ns since the epoch)."""
        return time.time_ns()


class Hub:
    """Accepts processes, and forwards what they send: to the processes it names, or to all others."""

    def __init__(self, address: str) -> None:
        self._listener = socket.socket(socket.AF_UNIX)
        self._listener.bind(address)
        self._listener.listen(64)
        self._processes: dict[str, socket.socket] = {}
        self._lock = threading.Lock()
        threading.Thread(target=self._accept, daemon=True).start()

    def _accept(self) -> None:
        with contextlib.suppress(OSError):
            while True:
                connection, _ = self._listener.accept()
                threading.Thread(target=self._serve, args=(connection,), daemon=True).start()

    def _serve(self, connection: socket.socket) -> None:
        frames = _frames(connection)
        identity = next(frames, (b"", b""))[0].decode()
        with self._lock:
            self._processes[identity] = connection
        for head, data in frames:
            self._route(identity, head, data)
        with self._lock:
            del self._processes[identity]
        self._route(identity, json.dumps({"op": "bye", "from": identity}).encode(), b"")

    def _route(self, source: str, head: bytes, data: bytes) -> None:
        frame: dict[str, Any] = json.loads(head)
        wanted = {process_of(key) for key in frame["to"]} if frame.get("to") else None
        with self._lock:
            for identity, connection in self._processes.items():
                if identity != source and (wanted is None or identity in wanted):
                    with contextlib.suppress(OSError):
                        _write(connection, head, data)

    def close(self) -> None:
        """Stop accepting processes."""
        self._listener.close()


@contextmanager
def hub(folder: Path) -> Iterator[dict[str, str]]:
    """Run a hub; yield the environment in which processes join it."""
    address = os.fspath(folder / "hub")
    running = Hub(address)
    here = Path(__file__).resolve().parent
    paths = [here / "over_hub", here, *filter(None, os.environ.get("PYTHONPATH", "").split(os.pathsep))]
    try:
        yield {HUB: address, "PYTHONPATH": os.pathsep.join(map(str, paths))}
    finally:
        running.close()
