"""Whatever a program sends, the hub continues or says why not: it never hangs, and never accepts impossible reports."""

from __future__ import annotations

import array
import contextlib
import os
import socket
import struct
from collections.abc import Callable
from pathlib import Path

import pytest
from stand_in import Process, Raw, Waits, busy, data, endpoint, frame, hello, idle, node, response, violation, welcomed

from rmw_lockstep.hub import BEGIN, PUBLISHER, SUBSCRIPTION, Hub, HubLimits, QosPolicies, Violation

NODE, PUB, SUB = 1 << 32 | 1, 1 << 32 | 2, 1 << 32 | 3
STRING = "std_msgs/msg/String"

Make = Callable[..., Process]


@pytest.fixture
def limits() -> HubLimits:
    return HubLimits(message_bytes=10_000, data_bytes=50_000, messages=1_000, frames=20_000, nodes=10, connections=8)


def reason(hub: Hub) -> tuple[str, str]:
    """Return why the hub stopped."""
    found = violation(hub)
    return found.reason, found.text


def begin(raw: Raw, hub: Hub) -> Raw:
    """Start a process that has a node with a publisher and a subscription, and is idle."""
    welcomed(raw, hub).send(
        node(NODE), endpoint(PUB, PUBLISHER, NODE), endpoint(SUB, SUBSCRIPTION, NODE), idle(1, BEGIN)
    )
    hub.wait_until_idle()
    return raw


@pytest.mark.parametrize(
    "sent",
    [
        struct.pack("<I", 0),
        struct.pack("<I", 2**32 - 1) + b"X",
        struct.pack("<IB", 100_000, ord("N")),
        frame(b"X"),
        frame(b"T", struct.pack("<qB", 2**62, 0)),
        frame(b"I", b"short"),
        frame(b"I", struct.pack("<QqqIIIBQH", 1, 0, 0, 1, 0, 0, 0, 0, 500)),
        frame(b"N", struct.pack("<QI", 1 << 32 | 9, 2**31)),
        hello(),
        node(2 << 32 | 1, "of_another"),
        node(NODE, "twice"),
        node(1, "of_the_hub"),
        node(1 << 32 | 9, "nul\0"),
        node(1 << 32 | 9, b"\xff\xfe"),
        node(1 << 32 | 9, ""),
        node(1 << 32 | 9, "9th"),
        node(1 << 32 | 9, "n" * 300),
        node(1 << 32 | 9, "node", "no/slash"),
        frame(b"N", struct.pack("<Q", 1 << 32 | 9) + b"\1\0\0\0a\1\0\0\0/more"),
        endpoint(1 << 32 | 9, 7, NODE),
        endpoint(1 << 32 | 9, PUBLISHER, 1 << 32 | 77),
        endpoint(2 << 32 | 9, PUBLISHER, NODE),
        endpoint(PUB, PUBLISHER, NODE),
        endpoint(1 << 32 | 9, PUBLISHER, NODE, "/a b"),
        endpoint(1 << 32 | 9, PUBLISHER, NODE, "/nul\0"),
        endpoint(1 << 32 | 9, PUBLISHER, NODE, "/t", "no type"),
        frame(b"E", b"\0" * 20),
        frame(b"e", struct.pack("<Q", 1)),
        frame(b"n", struct.pack("<Q", 77)),
        frame(b"n", b""),
        data(SUB),
        data(1 << 32 | 77),
        data(7 << 32 | 1),
        frame(b"D", b"\0" * 10),
        frame(b"Q", struct.pack("<QqqQqI", PUB, 1, 0, 1, 0, 1)),
        response(5, 1),
        frame(b"R", b""),
        frame(b"L", struct.pack("<Q", SUB)),
    ],
)  # fmt: skip
def test_a_frame_that_breaks_a_rule_ends_it(hub: Hub, raw: Raw, sent: bytes) -> None:
    begin(raw, hub)
    busy(hub)
    raw.send(sent)
    assert reason(hub)[0] == "protocol"


@pytest.mark.parametrize("sent", [frame(b"J"), idle(0), hello(version=1), frame(b"H", b"\0")])
def test_the_first_frame_has_to_be_a_hello_of_this_version(hub: Hub, raw: Raw, sent: bytes) -> None:
    raw.send(sent)
    assert reason(hub)[0] == "protocol"


def test_a_message_that_is_too_long_is_reported_by_its_length_before_it_is_read(hub: Hub, raw: Raw) -> None:
    begin(raw, hub)
    busy(hub)
    raw.send(struct.pack("<IB", 500_000_000, ord("D")))
    assert reason(hub) == ("message", "a message of 500,000,000 bytes")


def flood(frames: list[bytes], process: Make, hub: Hub) -> tuple[str, str]:
    """Return what happens to a process that creates a node and a publisher, and then sends this."""
    one = process()
    one.on[b"W"] = lambda process, _: process.raw.send(node(NODE), endpoint(PUB, PUBLISHER, NODE), *frames)
    one.start()
    return reason(hub)


