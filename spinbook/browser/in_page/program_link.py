"""The program's side of the connection to a page's hub: translates rcl_python's frames to those of PROTOCOL.md.

The hub grants the time. The program waits in one place only; when it waits there, it is idle, and it is the hub's turn.
"""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterator
from dataclasses import fields
from typing import SupportsFloat

from rcl_python import participant
from rcl_python import qos as quality
from rcl_python.context import interrupt
from rcl_python.graph import CLIENT, PUBLISHER, SERVICE, SUBSCRIPTION, EndpointInfo
from rcl_python.link import Frame
from rmw_lockstep.hub import EPOCH, frames
from rmw_lockstep.qos import AUTOMATIC, INFINITE, KEEP_LAST, QosPolicies
from rmw_lockstep.type_hash import NO_HASH
from spinbook.browser.in_page import program_imports, threads
from spinbook.browser.in_page.busy_threads import BusyThreads
from spinbook.browser.in_page.hub import PROGRAM, PageHub, RunFinished, Turns
from spinbook.browser.in_page.local_messages import REPORTED, LocalMessages
from spinbook.browser.in_page.scheduler import Scheduler

_HEADER = frames.HEADER.size
_KINDS = (PUBLISHER, SUBSCRIPTION, SERVICE, CLIENT)
_BARRIER, _TIME_KIND = ord("|"), ord("T")


