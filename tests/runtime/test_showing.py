"""For how long a cell shows a process: counted from its first line, or from when it joined ROS."""

from __future__ import annotations

from dataclasses import dataclass

from spinbook.kernel.showing import Bound, Countdown


@dataclass
class Machine:
    """A clock that a test sets, and whether the process has joined ROS."""

    now: float = 0.0
    joined: bool = False

    def countdown(self, seconds: float) -> Countdown:
        return Countdown(Bound(seconds), lambda: self.joined, lambda: self.now)


def test_the_seconds_count_from_the_first_line_however_late_it_comes() -> None:
    machine = Machine()
    countdown = machine.countdown(3.0)
    for now, printed, over in ((9.0, False, False), (10.0, True, False), (12.9, True, False), (13.0, True, True)):
        machine.now = now
        assert countdown.is_over(printed) is over


def test_a_silent_node_is_shown_from_when_it_joined_for_at_least_as_long_as_it_took_to_start() -> None:
    for joined_at, end in ((1.0, 4.0), (8.0, 16.0)):
        machine = Machine()
        countdown = machine.countdown(3.0)
        assert not countdown.is_over(False)
        machine.now, machine.joined = joined_at, True
        assert not countdown.is_over(False)
        machine.now = end - 0.1
        assert not countdown.is_over(False)
        machine.now = end
        assert countdown.is_over(False)
        assert countdown.silent_s == end - joined_at


def test_a_program_that_neither_prints_nor_joins_does_not_hold_the_cell_for_ever() -> None:
    machine = Machine()
    countdown = machine.countdown(3.0)
    assert not countdown.is_over(False)
    machine.now = 60.0
    assert countdown.is_over(False)
