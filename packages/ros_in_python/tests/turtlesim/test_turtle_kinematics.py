"""A turtle moves as turtlesim's does, at every tick."""

from __future__ import annotations

import json
import math
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st
from turtle_oracle import OracleTurtle, W, apart, circle

from ros_in_python.turtlesim.events import Event, LogLevel, LogLine, PoseReport
from ros_in_python.turtlesim.world import TurtleWorld

TICK_MS = 16
NEAR = 1e-5
#: Poses are 32-bit floats: so far may two lie apart, below 16, that are the same but for the last bit.
ROUNDED = 2e-6


class Driven:
    """A world whose clock the test advances, 16 ms per tick."""

    def __init__(self) -> None:
        self.world = TurtleWorld()
        self.world.start()
        assert self.world.tick(0) == []
        self.now_ms = 0

    def command(self, forward: float, turn: float, left: float | None = None, turtle: str = "turtle1") -> list[Event]:
        return self.world.command(turtle, forward, left, turn, self.now_ms * 1_000_000)

    def tick(self) -> list[Event]:
        self.now_ms += TICK_MS
        return self.world.tick(self.now_ms * 1_000_000)

    def pose(self) -> PoseReport:
        return pose_of(self.tick())

    def poses(self, ticks: int) -> list[PoseReport]:
        return [self.pose() for _ in range(ticks)]


def pose_of(events: list[Event], turtle: str = "turtle1") -> PoseReport:
    (pose,) = [event for event in events if isinstance(event, PoseReport) and event.turtle == turtle]
    return pose


def warnings(events: list[Event]) -> list[str]:
    return [each.text for each in events if isinstance(each, LogLine) and each.severity is LogLevel.WARN]


# What happens, and at which tick: commands (forward, turn), sideways ones (forward, left, turn), jumps, rotations.
Script = dict[int, list[tuple[str, tuple[float, ...]]]]

SCRIPTS: dict[str, Script] = {
    "straight on, once": {0: [("command", (2.0, 0.0))]},
    "a circle": {n: [("command", (2.0, 1.0))] for n in range(0, 500, 30)},
    "backwards, turning right": {n: [("command", (-1.5, -0.7))] for n in range(0, 300, 60)},
    "the course's controller": {6 * n: [("command", (2 + math.sin(n / 10), 1.0))] for n in range(70)},
    "into the right wall": {n: [("command", (4.0, 0.0))] for n in range(0, 200, 40)},
    "into a corner, aslant": {
        0: [("absolute", (10.0, 10.0, 0.6))],
        **{n: [("command", (3.0, 0.0))] for n in range(1, 200, 40)},
    },
    "along the lower wall": {
        0: [("absolute", (2.0, 0.5, -0.3))],
        **{n: [("command", (2.0, 0.02))] for n in range(1, 300, 40)},
    },
    "sideways": {n: [("sideways", (0.5, 1.2, 0.4))] for n in range(0, 200, 50)},
    "jumps, several in one tick": {
        3: [("relative", (1.5, 0.8)), ("relative", (0.5, -2.0)), ("absolute", (3.0, 4.0, 2.5))],
        9: [("absolute", (1.0, 9.0, -7.0)), ("relative", (2.0, 1.0))],
        12: [("command", (1.0, 2.0))],
    },
    "jumps out of the world": {
        2: [("absolute", (20.0, 30.0, 1.0))],
        20: [("absolute", (-5.0, -5.0, 4.0))],
        40: [("relative", (50.0, 0.3))],
    },
    "rotations, also in place of another": {
        5: [("rotate", (2.0,))],
        60: [("rotate", (-3.0,))],
        120: [("rotate", (10.0,))],
    },
    "a rotation while driving, ended by a command": {
        0: [("command", (2.0, 0.0))],
        30: [("rotate", (1.5,))],
        70: [("command", (1.0, -1.0))],
    },
}


@pytest.mark.parametrize("name", SCRIPTS)
def test_every_tick_is_where_the_specification_puts_it(name: str) -> None:
    driven, oracle = Driven(), OracleTurtle()
    for n in range(max(SCRIPTS[name]) + 200):
        for kind, numbers in SCRIPTS[name].get(n, []):
            act(driven, oracle, kind, numbers)
        pose = driven.pose()
        place, heading, speed, turn = oracle.tick(driven.now_ms)
        assert pose.x == pytest.approx(place.real, abs=NEAR), n
        assert pose.y == pytest.approx(place.imag, abs=NEAR), n
        assert apart(pose.theta, heading) < NEAR, n
        assert (pose.linear_velocity, pose.angular_velocity) == pytest.approx((speed, turn), abs=NEAR), n