class ProgramLink:
    """The link of a program that communicates only with a page's hub."""

    def __init__(self, hub: PageHub, turns: Turns) -> None:
        self.lock = threads.NotifyingCondition(threading.RLock())
        self._hub, self._turns, self._connection = hub, turns, hub.connection
        self._now = hub.now
        self._activity = self._number = 0
        self._busy = BusyThreads()
        self._ends: dict[str, str] = {}
        self._kept = LocalMessages()
        self.scheduler = Scheduler(self)

    # --- out

    def send(self, frame: Frame, data: bytes = b"") -> None:
        """Hand a frame to the hub, which takes it at once."""
        if self._turns.is_done:
            return  # for example, garbage collection destroys a publisher after the end
        if not self._in_order(frame):
            return
        thread = self.scheduler.number()
        self._activity += 1
        try:
            self._handle(*_encoded(frame, data, (self._connection.handled, self._now, thread)))
        except Exception as fault:
            # The hub's thread raises it; the program ends here.
            self._turns.fault = fault
            self._turns.let_hub_go_on()
            self.deliver_signals()

    def keep(self, sender: EndpointInfo) -> None:
        """Count a message that stays inside the program; report to the hub when there are too many."""
        self._activity += 1
        if self._kept.count(sender, self._now):
            self.send({"op": "kept", "from": sender.gid, "n": REPORTED})

    def _handle(self, kind: str, payload: bytes) -> None:
        """Let the hub handle a frame, which may be a request to one of the grader's own servers."""
        program_imports.turn_to_page()
        try:
            self._hub.router.handle(self._connection, ord(kind), payload)
        finally:
            program_imports.turn_to_program()

    def _in_order(self, frame: Frame) -> bool:
        """Return whether to send a frame to the hub; send those first that must come before it.

        Garbage collection has no order, but the hub expects endpoints to leave before their node, and only once.
        """
        op = frame["op"]
        if op == "endpoint":
            self._ends[frame["gid"]] = frame["node"]
        elif op == "endpoint_gone":
            return self._ends.pop(frame["gid"], None) is not None
        elif op == "node_gone":
            for gid in [gid for gid, node in self._ends.items() if node == frame["key"]]:
                self.send({"op": "endpoint_gone", "gid": gid})
        return True

    # --- in

    def receive(self) -> Iterator[tuple[Frame, bytes]]:
        """Yield the frames that have arrived, up to the next advance of time."""
        queued = self._connection.queued
        while queued and queued[0][4] not in (_BARRIER, _TIME_KIND):
            frame = queued.popleft()
            self._connection.handled += 1
            self._number += 1
            self._activity += 1
            decoded = _decoded(frame[4], frame[_HEADER:], self._number)
            if decoded:
                yield decoded

    # --- time

    def wait(self, nanoseconds: int | None) -> None:
        """Wait for a frame, for another thread, or for this long."""
        held = self.lock._release_save()  # type: ignore[attr-defined]
        try:
            self.scheduler.wait(nanoseconds, in_ros=True)
            self._busy.note_wait(self.scheduler.number(), self._now)
        finally:
            self.lock._acquire_restore(held)  # type: ignore[attr-defined]

    def sleep(self, seconds: SupportsFloat) -> None:
        """Sleep as time.sleep does, in the hub's time."""
        until = self._now + round(float(seconds) * 1e9)
        while self._now < until:
            self.scheduler.wait(until - self._now, in_ros=False)
            participant.current().pump()

    def wait_for_hub(self, until: int | None, in_ros: int) -> None:
        """Wait until a frame or a signal arrives, or until the time `until` (ns); `in_ros` threads wait in ROS."""
        while not self._goes_on(until) and not self._turns.is_done and not self._turns.signal:
            self._connection.report_idle(self._now, until, in_ros)
            self._turns.let_hub_go_on()

    def deliver_signals(self) -> None:
        """End, or handle a signal, if the hub has requested it. Call this in the main thread. Raises `RunFinished`."""
        if self._turns.has_ended:
            return  # the clean-up after the program may still wait
        if self._turns.is_over:
            raise RunFinished
        if self._turns.signal:
            name, self._turns.signal = self._turns.signal, ""
            interrupt(name)

    @property
    def has_request(self) -> bool:
        """Whether the main thread has a request to handle."""
        return self._turns.is_over or bool(self._turns.signal)

    @property
    def has_frames(self) -> bool:
        """Whether frames have arrived that were not received yet."""
        return bool(self._connection.queued)

    def _goes_on(self, until: int | None) -> bool:
        """Advance time as far as it was granted. Return whether there is a frame to receive, or `until` is reached."""
        queued = self._connection.queued
        while queued:
            if queued[0][4] == _TIME_KIND:
                granted, _ = frames.TIME.unpack(queued[0][_HEADER:])
                if until is not None and until <= granted:
                    self._now = max(self._now, until)
                    return True
                self._now = max(self._now, granted)
            elif queued[0][4] != _BARRIER:
                return True
            queued.popleft()
            self._connection.handled += 1
        return until is not None and until <= self._now

    def breathe(self, looks: bool, news: bool) -> int:
        """Return how long a thread is to sleep before it continues (ns): 0, unless it is busy (see busy_threads.py)."""
        thread = self.scheduler.number()
        if news:
            self._busy.note_news(thread)
            return 0
        return self._busy.sleep_ns(thread, looks, self._activity, self.scheduler.waits[thread], self._now)

    def steady(self) -> int:
        """Return the hub's time (ns)."""
        return self._now

    def system(self) -> int:
        """Return the hub's calendar time (ns since the epoch)."""
        return EPOCH + self._now

    def run(self, main: Callable[[], None]) -> None:
        """Run the program to its end, or until its run is over."""
        try:
            self._turns.wait_for_first()
            if not self._turns.is_over:
                main()
        except RunFinished:
            pass
        finally:
            self._turns.end()


# --- frames


def _encoded(frame: Frame, data: bytes, moment: tuple[int, int, int]) -> tuple[str, bytes]:
    """Return kind and payload of a frame for the hub. `moment` has the handled frames, the time, and the thread."""
    op = frame["op"]
    if op == "hello":
        return "J", b""
    if op == "node":
        return "N", frames.to_node(frames.NodeFrame(_id(frame["key"]), frame["name"], frame["namespace"]))[_HEADER:]
    if op == "endpoint":
        return "E", frames.to_endpoint(_endpoint(frame))[_HEADER:]
    if op == "node_gone":
        return "n", frames.to_gone(b"n", _id(frame["key"]))[_HEADER:]
    if op == "endpoint_gone":
        return "e", frames.to_gone(b"e", _id(frame["gid"]))[_HEADER:]
    if op == "message":
        only = _id(frame["to"][0]) if len(frame["to"]) == 1 else 0
        return "D", frames.DATA.pack(_id(frame["from"]), only, frame["sent"], *moment) + data
    if op == "kept":
        return "K", frames.KEPT.pack(_id(frame["from"]), frame["n"], *moment)
    if op == "request":
        return "Q", frames.CALL.pack(_id(frame["from"]), frame["n"], frame["sent"], *moment) + data
    return "R", frames.CALL.pack(_id(frame["to"][0]), frame["n"], frame["sent"], *moment) + data


