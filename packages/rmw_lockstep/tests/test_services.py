"""Requests and responses are delivered: from the hub to a process and back, and the other way round."""

from __future__ import annotations

import struct
from collections.abc import Callable

from stand_in import Process, endpoint, frame, node, response

from rmw_lockstep.hub import CLIENT, SERVER, Hub

TRIGGER = "std_srvs/srv/Trigger"

Make = Callable[..., Process]


def request(client: int, number: int, cdr: bytes) -> bytes:
    return frame(b"Q", struct.pack("<QqqQqI", client, number, 0, 1, 0, 1) + cdr)


def echo(process: Process, payload: bytes) -> None:
    """Answer a request with its own content."""
    _, client, number, _ = struct.unpack("<QQqq", payload[:32])
    process.raw.send(response(client, number, payload[32:]))


def serving(process: Process) -> Process:
    def begin(process: Process, payload: bytes) -> None:
        number = process.identity()
        process.raw.send(node_and_end(number, process.identity(), SERVER))

    process.on.update({b"g": begin, b"Q": echo})
    return process


def node_and_end(number: int, end: int, kind: int) -> bytes:
    return node(number, f"node_{number >> 32}") + endpoint(end, kind, number, "/trigger", TRIGGER)


def test_the_hub_calls_a_process(hub: Hub, process: Make) -> None:
    client = hub.node("runner").client("/trigger", TRIGGER)
    assert client.call(b"nobody serves it yet") is None
    serving(process()).start()
    hub.wait_until_idle()
    number = client.call(b"ping")
    hub.wait_until_idle()
    assert number is not None
    assert client.answers == {number: b"ping"}


def test_a_process_calls_the_hub(hub: Hub, process: Make) -> None:
    hub.node("runner").server("/trigger", TRIGGER, lambda asked: asked * 2)
    got: list[bytes] = []

    def begin(process: Process, payload: bytes) -> None:
        process.raw.send(node_and_end(process.identity(), process.identity(), CLIENT))
        process.raw.send(request(process.number << 32 | 2, 5, b"ping"))

    one = process()
    one.on = {b"g": begin, b"R": lambda _, payload: got.append(payload[24:])}
    one.start()
    hub.wait_until_idle()
    assert got == [b"pingping"]


def test_one_process_calls_another(hub: Hub, process: Make) -> None:
    serving(process(1)).start()
    hub.wait_until_idle()
    got: list[bytes] = []

    def begin(process: Process, payload: bytes) -> None:
        process.raw.send(node_and_end(process.identity(), process.identity(), CLIENT))
        process.raw.send(request(process.number << 32 | 2, 9, b"ping"))

    two = process(2)
    two.on = {b"g": begin, b"R": lambda _, payload: got.append(payload[24:])}
    two.start()
    hub.wait_until_idle()
    assert got == [b"ping"]