#: Of turtlesim's own turtle.cpp, on the same scripts: every 16th tick and the last, as tick, x, y, theta, both speeds.
RECORDED: dict[str, list[list[float]]] = json.loads(Path(__file__).with_name("recorded_ticks.json").read_text())


@pytest.mark.parametrize("name", SCRIPTS)
def test_ticks_are_those_that_turtlesim_itself_made(name: str) -> None:
    driven = Driven()
    poses = []
    for n in range(max(SCRIPTS[name]) + 200):
        for kind, numbers in SCRIPTS[name].get(n, []):
            act(driven, OracleTurtle(), kind, numbers)
        poses.append(driven.pose())

    assert RECORDED[name][-1][0] == len(poses) - 1
    for tick, x, y, theta, speed, turn in RECORDED[name]:
        pose = poses[int(tick)]
        reported = (pose.x, pose.y, pose.theta, pose.linear_velocity, pose.angular_velocity)
        assert reported == pytest.approx((x, y, theta, speed, turn), abs=ROUNDED), tick


def act(driven: Driven, oracle: OracleTurtle, kind: str, numbers: tuple[float, ...]) -> None:
    """Do the same with the world and with the oracle."""
    if kind in ("command", "sideways"):
        forward, left, turn = (numbers[0], None, numbers[1]) if kind == "command" else numbers
        driven.command(forward, turn, left)
        oracle.velocity = complex(forward, oracle.velocity.imag if left is None else left)
        oracle.turn, oracle.commanded_ms, oracle.goal = turn, driven.now_ms, None
    elif kind == "rotate":
        driven.world.rotate("turtle1", 1, *numbers)
        oracle.goal = numbers[0]
    elif kind == "absolute":
        driven.world.teleport_absolute("turtle1", *numbers)
        oracle.jumps.append((kind, numbers))
    else:
        driven.world.teleport_relative("turtle1", *numbers)
        oracle.jumps.append((kind, numbers))


@given(speed=st.floats(-2, 2), rate=st.floats(-4, 4), ticks=st.integers(1, 62))
def test_constant_velocities_follow_the_closed_form(speed: float, rate: float, ticks: int) -> None:
    driven = Driven()
    driven.command(speed, rate)
    pose = driven.poses(ticks)[-1]
    place, heading = circle(ticks, speed, rate, complex(W / 2, W / 2), 0.0)
    assert complex(pose.x, pose.y) == pytest.approx(place, abs=NEAR)
    assert apart(pose.theta, heading) < NEAR


def test_one_command_moves_for_62_ticks() -> None:
    driven = Driven()
    start = driven.pose().x
    driven.command(2.0, 0.0)
    poses = driven.poses(100)
    assert [pose.linear_velocity for pose in poses] == [2.0] * 62 + [0.0] * 38
    assert poses[-1].x - start == pytest.approx(1.984, abs=1e-6)


def test_a_command_holds_at_exactly_one_second_and_not_after() -> None:
    world = TurtleWorld()
    world.start()
    world.tick(0)
    world.command("turtle1", 1.0, None, 0.0, 0)
    assert pose_of(world.tick(1_000_000_000)).linear_velocity == 1.0
    assert pose_of(world.tick(1_000_000_001)).linear_velocity == 0.0


def test_the_first_tick_only_begins_the_count() -> None:
    world = TurtleWorld()
    world.start()
    assert world.tick(0) == []
    assert pose_of(world.tick(0)).x == pytest.approx(5.544445, abs=5e-7)


def test_the_heading_turns_before_the_turtle_moves() -> None:
    driven = Driven()
    driven.command(1.0, math.pi / 2 / 0.016)
    pose = driven.pose()
    assert (pose.x - W / 2, pose.y - W / 2) == pytest.approx((0.0, 0.016), abs=1e-6)


def test_the_reported_speed_is_never_negative() -> None:
    driven = Driven()
    driven.command(-3.0, 0.0, left=4.0)
    assert driven.pose().linear_velocity == 5.0


def test_a_command_without_sideways_velocity_leaves_the_old_one() -> None:
    driven = Driven()
    driven.command(0.0, 0.0, left=1.0)
    driven.pose()
    driven.command(0.0, 0.0)
    pose = driven.pose()
    assert pose.y - W / 2 == pytest.approx(0.032, abs=1e-6)
    assert pose.linear_velocity == 1.0


