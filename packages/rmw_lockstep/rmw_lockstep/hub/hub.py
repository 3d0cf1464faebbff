"""The hub: every process of a program connects to it, and it alone decides what happens and when.

It listens on a socket in a folder, advances time and knows exactly when the whole program has nothing left to do.
It never waits for a process indefinitely: `on_tick` is called every 20 ms while it waits, and may raise.
"""

from __future__ import annotations

import select
import socket
import time
from collections.abc import Callable
from pathlib import Path

from rmw_lockstep.hub import frames
from rmw_lockstep.hub.endpoints import HubNode, PendingRequest
from rmw_lockstep.hub.graph import HubGraph
from rmw_lockstep.hub.limits import HubLimits, HubUsage, Violation
from rmw_lockstep.hub.link import ProcessLink
from rmw_lockstep.hub.listeners import InheritedSocket, Listener
from rmw_lockstep.hub.router import EPOCH, Router

SECOND = 1_000_000_000

#: The time on a process's clock when the first one connects (ns).
BEGIN = 1_000 * SECOND

#: The name of the socket in its folder.
SOCKET = "hub"

#: How often `on_tick` is called while the hub waits (s).
TICK_S = 0.02

#: A new process begins after this many ticks even if others are not idle.
WELCOME_TICKS = 10

#: How often a process may be granted time without its time advancing.
MOST_STANDSTILLS = 100


def _do_nothing() -> None:
    """The default callback."""