@pytest.mark.parametrize(
    ("frames", "why"),
    [
        ([data(PUB, b"x" * 9_000)] * 6, ("bytes", "54,000 bytes in all messages together; the limit is 50,000")),
        ([data(PUB)] * 1_001, ("messages", "1,001 messages; the limit is 1,000")),
        ([idle(0)] * 20_001, ("frames", "20,001 frames; the limit is 20,000")),
        ([node(1 << 32 | n) for n in range(10, 40)], ("nodes", "10 nodes; the limit is 10")),
    ],
    ids=["bytes", "messages", "frames", "nodes"],
)
def test_a_flood_ends_where_a_limit_is_reached(
    hub: Hub, process: Make, frames: list[bytes], why: tuple[str, str]
) -> None:
    found, text = flood(frames, process, hub)
    assert found == why[0]
    assert why[0] == "nodes" or text == why[1]


def test_ten_thousand_endpoints_are_too_many(hub: Hub, process: Make) -> None:
    ends = [endpoint(1 << 32 | n, PUBLISHER, NODE, f"/topic_{n}") for n in range(10, 10_010)]
    assert flood(ends, process, hub)[0] == "endpoints"


def test_connections_are_counted(hub: Hub) -> None:
    connections = [Raw(hub.path) for _ in range(8)]
    hub.pause()
    connections.append(Raw(hub.path))
    assert reason(hub) == ("connections", "9 processes; the limit is 8")
    for connection in connections:
        connection.close()


def test_for_a_process_that_never_reads_not_everything_is_kept(folder: Path) -> None:
    with Hub(folder, HubLimits(unread_bytes=1_000_000), Waits()) as hub:
        topic = hub.node("runner").publisher("/topic", STRING, QosPolicies())
        raw = Raw(hub.path)
        welcomed(raw, hub).send(frame(b"J"), node(NODE), endpoint(SUB, SUBSCRIPTION, NODE))
        hub.pause()
        for _ in range(19):
            topic.publish(b"x" * 50_000)
        with pytest.raises(Violation) as caught:
            topic.publish(b"x" * 50_000)
        assert caught.value.reason == "unread"
        raw.close()


def joined(hub: Hub, count: int) -> list[Raw]:
    """Return connections of processes that have joined; none of them is idle."""
    raws = [Raw(hub.path) for _ in range(count)]
    for number, raw in enumerate(raws):
        raw.send(hello(number + 1))
    while len(hub.links) < count or not all(link.began for link in hub.links):
        hub.pause()
    for raw in raws:
        assert raw.read()[0] == b"W"
        raw.send(frame(b"J"))
    return raws


def test_frames_that_wait_for_processes_that_are_never_idle_count_as_unread(folder: Path) -> None:
    with Hub(folder, HubLimits(unread_bytes=1_000_000), Waits()) as hub:
        raws = joined(hub, 8)
        flood = [node(NODE)]
        for number in range(1_000):
            flood += [endpoint(PUB + number, PUBLISHER, NODE), frame(b"e", struct.pack("<Q", PUB + number))]
        raws[0].send(*flood)
        assert reason(hub)[0] == "unread"
        for raw in raws:
            raw.close()


def test_what_was_read_no_longer_counts_as_unread(folder: Path) -> None:
    with Hub(folder, HubLimits(unread_bytes=100_000, data_bytes=50_000_000), Waits()) as hub:
        topic = hub.node("runner").publisher("/topic", STRING, QosPolicies())
        one = Process(hub.path)
        one.on[b"W"] = lambda process, _: process.make("node", (SUBSCRIPTION, "/topic", {}))
        one.start()
        hub.wait_until_idle()
        for _ in range(40):
            topic.publish(b"x" * 50_000)
            hub.wait_until_idle()
        one.end()


def test_messages_that_stay_inside_count_although_none_is_reported(hub: Hub, raw: Raw) -> None:
    begin(raw, hub)
    busy(hub)
    raw.send(*[frame(b"K", struct.pack("<QIQqI", PUB, 0, 1, 0, 1))] * 2_000)
    assert reason(hub)[0] == "own messages"


def test_thousands_of_children_are_not_kept(hub: Hub, raw: Raw) -> None:
    begin(raw, hub)
    busy(hub)
    raw.send(idle(1, BEGIN, children=tuple(range(2_000))))
    assert reason(hub)[0] == "protocol"


def test_what_reading_costs_the_hub_is_counted(folder: Path) -> None:
    with Hub(folder, HubLimits(cpu_s=0), Waits()) as hub:
        raw = Raw(hub.path)
        raw.send(hello())
        assert reason(hub)[0] == "cpu"
        raw.close()


@pytest.mark.parametrize("handled", [0, 2, 2**63])
def test_an_idle_that_names_another_number_of_frames_is_not_believed(hub: Hub, raw: Raw, handled: int) -> None:
    welcomed(raw, hub).send(idle(handled))
    for _ in range(3):
        hub.pause()
    assert not hub.is_idle()