def _id(key: str) -> int:
    process, _, number = key.rpartition(".")
    return int(process) << 32 | int(number)


def _key(number: int) -> str:
    return f"{number >> 32}.{number & 0xFFFFFFFF}"


#: What a profile means that does not say it.
_UNSAID = {"history": KEEP_LAST, "liveliness": AUTOMATIC, "deadline": INFINITE, "lifespan": INFINITE, "lease": INFINITE}


def _endpoint(frame: Frame) -> frames.EndpointFrame:
    names = [policy.name for policy in fields(QosPolicies)]
    qos = QosPolicies(**{name: frame["qos"][name] or _UNSAID.get(name, 0) for name in names})
    gid, kind, node = _id(frame["gid"]), _KINDS.index(frame["kind"]), _id(frame["node"])
    return frames.EndpointFrame(gid, kind, node, frame["topic"], frame["type"], NO_HASH, qos)


def _decoded(kind: int, payload: bytes, number: int) -> tuple[Frame, bytes] | None:
    """Return the frame for rcl_python; None if it does not need this one."""
    decode = _DECODERS.get(chr(kind))
    return decode(payload, number) if decode else None


def _node(payload: bytes, number: int) -> tuple[Frame, bytes]:
    node = frames.node(payload)
    plain = {"key": _key(node.id), "name": node.name, "namespace": node.namespace, "domain": 0, "enclave": "/"}
    return {"op": "node", **plain}, b""


def _new_endpoint(payload: bytes, number: int) -> tuple[Frame, bytes]:
    end = frames.endpoint(payload)
    profile = quality.Profile(**vars(end.qos))
    names = {"gid": _key(end.id), "node": _key(end.node), "topic": end.name, "type": end.type}
    return {"op": "endpoint", **names, "kind": _KINDS[end.kind], "qos": vars(profile), "domain": 0}, b""


def _gone(op: str, name: str) -> Callable[[bytes, int], tuple[Frame, bytes]]:
    return lambda payload, number: ({"op": op, name: _key(frames.identity(payload))}, b"")


def _message(payload: bytes, number: int) -> tuple[Frame, bytes]:
    publisher, only, sent = frames.OUT_DATA.unpack_from(payload)
    source = _key(publisher)
    to = [_key(only)] if only else _readers(source)
    return {"op": "message", "from": source, "to": to, "sent": sent, "n": number}, payload[frames.OUT_DATA.size :]


def _readers(source: str) -> list[str]:
    return [gid for gid, mine in participant.current().local.items() if source in mine.matched]


def _request(payload: bytes, number: int) -> tuple[Frame, bytes]:
    server, client, asked, sent = frames.OUT_REQUEST.unpack_from(payload)
    frame = {"op": "request", "from": _key(client), "to": [_key(server)], "sent": sent, "n": asked}
    return frame, payload[frames.OUT_REQUEST.size :]


def _response(payload: bytes, number: int) -> tuple[Frame, bytes]:
    client, asked, sent = frames.OUT_RESPONSE.unpack_from(payload)
    frame = {"op": "response", "from": "", "to": [_key(client)], "sent": sent, "n": asked}
    return frame, payload[frames.OUT_RESPONSE.size :]


_DECODERS: dict[str, Callable[[bytes, int], tuple[Frame, bytes]]] = {
    "N": _node,
    "E": _new_endpoint,
    "n": _gone("node_gone", "key"),
    "e": _gone("endpoint_gone", "gid"),
    "D": _message,
    "Q": _request,
    "R": _response,
}


def join(hub: PageHub, turns: Turns) -> ProgramLink:
    """Connect this interpreter's rcl_python to the hub."""
    link = ProgramLink(hub, turns)
    participant.use(link, str(PROGRAM)).on_kept = link.keep
    return link