class Hub:
    """Use it as a context manager, from one thread.

    Programs connect by the socket at `path`, in a folder. Those that may make no connections inherit a socket instead:
    see `add_program`.

    `main` is the id of the program's first process, as this process sees it. Set it as soon as it is known: the program
    is never idle while that process is not connected. `mains` has those of further programs. `before_end` is called
    before the endpoints of a process are removed from the graph.
    """

    def __init__(
        self, folder: Path | None = None, limits: HubLimits | None = None, on_tick: Callable[[], None] = _do_nothing
    ) -> None:
        """Listen in `folder`, which other users of this machine may enter but not list; without one, nowhere yet.

        Raises ValueError if the path is too long for a socket, and OSError if no socket can be made.
        """
        self.main: int | None = None
        self.mains: set[int] = set()
        self.before_end: Callable[[], None] = _do_nothing
        self.on_tick = on_tick
        self._use = HubUsage(limits or HubLimits())
        self._until = self._instant = BEGIN
        self._standstills = 0
        self._awaited = False
        self._runs: dict[int, int] = {}
        self._due = 0.0
        self._ticks = 0
        self._router = Router(self._use, lambda: EPOCH + self._until)
        self._listen(folder)

    def _listen(self, folder: Path | None) -> None:
        """Make the sockets. A hub without processes, in a page, has none."""
        self._poll = select.poll()
        self._new = select.poll()
        self._listeners: list[Listener | InheritedSocket] = []
        if folder:
            self.path = folder / SOCKET
            self._add(Listener(self.path, self._use.limits.connections))

    def _add(self, listener: Listener | InheritedSocket) -> None:
        self._listeners.append(listener)
        for poll in (self._poll, self._new):
            poll.register(listener.socket, select.POLLIN)

    # --- for the owner of the hub

    def add_program(self) -> int:
        """Return a descriptor for one more program to inherit: its processes connect through it, and by nothing else.

        `ProcessLink.listener` counts these, after the folder's socket if there is one.
        """
        listener = InheritedSocket()
        self._add(listener)
        return listener.inherited

    def node(self, name: str, namespace: str = "/") -> HubNode:
        """Return a new node of the hub's own."""
        return HubNode(self._router, self._router.new_node(name, namespace))

    @property
    def graph(self) -> HubGraph:
        """The ROS graph."""
        return self._router.graph

    @property
    def links(self) -> list[ProcessLink]:
        """The processes that are connected."""
        return self._router.links

    @property
    def now(self) -> int:
        """The time that was granted most recently (ns)."""
        return self._until

    @property
    def unserved(self) -> list[PendingRequest]:
        """Requests of the program for which there was no server, in the order in which they arrived."""
        return self._router.unserved

    @property
    def published(self) -> int:
        """How many messages the hub has published: the number of the last one."""
        return self._router.published

    @property
    def next(self) -> int | None:
        """When the program will wake by itself (ns); None for never. Valid only when it is idle."""
        return min((link.next for link in self.links if link.next is not None), default=None)

    @property
    def in_ros(self) -> int:
        """How many of the program's threads wait in ROS 2. Valid only when it is idle."""
        return sum(link.idle.in_ros for link in self.links if link.idle)

    def advance(self, until: int) -> None:
        """Advance time to `until` (ns).

        With a single process, this is only queued, ahead of everything published later, until `wait_until_idle`. With
        several, time advances from one wake-up of any of them to the next, and this returns when it is `until`.
        """
        self._until = max(until, self._until)
        if self._is_alone():
            self._grant(self.links[0], self._until)
        else:
            self.wait_until_idle()

    def barrier(self) -> None:
        """Let what is published next be handled only when everything published before is finished."""
        if self._is_alone(idle=False):
            self.links[0].queue(frames.BARRIER)
        else:
            self.wait_until_idle()

    def wait_until_idle(self) -> None:
        """Send what is queued, and wait until the program has nothing left to do. Raises `Violation`."""
        while True:
            self._flush()
            if not self.is_idle():
                self._flush()  # including ASK, or the answers would never come
                self._take()
            elif not self._go_on():
                return

    def pause(self) -> None:
        """Send what is queued and take what arrives, for 20 ms at most, whether or not the program is idle."""
        self._flush()
        self._take()
        if self.is_idle():
            self._router.deliver()
        self._flush()

    def drain(self) -> None:
        """Take everything that processes sent before they ended. The program must be dead. Raises `Violation`.

        What the dead sent is there already. So this waits for nothing, and stops where there is nothing left to read,
        even if a connection has no end, because its other end is in a message that nobody has received.
        """
        self._accept()
        self._use.begin_taking()
        for link in tuple(self.links):
            while link in self.links and self._read(link, socket.MSG_DONTWAIT):
                pass
        self._use.look_at_cpu()

    def close(self) -> None:
        """Disconnect every process, and stop listening."""
        for link in self.links:
            link.close()
        self.links.clear()
        for listener in self._listeners:
            listener.close()

    def __enter__(self) -> Hub:
        return self

    def __exit__(self, *error: object) -> None:
        self.close()

    # --- time

    def _is_alone(self, idle: bool = True) -> bool:
        """Return whether there is, and always was, a single process, whose time may advance in one piece."""
        links = self.links
        if len(links) != 1 or self._use.connections != 1 or self._router.serves:
            return False
        return not idle or links[0].is_idle

    def _grant(self, link: ProcessLink, until: int) -> None:
        self._use.wake_up()
        link.granted = until
        link.queue(frames.to_time(until))

    def _go_on(self) -> bool:
        """Advance the idle program's time to the next wake-up of any process. Return False if it has reached `until`.

        No process gets ahead of the others: what one sends at its wake-up may reach another before that one wakes.
        """
        if self._reach_instant():
            return True
        if self._router.deliver():
            return True
        if all(link.now >= self._until for link in self.links):
            self._standstills = 0
            return False
        self._instant = min([self._until, *(link.next for link in self.links if link.next is not None)])
        return self._reach_instant()

    def _reach_instant(self) -> bool:
        """Advance the time of processes that are behind the current instant: first of all that do not wake then, after
        them that of the others, one after another. Return False when all are there.

        A process that is woken may end and so wake its parent, whose clock must show the same time by then.
        """
        behind = [link for link in self.links if link.now < self._instant]
        if not behind:
            return False
        resting = [link for link in behind if link.next is None or link.next > self._instant]
        for link in resting or [min(behind, key=lambda link: link.order)]:
            self._see_progress(link)
            self._grant(link, self._instant)
        return True

    def _see_progress(self, link: ProcessLink) -> None:
        """Raise `Violation` when a process's time does not advance."""
        self._standstills = self._standstills + 1 if link.granted == self._instant else 0
        if self._standstills > MOST_STANDSTILLS:
            raise Violation("protocol", "a process is granted time again and again, but its time does not advance")

    # --- connections

    def is_idle(self) -> bool:
        """Return whether the program has nothing left to do, according to everything that has arrived so far.

        That is so if every process is idle, including the children that they report.
        """
        links = self.links
        self._awaited = False
        if not links or not all(link.is_idle for link in links if link.began):
            return False
        if self._accept() or self._welcome():
            return False
        if not all(link.began for link in links):
            return False
        if self.main is not None and all(link.pid != self.main for link in links):
            return False
        if self.mains and self.mains - {link.pid for link in links}:
            return False
        self._awaited = bool(self._missing_children())
        return not self._awaited and self._is_confirmed()

    def _is_confirmed(self) -> bool:
        """Return whether each of several processes has reported twice to be idle, with no thread running in between.

        One may wake another in a way that the hub can't see, such as a pipe, after the other has reported to be idle.
        """
        if len(self.links) == 1:
            return True
        runs = {link.number: link.idle.runs for link in self.links if link.idle}
        if all(runs.values()) and runs == self._runs:
            return True
        self._runs = runs
        for link in self.links:
            link.queue(frames.ASK)
        return False

    def _missing_children(self) -> list[ProcessLink]:
        """Return the processes that report a child that is not connected: not yet, no longer, or never."""
        naming = [link for link in self.links if link.idle and link.idle.children]
        if not naming:
            return []
        here = {(link.listener, link.hello.pid) for link in self.links if link.hello}
        return [
            link
            for link in naming
            if link.idle and not here.issuperset((link.listener, child) for child in link.idle.children)
        ]

    def _accept(self) -> bool:
        """Accept connections at all sockets. Return whether there were any."""
        if not self._new.poll(0):
            return False
        accepted = [self._accept_from(number, listener) for number, listener in enumerate(self._listeners)]
        return any(accepted)

    def _accept_from(self, number: int, listener: Listener | InheritedSocket) -> bool:
        found = False
        while True:
            try:
                connection, pid = listener.accept()
            except BlockingIOError:
                return found
            except OSError:  # somebody sent what is no connection
                self._use.connection(len(self.links))
                continue
            found = True
            try:
                self._use.connection(len(self.links))
            except Violation:
                connection.close()
                raise
            link = ProcessLink(connection, self._use.connections, self._use, number, pid)
            link.wait_at_most(TICK_S)
            self.links.append(link)
            self._poll.register(connection, select.POLLIN)

    def _flush(self) -> None:
        for link in self.links:
            link.flush()

    def _welcome(self, early: bool = False) -> bool:
        """Start those that have sent HELLO, at the time of the others. Return whether there were any.

        A new process waits until the others are idle, as only then the time of each is known; `early`, it begins as
        soon as it is known when its parent forked it.
        """
        waiting = sorted((one for one in self.links if one.hello and not one.began), key=lambda one: one.order)
        waiting = [one for one in waiting if not (early and self._router.is_still_forking(one))]
        now = max((link.now for link in self.links if link.began), default=self._until)
        for link in waiting:
            self._router.welcome(link, now)
        return bool(waiting)

    def _take(self) -> None:
        """Wait at most 20 ms for something to arrive, and take it. Raises `Violation`, and what `on_tick` raises."""
        links = self.links
        self._use.begin_taking()
        if len(links) == 1 and not self._awaited and not links[0].unsent:
            self._read(links[0], 0)
        else:
            self._take_from_any()
        self._use.look_at_cpu()
        now = time.monotonic()
        if now >= self._due:
            self._due = now + TICK_S
            self._ticks += 1
            self._accept()
            if not self._ticks % WELCOME_TICKS:
                self._welcome(early=True)  # another process may compute until the new one has done something
            for link in self._missing_children():
                link.queue(frames.ASK)
            self.on_tick()

    def _take_from_any(self) -> None:
        by_number = {link.socket.fileno(): link for link in self.links}
        for number, link in by_number.items():
            self._poll.modify(number, select.POLLIN | (select.POLLOUT if link.unsent else 0))
        for number, events in self._poll.poll(TICK_S * 1000):
            if number not in by_number:
                self._accept()
            elif events & ~select.POLLOUT:
                self._read(by_number[number], socket.MSG_DONTWAIT)

    def _read(self, link: ProcessLink, flags: int) -> bool:
        """Return whether there was anything to read, be it the connection's end."""
        try:
            alive = link.read(self._router.handle, flags)
        except BlockingIOError:
            return False
        if not alive:
            self._end(link)
        return True

    def _end(self, link: ProcessLink) -> None:
        self.before_end()
        self._poll.unregister(link.socket)
        link.close()
        self._router.forget(link)
        for other in self.links:
            if link.listener != other.listener:
                continue
            if link.hello and other.last_idle and link.hello.pid in other.last_idle.children:
                other.queue(frames.ASK)
