"""What a tick of the clock means, and which requests are refused."""

from __future__ import annotations

import math

import pytest

from ros_in_python.turtlesim.events import TICK_NS
from ros_in_python.turtlesim.node import Pacing
from ros_in_python.turtlesim.world import TurtleWorld


def test_a_place_that_is_not_finite_is_refused_by_the_world() -> None:
    assert "not finite" in str(TurtleWorld().spawn(math.inf, 0.0, 0.0))


def test_each_firing_of_the_timer_is_one_tick_however_late() -> None:
    pacing = Pacing()
    assert [pacing.due(now, simulated=False) for now in (5, 500_000_000)] == [[5], [500_000_000]]


def test_a_simulated_clock_ticks_for_every_16_ms_it_has_moved_on() -> None:
    pacing = Pacing()
    assert pacing.due(0, simulated=True) == [0]
    assert pacing.due(10_000_000, simulated=True) == []
    assert pacing.due(100_000_000, simulated=True) == [n * TICK_NS for n in range(1, 7)]
    assert pacing.due(112_000_000, simulated=True) == [7 * TICK_NS]


@pytest.mark.parametrize("moved_to", [-5, 10**18])
def test_a_simulated_clock_that_is_set_is_no_time_passed(moved_to: int) -> None:
    pacing = Pacing()
    pacing.due(0, simulated=True)
    assert pacing.due(moved_to, simulated=True) == [moved_to]
    assert pacing.due(moved_to + TICK_NS, simulated=True) == [moved_to + TICK_NS]
