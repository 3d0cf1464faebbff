"""Requests in turtlesim's own messages reach the world, and its reports fill them."""

from __future__ import annotations

import pytest
from turtlesim.msg import Color, Pose
from turtlesim.srv import SetPen, Spawn, TeleportAbsolute, TeleportRelative

from ros_in_python.turtlesim import interface
from ros_in_python.turtlesim.events import TICK_NS, ColorReport, Pen, PoseReport
from ros_in_python.turtlesim.node import Pacing
from ros_in_python.turtlesim.world import TurtleWorld


@pytest.fixture
def world() -> TurtleWorld:
    """A world with turtle1 in the middle, past its first tick."""
    world = TurtleWorld()
    world.start()
    world.tick(0)
    return world


def test_a_pose_message_is_filled_completely() -> None:
    pose = interface.fill_pose(Pose(), PoseReport("turtle1", 1.0, 2.0, 3.0, 4.0, 5.0))
    assert pose == Pose(x=1.0, y=2.0, theta=3.0, linear_velocity=4.0, angular_velocity=5.0)


def test_a_color_message_is_filled_completely() -> None:
    assert interface.fill_color(Color(), ColorReport("turtle1", 1, 2, 3)) == Color(r=1, g=2, b=3)


def test_service_requests_ask_for_what_their_fields_say(world: TurtleWorld) -> None:
    interface.spawn(world, Spawn.Request(x=1.0, y=2.0, theta=0.5, name="bob"))
    interface.set_pen(world, "bob", SetPen.Request(r=1, g=2, b=3, width=4, off=0))
    interface.teleport_absolute(world, "turtle1", TeleportAbsolute.Request(x=3.0, y=4.0, theta=0.0))
    interface.teleport_relative(world, "turtle1", TeleportRelative.Request(linear=1.0, angular=0.0))
    poses = {event.turtle: event for event in world.tick(TICK_NS) if isinstance(event, PoseReport)}
    assert (poses["bob"].x, poses["bob"].y, poses["bob"].theta) == pytest.approx((1.0, 2.0, 0.5), abs=1e-6)
    assert world.turtles["bob"].pen == Pen(1, 2, 3, 4)
    assert (poses["turtle1"].x, poses["turtle1"].y) == pytest.approx((4.0, 4.0), abs=1e-6)


def test_a_place_that_is_not_finite_is_refused_by_the_world(world: TurtleWorld) -> None:
    request = Spawn.Request(x=float("inf"))
    assert "not finite" in str(interface.spawn(world, request))


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