def test_an_idle_that_is_followed_by_another_frame_is_not_believed(hub: Hub, raw: Raw) -> None:
    begin(raw, hub)
    raw.send(idle(1), data(PUB))
    hub.pause()
    assert not hub.is_idle()


def test_times_neither_go_back_nor_beyond_what_was_granted(hub: Hub, raw: Raw) -> None:
    said = hub.node("runner").subscription("/topic", STRING, QosPolicies())
    begin(raw, hub)
    hub.advance(BEGIN + 1_000)
    raw.send(*(data(PUB, handled=9, now=BEGIN + after) for after in (500, 100, 2**40, -(2**40))))
    raw.send(idle(2, BEGIN + 1_000))
    hub.wait_until_idle()
    assert [heard.now - BEGIN for heard in said.heard] == [500, 500, 1_000, 1_000]
    assert all(heard.handled <= 2 for heard in said.heard)


def test_a_process_whose_time_does_not_go_on_is_found_out(hub: Hub, process: Make) -> None:
    one = process()

    def stay(process: Process, payload: bytes) -> None:
        process.now = BEGIN

    one.on[b"T"] = stay
    one.start()
    hub.wait_until_idle()
    hub.advance(BEGIN + 1_000)
    assert reason(hub)[0] == "protocol"


def test_a_wake_up_that_never_comes_nearer_does_not_stop_time(hub: Hub, process: Make) -> None:
    for number in (1, 2):
        one = process(number)
        one.wakes = [(0, lambda process: process.wake(0, lambda _: None))]
        one.start()
        hub.pause()
    hub.wait_until_idle()
    hub.advance(BEGIN + 50)
    assert all(link.now == BEGIN + 50 for link in hub.links)


def test_a_socket_that_is_handed_on_and_used_by_two_is_one_process(hub: Hub, raw: Raw) -> None:
    begin(raw, hub)
    twin = socket.socket(fileno=os.dup(raw.socket.fileno()))
    busy(hub)
    raw.send(frame(b"?")[:3])
    twin.sendall(idle(1))
    assert reason(hub)[0] in ("protocol", "frames"), "what the two send is mixed up"
    twin.close()


def test_descriptors_that_are_sent_along_do_not_stay_open_here(hub: Hub, raw: Raw) -> None:
    begin(raw, hub)
    before = len(os.listdir("/proc/self/fd"))  # noqa: PTH208
    passed = array.array("i", [raw.socket.fileno()] * 3)
    busy(hub)
    raw.socket.sendmsg([idle(1, BEGIN)], [(socket.SOL_SOCKET, socket.SCM_RIGHTS, passed)])
    hub.wait_until_idle()
    assert len(os.listdir("/proc/self/fd")) == before  # noqa: PTH208


def test_half_a_frame_and_nothing_more_is_waited_for_only_as_long_as_the_owner_likes(hub: Hub, raw: Raw) -> None:
    class Enough(Exception):
        pass

    def enough() -> None:
        raise Enough

    begin(raw, hub)
    busy(hub)
    raw.send(struct.pack("<IB", 1_000, ord("D")))
    hub.on_tick = enough
    with pytest.raises(Enough):
        hub.wait_until_idle()


def test_a_connection_that_is_closed_takes_what_it_had_along(hub: Hub, raw: Raw) -> None:
    begin(raw, hub)
    raw.close()
    while hub.links:
        hub.pause()
    assert not hub.graph.nodes
    assert not hub.graph.endpoints


def test_what_is_no_socket_is_refused_at_an_inherited_socket_and_counted(tmp_path: Path) -> None:
    with Hub(limits=HubLimits(all_connections=10)) as hub, socket.socket(fileno=os.dup(hub.add_program())) as inherited:
        (tmp_path / "file").touch()
        with (tmp_path / "file").open() as file:
            for _ in range(5):
                socket.send_fds(inherited, [b"+"], [file.fileno()])
                inherited.send(b"+")
        hub.pause()
        assert not hub.links
        inherited.send(b"+")
        assert reason(hub) == ("connections", "11 processes; the limit is 10")


def test_an_inherited_socket_gives_a_connection_to_each_process_that_asks() -> None:
    with Hub() as hub, contextlib.ExitStack() as connections:
        descriptor = hub.add_program()
        for number in (1, 2):
            asking, sent = socket.socketpair()
            with asking, sent, socket.socket(fileno=os.dup(descriptor)) as inherited:
                socket.send_fds(inherited, [b"+"], [sent.fileno()])
                while len(hub.links) < number:
                    hub.pause()
                _, (given,), _, _ = socket.recv_fds(asking, 1, 1)
            connection = connections.enter_context(socket.socket(fileno=given))
            connection.sendall(hello(number))
            while not hub.links[-1].hello:
                hub.pause()
        assert [(link.pid, link.pid_inside) for link in hub.links] == [(os.getpid(), 1), (os.getpid(), 2)]
