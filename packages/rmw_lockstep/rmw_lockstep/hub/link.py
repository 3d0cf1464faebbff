"""The hub's end of the connection to one process: incoming and outgoing frames, and what the process has reported."""

from __future__ import annotations

import contextlib
import socket
import struct
from bisect import bisect_right
from collections.abc import Callable

from rmw_lockstep.hub.frames import KERNEL_SLEEP, HelloFrame, IdleFrame
from rmw_lockstep.hub.limits import HubUsage, Violation

#: How much is read at once (bytes). A process that never stops sending must not block the hub.
PIECE = 65_536

#: A frame contains more than the message in it.
_FRAME_BESIDE_MESSAGE = 1_024

#: What Python itself needs to keep a frame: an object, and its place in a list (bytes).
FRAME_OVERHEAD = 100

_CREDENTIALS = struct.Struct("iII")
_WAIT = struct.Struct("ll")


def peer(connection: socket.socket) -> int:
    """Return the id of the process at the other end of a Unix socket (SO_PEERCRED, unix(7))."""
    credentials = connection.getsockopt(socket.SOL_SOCKET, socket.SO_PEERCRED, _CREDENTIALS.size)
    return int(_CREDENTIALS.unpack(credentials)[0])


class ProcessLink:
    """One process. Its identities begin with `number`; `pid` is its process id as the hub sees it.

    `listener` is the number of the hub's socket that it connected to, and so identifies its program. `pid` is by
    default that of the other end.
    """

    def __init__(
        self, sock: socket.socket, number: int, use: HubUsage, listener: int = 0, pid: int | None = None
    ) -> None:
        self.socket, self.number, self.listener = sock, number, listener
        self.pid = peer(sock) if pid is None else pid
        self.hello: HelloFrame | None = None
        self.began = self.joined = False
        self.sent = 0
        self.handled = 0
        self.now = self.granted = 0
        self.idle: IdleFrame | None = None
        self.last_idle: IdleFrame | None = None
        self.nodes: set[int] = set()
        self.endpoints: set[int] = set()
        self.requests: set[tuple[int, int]] = set()
        self._use = use
        self._queued: list[bytes] = []
        self._unsent = bytearray()
        self._queued_bytes = self._counted = 0
        self._rest = b""
        self._marks_at: list[int] = []
        self._marks: list[int] = []
        self._first_mark = 0

    def begin(self, now: int, published: int) -> None:
        """Begin at the time `now` (ns), when the hub has published that many messages."""
        self.began = True
        self.now = self.granted = now
        self._first_mark = published

    @property
    def pid_inside(self) -> int:
        """The process id as the process itself sees it. These ids are in the order in which processes were started."""
        return self.hello.pid if self.hello else 0

    @property
    def parent_inside(self) -> int:
        """The parent's process id as the process itself sees it."""
        return self.hello.parent if self.hello else 0

    def is_main(self, thread: int) -> bool:
        """Return whether this is the process's main thread, whose number equals the process id (gettid(2))."""
        return thread == self.pid_inside

    @property
    def order(self) -> tuple[int, int]:
        """The sort key of a process, the same in every run: by program, then in the order of their start."""
        return self.listener, self.pid_inside

    def wait_at_most(self, seconds: float) -> None:
        """Limit how long `read` waits. A blocking read with a time-out is one system call, `settimeout` needs two."""
        whole = int(seconds)
        waiting = _WAIT.pack(whole, int((seconds - whole) * 1e6))
        self.socket.setsockopt(socket.SOL_SOCKET, socket.SO_RCVTIMEO, waiting)

    # --- out

    def queue(self, frame: bytes) -> None:
        """Send a frame with the next `flush`. Raises `Violation` if too much is kept for the program."""
        self._queued.append(frame)
        self.sent += 1
        self.idle = None
        self._queued_bytes += len(frame) + FRAME_OVERHEAD
        self._count()

    def _count(self) -> None:
        """Count how much more, or less, is kept of this connection than before."""
        kept = self._queued_bytes + len(self._unsent) + len(self._rest)
        more, self._counted = kept - self._counted, kept
        self._use.unread(more)

    @property
    def unsent(self) -> int:
        """How many bytes the process has left unread, in addition to what the kernel buffers."""
        return len(self._unsent)

    def flush(self) -> None:
        """Send what is queued, as far as possible without waiting."""
        if self._queued:
            self._unsent += b"".join(self._queued)
            self._queued.clear()
            self._queued_bytes = 0
        if not self._unsent:
            return
        with contextlib.suppress(BlockingIOError, BrokenPipeError, ConnectionResetError):  # `read` notices its end
            done = self.socket.send(self._unsent, socket.MSG_DONTWAIT | socket.MSG_NOSIGNAL)
            del self._unsent[:done]
        self._count()

    def mark(self, ordinal: int) -> None:
        """Note that publication number `ordinal` of the hub is handled as soon as the current queue is."""
        self._marks_at.append(self.sent)
        self._marks.append(ordinal)

    def stage(self, handled: int) -> int:
        """Return the number of the hub's last publication before `handled` frames had been handled."""
        found = bisect_right(self._marks_at, handled)
        return self._marks[found - 1] if found else self._first_mark

    # --- in

    def read(self, handle: Callable[[ProcessLink, int, bytes], None], flags: int = 0) -> bool:
        """Read once and handle the whole frames in it. Return False at the end of the connection.

        Raises BlockingIOError when there is nothing to read, and `Violation`.
        """
        try:
            data = self.socket.recv(PIECE, flags)
        except (ConnectionResetError, BrokenPipeError):
            return False
        if not data:
            return False
        self._take(self._rest + data if self._rest else data, handle)
        return True

    def _take(self, data: bytes, handle: Callable[[ProcessLink, int, bytes], None]) -> None:
        at, end, use = 0, len(data), self._use
        longest = use.limits.message_bytes + _FRAME_BESIDE_MESSAGE
        while end - at >= 4:
            length = int.from_bytes(data[at : at + 4], "little")
            if not 0 < length <= longest:
                raise self._bad_length(length, data[at + 4 : at + 5])
            after = at + 4 + length
            if after > end:
                break
            use.frame()
            self.idle = None
            handle(self, data[at + 4], data[at + 5 : after])
            at = after
        self._rest = data[at:]
        self._count()

    def _bad_length(self, length: int, kind: bytes) -> Violation:
        limit = self._use.limits.message_bytes
        if length and kind in (b"D", b"Q", b"R"):
            return Violation("message", f"a message of {length:,} bytes", found=length, limit=limit)
        return Violation("protocol", f"a frame of {length:,} bytes")

    def moment(self, handled: int, now: int) -> tuple[int, int]:
        """Return a reported moment, clamped: neither number may decrease or exceed what was allowed."""
        self.handled = min(max(handled, self.handled), self.sent)
        self.now = min(max(now, self.now), self.granted)
        return self.handled, self.now

    def believe(self, idle: IdleFrame) -> None:
        """Note that the process reports that it is idle."""
        _, now = self.moment(idle.handled, idle.now)
        self.idle = self.last_idle = idle._replace(now=now)

    @property
    def is_idle(self) -> bool:
        """Whether it is idle, apart from its children."""
        idle = self.idle
        return idle is not None and idle.handled == self.sent and not idle.flags & KERNEL_SLEEP

    @property
    def next(self) -> int | None:
        """When it will wake by itself (ns); None for never. Valid only when it is idle."""
        if self.idle is None or self.idle.next < 0:
            return None
        return max(self.idle.next, self.now + 1)

    def close(self) -> None:
        """Close the connection."""
        self._queued_bytes, self._unsent, self._rest = 0, bytearray(), b""
        self._count()
        self.socket.close()
