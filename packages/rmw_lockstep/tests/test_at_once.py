"""How much a program may send at one moment of its clock, whoever gets it: without a limit, it could go on for ever."""

from __future__ import annotations

import struct
from collections.abc import Callable

import pytest
from programs import Watch
from stand_in import Process, data, endpoint, frame, node, violation

from rmw_lockstep.hub import BEGIN, CLIENT, PUBLISHER, SUBSCRIPTION, Hub, HubLimits, QosPolicies

NODE, PUB, SUB, ASKS, OTHER = (1 << 32 | number for number in range(1, 6))
MS = 1_000_000
MOST = 200

ENDS = {
    PUB: endpoint(PUB, PUBLISHER, NODE),
    SUB: endpoint(SUB, SUBSCRIPTION, NODE),
    ASKS: endpoint(ASKS, CLIENT, NODE, "/service", "std_srvs/srv/Trigger"),
    OTHER: endpoint(OTHER, PUBLISHER, NODE, "/other"),
}

Make = Callable[..., Process]


@pytest.fixture
def limits() -> HubLimits:
    return HubLimits(at_once=MOST)


def kept(sender: int, count: int, now: int = BEGIN) -> bytes:
    return frame(b"K", struct.pack("<QIQqI", sender, count, 1, now, 1))


def request(number: int) -> bytes:
    return frame(b"Q", struct.pack("<QqqQqI", ASKS, number, 0, 1, BEGIN, 1))


def sender(process: Make, ends: list[int], *frames: bytes) -> Process:
    """Start a process that creates a node with these ends, and then sends this."""
    one = process()
    one.on[b"W"] = lambda process, _: process.raw.send(node(NODE), *(ENDS[end] for end in ends), *frames)
    return one.start()


def why(hub: Hub) -> tuple[str, str, float]:
    """Return why the hub stopped."""
    found = violation(hub)
    return found.reason, found.text, found.found


@pytest.mark.parametrize(
    ("ends", "frames", "expected"),
    [
        ([PUB], [data(PUB, now=BEGIN)] * (MOST + 1), ("at once", "/topic", MOST + 1)),
        ([PUB], [kept(PUB, 100)] * 3, ("at once", "/topic", 300)),
        ([PUB, SUB], [kept(PUB, 100)] * 3, ("own messages", "/topic", 300)),
        ([PUB, SUB], [kept(PUB, 100), *[data(PUB, now=BEGIN)] * (MOST - 99)], ("own messages", "/topic", MOST + 1)),
        ([ASKS], [kept(ASKS, 100)] * 3, ("at once", "/service", 300)),
        ([ASKS], [request(n) for n in range(MOST + 1)], ("at once", "/service", MOST + 1)),
        ([PUB, SUB, OTHER], [data(OTHER, now=BEGIN), *[kept(PUB, 100)] * 2], ("own messages", "/topic", MOST + 1)),
        ([PUB, OTHER], [kept(OTHER, 100), kept(PUB, 101)], ("at once", "/other and /topic", MOST + 1)),
        ([PUB], [kept(PUB, 2**32 - 1)], ("at once", "/topic", 2**32 - 1)),
    ],
    ids=[
        "heard by all", "kept", "its own", "heard and its own", "calls itself", "calls others",
        "names what it is busy with", "names all that it is busy with", "a lie",
    ],
)  # fmt: skip
def test_too_much_at_one_moment_ends_the_program(
    hub: Hub, process: Make, ends: list[int], frames: list[bytes], expected: tuple[str, str, int]
) -> None:
    sender(process, ends, *frames)
    assert why(hub) == expected


def test_of_many_topics_with_a_little_each_the_first_three_are_named(hub: Hub, process: Make) -> None:
    numbers = range(1 << 32 | 10, 1 << 32 | 40)
    ends = [endpoint(number, PUBLISHER, NODE, f"/topic_{number & 0xFF}") for number in numbers]
    sender(process, [], *ends, *[data(number, now=BEGIN) for number in numbers for _ in range(7)])
    assert why(hub) == ("at once", "/topic_10 and /topic_11 and /topic_12", MOST + 1)


def test_a_new_publisher_for_each_message_is_named_by_its_topic(hub: Hub, process: Make) -> None:
    numbers = range(1 << 32 | 10, 1 << 32 | 10 + MOST + 1)
    sender(process, [SUB], *[endpoint(n, PUBLISHER, NODE) + data(n, now=BEGIN) for n in numbers])
    assert why(hub) == ("own messages", "/topic", MOST + 1)


def test_another_process_that_listens_is_the_program_too(hub: Hub, process: Make) -> None:
    other = process(2)
    other.on[b"g"] = lambda process, _: process.make("other", (SUBSCRIPTION, "/topic", {}))
    other.start()
    hub.wait_until_idle()
    one = process(1)
    one.on[b"g"] = lambda process, _: _flood(process)
    one.start()
    assert why(hub) == ("own messages", "/topic", MOST + 1)


def _flood(process: Process) -> None:
    _, publisher = process.make("one", (PUBLISHER, "/topic", {}))
    for _ in range(MOST + 1):
        process.publish(publisher, b"")


@pytest.mark.parametrize(
    ("ends", "sent"),
    [([PUB], kept(SUB, 1)), ([PUB, SUB], kept(SUB, 1)), ([PUB], kept(7 << 32 | 1, 1)), ([PUB], frame(b"K", b"short"))],
    ids=["not announced", "a subscription", "of another", "too short"],
)
def test_what_is_kept_is_reported_by_who_sent_it(hub: Hub, process: Make, ends: list[int], sent: bytes) -> None:
    sender(process, ends, sent)
    assert why(hub)[0] == "protocol"


def test_each_moment_and_each_message_of_the_hub_begins_anew(hub: Hub, process: Make) -> None:
    asks = hub.node("runner").publisher("/asks", "std_msgs/msg/String", QosPolicies())
    one = process()
    ends: tuple[tuple[int, str, dict[str, int]], ...] = ((PUBLISHER, "/said", {}), (SUBSCRIPTION, "/asks", {}))

    def burst(process: Process, _: bytes = b"") -> None:
        for _number in range(MOST):
            process.publish(1 << 32 | 2, b"")

    one.on[b"g"] = lambda process, _: process.make("one", *ends)
    one.on[b"D"] = burst
    for at in (1, 2, 3):
        one.wake(BEGIN + at * MS, burst)
    one.start()
    hub.wait_until_idle()
    hub.advance(BEGIN + 5 * MS)
    hub.wait_until_idle()
    for _ in range(3):
        asks.publish(b"")
        hub.wait_until_idle()


def test_who_sends_messages_is_not_taken_to_wait_for_a_time(watch: Watch) -> None:
    """140,000 readings of the clock, without a message, are taken for a loop that waits for a time to come."""
    watch.start("""
        kept = node.create_publisher(String, '/kept', 10)
        say(time.monotonic())
        for i in range(1400):
            for n in range(100): time.monotonic()
            kept.publish(String())
        say(time.monotonic())
    """)
    watch.go_on(1.0)
    first, last = watch.said()
    assert first == last
