"""Requests reach the world alike, be they turtlesim's own messages or what stands in for them."""

from __future__ import annotations

from dataclasses import dataclass

import pytest

from spinbook.turtlesim import fields
from spinbook.turtlesim.events import ColorReport, PoseReport
from spinbook.turtlesim.geometry import TICK_NS
from spinbook.turtlesim.pacing import Pacing
from spinbook.turtlesim.pen import Pen
from spinbook.turtlesim.requests import SetPenRequest, SpawnRequest, read_request
from spinbook.turtlesim.world import World


# turtlesim's definitions: a message has these fields and no others.
@dataclass(slots=True)
class Pose:
    """turtlesim/msg/Pose."""

    x: float = 0.0
    y: float = 0.0
    theta: float = 0.0
    linear_velocity: float = 0.0
    angular_velocity: float = 0.0


@dataclass(slots=True)
class Color:
    """turtlesim/msg/Color."""

    r: int = 0
    g: int = 0
    b: int = 0


@dataclass(slots=True)
class Spawn:
    """The request of turtlesim/srv/Spawn."""

    x: float
    y: float
    theta: float
    name: str


@dataclass(slots=True)
class SetPen:
    """The request of turtlesim/srv/SetPen."""

    r: int
    g: int
    b: int
    width: int
    off: int


@dataclass(slots=True)
class TeleportAbsolute:
    """The request of turtlesim/srv/TeleportAbsolute."""

    x: float
    y: float
    theta: float


@dataclass(slots=True)
class TeleportRelative:
    """The request of turtlesim/srv/TeleportRelative."""

    linear: float
    angular: float


@pytest.fixture
def world() -> World:
    """A world with turtle1 in the middle, past its first tick."""
    world = World()
    world.start()
    world.tick(0)
    return world


def test_a_pose_message_is_filled_completely() -> None:
    pose = fields.fill_pose(Pose(), PoseReport("turtle1", 1.0, 2.0, 3.0, 4.0, 5.0))
    assert pose == Pose(1.0, 2.0, 3.0, linear_velocity=4.0, angular_velocity=5.0)


def test_a_color_message_is_filled_completely() -> None:
    assert fields.fill_color(Color(), ColorReport("turtle1", 1, 2, 3)) == Color(1, 2, 3)


def test_service_requests_ask_for_what_their_fields_say(world: World) -> None:
    fields.spawn(world, Spawn(x=1.0, y=2.0, theta=0.5, name="bob"))
    fields.set_pen(world, "bob", SetPen(r=1, g=2, b=3, width=4, off=0))
    fields.teleport_absolute(world, "turtle1", TeleportAbsolute(x=3.0, y=4.0, theta=0.0))
    fields.teleport_relative(world, "turtle1", TeleportRelative(linear=1.0, angular=0.0))
    poses = {event.turtle: event for event in world.tick(TICK_NS) if isinstance(event, PoseReport)}
    assert (poses["bob"].x, poses["bob"].y, poses["bob"].theta) == pytest.approx((1.0, 2.0, 0.5), abs=1e-6)
    assert world.turtles["bob"].pen == Pen(1, 2, 3, 4)
    assert (poses["turtle1"].x, poses["turtle1"].y) == pytest.approx((4.0, 4.0), abs=1e-6)


@pytest.mark.parametrize(
    ("text", "request_"),
    [
        ("{x: 2, y: 3.5, theta: -1e-1, name: bob}", SpawnRequest(2.0, 3.5, -0.1, "bob")),
        ("x: 2\nname: 7", SpawnRequest(2.0, name="7")),
        ("{x: 1, name: ''}", SpawnRequest(1.0)),
        ("", SpawnRequest()),
    ],
)
def test_a_spawn_request_may_be_written_as_text(text: str, request_: SpawnRequest) -> None:
    assert read_request(SpawnRequest, text) == request_


def test_a_set_pen_request_may_be_written_as_text() -> None:
    assert read_request(SetPenRequest, "{r: 255, width: 5}") == SetPenRequest(r=255, width=5)


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("{r: 256}", "r must be a whole number from 0 to 255, not 256"),
        ("{g: -1}", "g must be"),
        ("{b: 1.5}", "b must be"),
        ("{colour: red}", "found a field 'colour'"),
        ("[1, 2, 3]", "expected fields of {r, g, b, width, off}"),
        ("red", "found 'red'"),
        ("{r: [", "no YAML"),
        ("[" * 20_000, "expected fields"),
        ("!!python/object/apply:os.getcwd []", "no YAML"),
        ("{[1]: 2}", "expected fields"),
    ],
)
def test_a_request_in_wrong_text_tells_what_was_expected(text: str, told: str) -> None:
    with pytest.raises(ValueError, match=r"expected|must be") as caught:
        read_request(SetPenRequest, text)
    assert told in str(caught.value)


@pytest.mark.parametrize("text", ["{x: two}", "{x: true}", "{x: null}", "{x: {}}"])
def test_a_place_must_be_a_number(text: str) -> None:
    with pytest.raises(ValueError, match="x must be a number"):
        read_request(SpawnRequest, text)


def test_a_number_beyond_every_float_is_refused_by_the_world(world: World) -> None:
    wanted = read_request(SpawnRequest, f"x: {'9' * 400}")
    assert "not finite" in str(fields.spawn(world, wanted))
    assert "not finite" in str(fields.spawn(world, Spawn(x=1e39, y=0.0, theta=0.0, name="")))


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