def test_a_turtle_slides_along_the_wall_keeps_its_velocity_and_warns_each_tick() -> None:
    driven = Driven()
    driven.world.teleport_absolute("turtle1", 11.0, 5.0, math.pi / 4)
    driven.command(2.0, 0.0)
    first = driven.tick()
    assert warnings(first) == []
    ticks = [driven.tick() for _ in range(40)]
    step = 0.032 * math.sqrt(0.5)
    # 11 + 4 steps is the last position inside; the wall is at 11.088889.
    assert [len(warnings(events)) for events in ticks] == [0, 0] + [1] * 38
    x, y_down = 11 + 4 * step, W - (5 + 4 * step)
    assert warnings(ticks[2]) == [f"Oh no! I hit the wall! (Clamping from [x={x:f}, y={y_down:f}])"]
    last = pose_of(ticks[-1])
    assert (last.x, last.y) == pytest.approx((W, 5 + 41 * step), abs=NEAR)
    assert last.linear_velocity == 2.0


def test_both_axes_clamp_for_themselves_in_a_corner() -> None:
    driven = Driven()
    driven.world.teleport_absolute("turtle1", -3.0, -4.0, 0.0)
    events = driven.tick()
    assert warnings(events) == [f"Oh no! I hit the wall! (Clamping from [x=-3.000000, y={W + 4:f}])"]
    assert (pose_of(events).x, pose_of(events).y) == (0.0, 0.0)


def test_jumping_above_the_upper_wall_warns_only_for_x() -> None:
    driven = Driven()
    driven.world.teleport_absolute("turtle1", 3.0, 40.0, 0.0)
    events = driven.tick()
    assert warnings(events) == []
    assert pose_of(events).y == pytest.approx(W)


# The float32 nearest to -pi is just below turtlesim's -3.14159265, so it wraps to the other side.
@pytest.mark.parametrize(
    ("theta", "reported"), [(3.0, 3.0), (math.pi, -math.pi), (-math.pi, math.pi), (7.0, 7 - 2 * math.pi)]
)
def test_the_reported_heading_lies_between_minus_pi_and_pi(theta: float, reported: float) -> None:
    driven = Driven()
    driven.world.teleport_absolute("turtle1", 5.0, 5.0, theta)
    pose = driven.pose()
    assert pose.theta == pytest.approx(reported, abs=1e-6)


def test_a_relative_jump_turns_first() -> None:
    driven = Driven()
    driven.world.teleport_relative("turtle1", 2.0, math.pi / 2)
    pose = driven.pose()
    assert (pose.x - W / 2, pose.y - W / 2, pose.theta) == pytest.approx((0, 2, math.pi / 2), abs=1e-6)


@given(
    commands=st.lists(
        st.tuples(
            st.floats(-1e6, 1e6), st.floats(-1e3, 1e3), st.floats(-1e6, 1e6), st.sampled_from(["go", "to", "by"])
        ),
        max_size=20,
    )
)
def test_no_turtle_ever_leaves_the_walls(commands: list[tuple[float, float, float, str]]) -> None:
    driven = Driven()
    for one, two, three, kind in commands:
        if kind == "go":
            driven.command(one, two, three)
        elif kind == "to":
            driven.world.teleport_absolute("turtle1", one, three, two)
        else:
            driven.world.teleport_relative("turtle1", one, two)
        for pose in driven.poses(2):
            assert 0 <= pose.x <= W
            assert 0 <= pose.y <= W
            assert abs(pose.theta) <= math.pi + 1e-6


@pytest.mark.parametrize("number", [math.nan, math.inf, -math.inf])
def test_numbers_that_are_not_finite_are_refused_with_a_warning(number: float) -> None:
    driven = Driven()
    before = driven.pose()
    refusals = [
        driven.command(number, 0.0),
        driven.command(0.0, number),
        driven.command(0.0, 0.0, left=number),
        driven.world.teleport_absolute("turtle1", 1.0, number, 0.0),
        driven.world.teleport_relative("turtle1", 1.0, number),
        driven.world.rotate("turtle1", 1, number),
        driven.world.spawn(number, 1.0, 1.0, "bob"),
    ]
    assert [len(warnings(events)) for events in refusals] == [1] * len(refusals)
    assert driven.pose() == before
    assert list(driven.world.turtles) == ["turtle1"]
