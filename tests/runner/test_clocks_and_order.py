"""Simulated time and the computer's time fit exactly; messages of one moment have one order; a frozen host is found."""

from __future__ import annotations

import time
from collections.abc import Sequence
from types import SimpleNamespace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from grader.runner.budget import Allowance, Budget, HostStalled
from grader.runner.ends import BETWEEN_MESSAGES, Clocks
from grader.runner.recorder import Moment, by_several_threads, in_canonical_order, without_order
from grader.scenario.scenario import SECOND, START
from rmw_lockstep.hub import EndPoint, Heard, Qos

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


def heard(cdr: bytes, thread: int, now: int = 5, process: int = 1, node: str = "/node") -> tuple[int, Heard]:
    publisher = EndPoint(process << 32 | 1, 0, process << 32 | 2, "/out", "a/msg/B", bytes(33), Qos())
    return 0, Heard(publisher, node, now, 1, 1, thread, cdr)


def order(entries: Sequence[tuple[int, Heard]]) -> list[bytes]:
    return [one.cdr for _, one in in_canonical_order(entries, by_several_threads(entries))]


def unordered(*entries: tuple[int, Heard]) -> set[Moment]:
    return without_order(entries, by_several_threads(entries))


def test_what_one_thread_publishes_stays_in_its_order() -> None:
    assert order([heard(b"b", 1), heard(b"a", 1), heard(b"c", 1)]) == [b"b", b"a", b"c"]


def test_what_several_threads_publish_at_one_moment_is_in_the_order_of_its_bytes() -> None:
    first = [heard(b"b", 1), heard(b"a", 2), heard(b"c", 1, now=4)]
    assert order(first) == order([first[1], first[0], first[2]]) == [b"c", b"a", b"b"]


def test_what_only_one_thread_of_a_node_publishes_has_an_order() -> None:
    assert by_several_threads([heard(b"b", 1), heard(b"a", 1)]) == set()
    assert by_several_threads([heard(b"b", 1), heard(b"a", 2, now=9)]) == {(0, "/node")}
    assert by_several_threads([heard(b"b", 1, node="/a"), heard(b"a", 2, process=2, node="/b")]) == set()


def test_only_messages_of_one_moment_can_be_without_an_order() -> None:
    assert unordered(heard(b"a", 1), heard(b"b", 2, now=9)) == set()
    assert len(unordered(heard(b"a", 1), heard(b"b", 2), heard(b"c", 1, now=9))) == 1


def test_of_several_processes_the_node_decides() -> None:
    first = [heard(b"1", 1, process=2, node="/b"), heard(b"2", 1, process=1, node="/a")]
    assert order(first) == order(first[::-1]) == [b"2", b"1"]


def test_a_machine_that_was_frozen_is_found_to_have_been(monkeypatch: pytest.MonkeyPatch) -> None:
    now = [100.0]
    monkeypatch.setattr(time, "monotonic", lambda: now[0])
    student = SimpleNamespace(poll=lambda: None, cpu_seconds=lambda: 0.0, at_limit=lambda: False)
    budget = Budget(student, tuple, Allowance("busy", "blocked"))  # type: ignore[arg-type]
    for _ in range(50):
        now[0] += 0.02
        budget.look()
    budget.check_the_host()
    now[0] += 300
    budget.look()
    assert budget.blocked < 1.1, "a pause of the grader's own is nobody's"
    with pytest.raises(HostStalled):
        budget.check_the_host()
