"""The hub knows when a program is idle, advances its time, and forwards what its processes send."""

from __future__ import annotations

import itertools
import stat
import time
from collections.abc import Callable
from pathlib import Path

import pytest
from stand_in import BEST_EFFORT, RELIABLE, TRANSIENT_LOCAL, VOLATILE, Process, Raw, idle, welcomed

from rmw_lockstep.hub import BEGIN, PUBLISHER, SUBSCRIPTION, Hub, QosPolicies
from rmw_lockstep.hub.link import ProcessLink

MS = 1_000_000
STRING = "std_msgs/msg/String"

Make = Callable[..., Process]


def talker(process: Process, period: int, topic: str = "/said") -> Process:
    """Let a process create a publisher after joining, and publish a count at each period of its time (ns)."""
    made: list[int] = []

    def say(process: Process) -> None:
        made.append(0)
        process.publish(made[0], str(len(made) - 1).encode())
        process.wake(process.now + period, say)

    def begin(process: Process, payload: bytes) -> None:
        made.append(process.make(f"talker_{process.pid}", (PUBLISHER, topic, {}))[1])
        process.wake(process.now + period, say)

    process.on[b"g"] = begin
    return process


def listener(process: Process, topic: str = "/said", **qos: int) -> Process:
    """Let a process create a subscription after joining."""
    process.on[b"g"] = lambda process, _: process.make("listener", (SUBSCRIPTION, topic, qos))
    return process


def test_its_socket_is_open_to_all_users_who_know_of_it(folder: Path, hub: Hub) -> None:
    assert stat.S_IMODE(folder.stat().st_mode) == 0o711, "to be entered, and not to be listed"
    assert stat.S_IMODE(hub.path.stat().st_mode) == 0o666


def test_a_path_that_is_too_long_for_a_socket_is_refused(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="too long for a socket"):
        Hub(tmp_path / ("long" * 30))


def test_a_process_that_joins_gets_the_graph(hub: Hub, process: Make) -> None:
    hub.node("runner").publisher("/clock", "rosgraph_msgs/msg/Clock", QosPolicies())
    one = process().start()
    hub.wait_until_idle()
    assert one.kinds() == "WNEg"
    assert one.now == BEGIN


def test_who_does_not_join_hears_nothing_of_the_graph(hub: Hub, process: Make) -> None:
    one = process(joins=False).start()
    hub.node("runner").publisher("/clock", "rosgraph_msgs/msg/Clock", QosPolicies())
    hub.wait_until_idle()
    assert one.kinds() == "W"


def test_the_graph_shows_what_the_program_has(hub: Hub, process: Make) -> None:
    listener(process()).start()
    hub.wait_until_idle()
    assert [node.full_name for node in hub.graph.program_nodes()] == ["/listener"]
    [endpoint] = hub.graph.program_endpoints()
    assert (endpoint.name, endpoint.type, endpoint.qos.reliability_name) == ("/said", STRING, "reliable")


def test_what_a_process_had_is_gone_with_it(hub: Hub, process: Make) -> None:
    one, other = listener(process(1)).start(), process(2).start()
    hub.wait_until_idle()
    one.end()
    while hub.graph.nodes:
        hub.pause()
    hub.wait_until_idle()
    assert other.kinds().replace("?", "") in ("WgNEen", "WNEgen")


