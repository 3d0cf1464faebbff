"""Simulated time and the computer's time fit exactly; messages of one moment have one order; a frozen host is found."""

from __future__ import annotations

import time
from collections.abc import Sequence
from types import SimpleNamespace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from grader.runner.budget import Allowance, Budget, HostStalled
from grader.runner.grader_side import BETWEEN_MESSAGES, Clocks
from grader.runner.message_order import (
    Place,
    in_canonical_order,
    place_of,
    requests_in_order,
    unordered_sources,
    without_order,
)
from grader.scenario.scenario import SECOND, START
from rmw_lockstep.hub import DeliveredMessage, EndpointFrame, Moment, PendingRequest, QosPolicies

BEGAN = 1_000 * SECOND + 7


@given(st.lists(st.integers(0, 10**10), min_size=1, max_size=20), st.sampled_from(["apart", "simulated"]))
def test_each_message_comes_exactly_at_its_simulated_time(steps: list[int], computer_time: str) -> None:
    clocks = Clocks(computer_time)  # type: ignore[arg-type]
    clocks.set(START, BEGAN, 1)
    at, before = START, 0
    for stage, step in enumerate(steps, start=2):
        at += step
        now = clocks.computer(at)
        clocks.set(at, now, stage, message=True)
        assert clocks.simulated(now, stage) == at
        assert now - before >= BETWEEN_MESSAGES
        before = now


def test_simulated_time_goes_at_80_percent_of_the_computers_and_never_beyond_the_next_message() -> None:
    clocks = Clocks("apart")
    assert clocks.simulated(BEGAN, 0) == 0, "before it begins there is none"
    clocks.set(START, BEGAN, 1)
    assert clocks.computer(START + SECOND) == BEGAN + 5 * SECOND // 4
    assert clocks.simulated(BEGAN + SECOND, 1) == START + 4 * SECOND // 5
    clocks.set(START + 10, BEGAN + BETWEEN_MESSAGES, 2, message=True)
    assert clocks.simulated(BEGAN + BETWEEN_MESSAGES // 2, 1) == START + 10


MAIN, OTHER = True, False


def heard(cdr: bytes, main: bool, now: int = 5, process: int = 1, node: str = "/node") -> tuple[int, DeliveredMessage]:
    publisher = EndpointFrame(process << 32 | 1, 0, process << 32 | 2, "/out", "a/msg/B", bytes(33), QosPolicies())
    return 0, DeliveredMessage(publisher, node, now, 1, 1, main, cdr)


def order(entries: Sequence[tuple[int, DeliveredMessage]]) -> list[bytes]:
    return [one.cdr for _, one in in_canonical_order(entries, unordered_sources(entries))]


def unordered(*entries: tuple[int, DeliveredMessage]) -> set[Place]:
    return without_order(entries, unordered_sources(entries))


def test_what_the_main_thread_publishes_stays_in_its_order() -> None:
    assert order([heard(b"b", MAIN), heard(b"a", MAIN), heard(b"c", MAIN)]) == [b"b", b"a", b"c"]


def test_what_other_threads_publish_at_one_moment_is_in_the_order_of_its_bytes() -> None:
    first = [heard(b"b", OTHER), heard(b"a", OTHER), heard(b"c", OTHER, now=4)]
    assert order(first) == order([first[1], first[0], first[2]]) == [b"c", b"a", b"b"]


def test_whatever_another_thread_than_the_main_one_publishes_has_no_order() -> None:
    assert unordered_sources([heard(b"b", MAIN), heard(b"a", MAIN)]) == set()
    # Of a pool, one thread may have got all there was to do. In another run it would have been two.
    assert unordered_sources([heard(b"b", OTHER), heard(b"a", OTHER)]) == {(0, "/node")}
    assert unordered_sources([heard(b"b", MAIN, node="/a"), heard(b"a", OTHER, node="/b")]) == {(0, "/b")}


def test_only_messages_of_one_moment_can_be_without_an_order() -> None:
    assert unordered(heard(b"a", OTHER), heard(b"b", OTHER, now=9)) == set()
    first = [heard(b"a", OTHER), heard(b"b", OTHER), heard(b"c", OTHER, now=9)]
    assert unordered(*first) == {place_of(0, first[0][1])}


def asked(cdr: bytes, main: bool, now: int = 5, process: int = 1, node: str = "/node") -> PendingRequest:
    client = EndpointFrame(process << 32 | 1, 0, process << 32 | 2, "/add", "a/srv/B", bytes(33), QosPolicies())
    return PendingRequest(client, node, 1, Moment(now, 1, 1, main), cdr)


def requests(*entries: PendingRequest, start: int = 0) -> list[bytes]:
    return [one.cdr for one in requests_in_order(entries, lambda cdr: cdr[start:])]


def test_requests_of_the_main_thread_are_answered_as_they_were_sent_and_others_by_their_bytes() -> None:
    assert requests(asked(b"b", MAIN), asked(b"a", MAIN)) == [b"b", b"a"]
    first = [asked(b"b", OTHER), asked(b"a", OTHER), asked(b"c", OTHER, now=4)]
    assert requests(*first) == requests(*first[::-1]) == [b"c", b"a", b"b"]
    assert requests(asked(b"1b", OTHER), asked(b"2a", OTHER), start=1) == [b"2a", b"1b"], "the id of a goal is chance"


def test_requests_of_two_processes_in_the_name_of_one_node_are_answered_by_their_bytes() -> None:
    first = [asked(b"b", MAIN, process=1), asked(b"a", MAIN, process=2)]
    assert requests(*first) == requests(*first[::-1]) == [b"a", b"b"]


def test_of_several_processes_the_node_decides() -> None:
    first = [heard(b"1", MAIN, process=2, node="/b"), heard(b"2", MAIN, process=1, node="/a")]
    assert order(first) == order(first[::-1]) == [b"2", b"1"]


def test_a_machine_that_was_frozen_is_found_to_have_been(monkeypatch: pytest.MonkeyPatch) -> None:
    now = [100.0]
    monkeypatch.setattr(time, "monotonic", lambda: now[0])
    student = SimpleNamespace(pid=0, poll=lambda: None, cpu_seconds=lambda: 0.0, at_limit=lambda: False)
    budget = Budget(student, tuple, Allowance("busy", "blocked"))
    for _ in range(50):
        now[0] += 0.02
        budget.look()
    budget.check_the_host()
    for _ in range(40):
        now[0] += 0.1  # the grader gets a CPU too rarely to know who waits for whom
        budget.look()
    now[0] += 300
    budget.look()
    assert budget.blocked < 1.1, "a pause of the grader's own is nobody's"
    with pytest.raises(HostStalled):
        budget.check_the_host()