def test_a_message_is_recorded_with_its_moment(hub: Hub, process: Make) -> None:
    said = hub.node("runner").subscription("/said", STRING, QosPolicies())
    clock = hub.node("runner").publisher("/clock", "rosgraph_msgs/msg/Clock", QosPolicies())
    talker(process(), 10 * MS).start()
    hub.wait_until_idle()
    for step in range(1, 4):
        hub.advance(BEGIN + step * 20 * MS)
        clock.publish(b"time")
        hub.wait_until_idle()
    assert [(heard.now - BEGIN) // MS for heard in said.heard] == [10, 20, 30, 40, 50, 60]
    assert [heard.stage for heard in said.heard] == [0, 0, 1, 1, 2, 2], "how much it had got by then"
    assert [heard.cdr for heard in said.heard] == [b"1", b"2", b"3", b"4", b"5", b"6"]
    assert {heard.node for heard in said.heard} == {"/talker_1"}


def test_for_one_process_a_step_is_sent_in_one_piece(hub: Hub, process: Make) -> None:
    runner = hub.node("runner")
    clock, topic = (runner.publisher(name, STRING, QosPolicies()) for name in ("/clock", "/said"))
    one = listener(process()).start()
    hub.wait_until_idle()
    before = len(one.seen)
    hub.advance(BEGIN + MS)
    clock.publish(b"time")
    hub.barrier()
    topic.publish(b"hello")
    assert len(one.seen) == before, "nothing has been sent yet"
    hub.wait_until_idle()
    assert one.kinds()[before:] == "TD|D"


def test_two_processes_talk_and_neither_gets_ahead_of_the_other(hub: Hub, process: Make) -> None:
    times: dict[int, list[int]] = {1: [], 2: []}
    for number in times:
        one = talker(process(number), (10 if number == 1 else 15) * MS, f"/of_{number}")
        begin = one.on[b"g"]

        def begin_both(process: Process, payload: bytes, begin: Callable[[Process, bytes], object] = begin) -> None:
            begin(process, payload)
            process.make("listener", (SUBSCRIPTION, f"/of_{3 - process.pid}", {}))

        one.on[b"g"] = begin_both
        one.on[b"D"] = lambda process, payload: times[process.pid].append((process.now - BEGIN) // MS)
        one.start()
        hub.pause()
    hub.wait_until_idle()
    hub.advance(BEGIN + 60 * MS)
    assert times == {1: [15, 30, 45, 60], 2: [10, 20, 30, 40, 50, 60]}


def test_the_hub_does_not_wait_before_it_has_asked(hub: Hub, process: Make, monkeypatch: pytest.MonkeyPatch) -> None:
    """Otherwise it would wait 20 ms each time for nothing, as no process has got the question yet."""
    queued: list[ProcessLink] = []

    def take(hub: Hub, take: Callable[[Hub], None] = Hub._take) -> None:
        queued.extend(link for link in hub.links if link._queued)
        take(hub)

    monkeypatch.setattr(Hub, "_take", take)
    for number in (1, 2):
        talker(process(number), 10 * MS, f"/of_{number}").start()
        hub.pause()
    hub.advance(BEGIN + 60 * MS)
    assert queued == []


def test_the_hub_knows_when_the_program_wakes_next(hub: Hub, process: Make) -> None:
    one = talker(process(), 10 * MS).start()
    hub.wait_until_idle()
    assert hub.next == BEGIN + 10 * MS
    one.wakes.clear()
    hub.advance(BEGIN + 20 * MS)
    hub.wait_until_idle()
    assert hub.next is None


@pytest.mark.parametrize("offers", [RELIABLE, BEST_EFFORT])
@pytest.mark.parametrize("asks", [RELIABLE, BEST_EFFORT])
def test_only_ends_that_fit_exchange_messages(hub: Hub, process: Make, offers: int, asks: int) -> None:
    publisher = hub.node("runner").publisher("/said", STRING, QosPolicies(reliability=offers))
    one = listener(process(), reliability=asks).start()
    hub.wait_until_idle()
    publisher.publish(b"hello")
    hub.wait_until_idle()
    fits = not (offers == BEST_EFFORT and asks == RELIABLE)
    assert bool(publisher.matched) == fits
    assert ("D" in one.kinds()) == fits


@pytest.mark.parametrize("durability", [TRANSIENT_LOCAL, VOLATILE])
def test_a_late_subscription_gets_what_was_published_before_if_it_asks_for_it(
    hub: Hub, process: Make, durability: int
) -> None:
    publisher = hub.node("runner").publisher("/said", STRING, QosPolicies(durability=TRANSIENT_LOCAL, depth=2))
    for text in (b"one", b"two", b"three"):
        publisher.publish(text)
    one = listener(process(), durability=durability).start()
    hub.wait_until_idle()
    got = [payload[24:] for _, kind, payload in one.seen if kind == b"D"]
    assert got == ([b"two", b"three"] if durability == TRANSIENT_LOCAL else [])


def test_what_a_process_replays_goes_to_the_subscription_it_is_meant_for(hub: Hub, process: Make) -> None:
    runner = hub.node("runner")
    first, second = (runner.subscription("/said", STRING, QosPolicies()) for _ in range(2))
    one = process()

    def begin(process: Process, payload: bytes) -> None:
        _, publisher = process.make("talker", (PUBLISHER, "/said", {}))
        process.publish(publisher, b"again", only=second.endpoint.id)

    one.on[b"g"] = begin
    one.start()
    hub.wait_until_idle()
    assert not first.heard
    assert [heard.cdr for heard in second.heard] == [b"again"]


def test_a_child_that_is_named_has_to_be_connected_and_idle_too(hub: Hub, process: Make) -> None:
    parent = process(7)
    parent.children = (8,)
    parent.start()
    for _ in range(4):
        hub.pause()
    assert not hub.is_idle(), "a child is named that is not there"
    child = process(8).start()
    hub.wait_until_idle()
    assert child.kinds()
    parent.children = ()
    child.end()
    while len(hub.links) > 1:
        hub.pause()
    hub.wait_until_idle()
    assert parent.kinds().endswith("?"), "it has been asked again"


def test_a_sleep_by_the_kernels_clock_is_waited_for(hub: Hub, raw: Raw) -> None:
    welcomed(raw, hub).send(idle(1, flags=2))
    hub.pause()
    assert not hub.is_idle()
    raw.send(idle(1))
    hub.wait_until_idle()


def test_what_was_said_before_the_end_is_heard_however_slow_the_hub_is(
    hub: Hub, process: Make, monkeypatch: pytest.MonkeyPatch
) -> None:
    said = hub.node("runner").subscription("/said", STRING, QosPolicies())
    one = talker(process(), MS).start()
    hub.wait_until_idle()
    one.publish(one.number << 32 | 2, b"last words")
    one.end()
    hours = itertools.count(step=3600.0)
    monkeypatch.setattr(time, "monotonic", lambda: next(hours))
    hub.drain()
    assert [heard.cdr for heard in said.heard] == [b"last words"]
    assert not hub.links
