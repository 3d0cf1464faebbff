"""Turtles appear and disappear, turn to a heading on request, and print the same messages as turtlesim."""

from __future__ import annotations

import math

import pytest

from ros_in_python.turtlesim.events import (
    TICK_NS,
    Event,
    LogLine,
    Outcome,
    Pen,
    PoseReport,
    RotationEnded,
    RotationFeedback,
    TurtleKilled,
    TurtleSpawned,
)
from ros_in_python.turtlesim.world import TurtleWorld


@pytest.fixture
def world() -> TurtleWorld:
    """A world with turtle1 in the middle, past its first tick."""
    world = TurtleWorld()
    world.start()
    world.tick(0)
    return world


def lines(events: list[Event]) -> list[tuple[str, str]]:
    return [(event.severity.value, event.text) for event in events if isinstance(event, LogLine)]


def ends(events: list[Event]) -> list[RotationEnded]:
    return [event for event in events if isinstance(event, RotationEnded)]


def tick_until_rotated(world: TurtleWorld, ticks: int = 500) -> tuple[RotationEnded, list[RotationFeedback]]:
    feedback: list[RotationFeedback] = []
    for n in range(1, ticks):
        events = world.tick(n * TICK_NS)
        feedback += [event for event in events if isinstance(event, RotationFeedback)]
        if over := ends(events):
            return over[0], feedback
    raise AssertionError("the rotation never ended")


def test_the_start_tells_where_turtle1_is() -> None:
    events = TurtleWorld().start()
    message = "Spawning turtle [turtle1] at x=[5.544445], y=[5.544445], theta=[0.000000]"
    assert TurtleSpawned("turtle1") in events
    assert lines(events) == [("info", message)]


def test_turtles_without_a_name_are_numbered_and_names_in_use_are_skipped(world: TurtleWorld) -> None:
    world.spawn(1, 1, 0, "turtle3")
    named = [event.turtle for _ in range(3) for event in world.spawn(1, 1, 0) if isinstance(event, TurtleSpawned)]
    assert named == ["turtle2", "turtle4", "turtle5"]


def test_the_number_of_a_killed_turtle_is_not_used_again(world: TurtleWorld) -> None:
    world.spawn(1, 1, 0)
    assert world.kill("turtle2") == [TurtleKilled("turtle2")]
    assert TurtleSpawned("turtle3") in world.spawn(1, 1, 0)


def test_a_name_in_use_is_an_error_and_spawns_nothing(world: TurtleWorld) -> None:
    message = "A turtle named [turtle1] already exists. Choose another name, or call /kill with this one first."
    assert lines(world.spawn(1, 1, 0, "turtle1")) == [("error", message)]
    assert not any(isinstance(event, TurtleSpawned) for event in world.spawn(1, 1, 0, "turtle1"))


@pytest.mark.parametrize("name", ["two words", "9lives", "a//b", "a/", "ü", "x" * 200, "$x$", "a\n"])
def test_a_name_that_no_topic_can_have_is_refused(world: TurtleWorld, name: str) -> None:
    (line,) = world.spawn(1, 1, 0, name)
    assert isinstance(line, LogLine)
    assert line.severity.value == "error"
    assert line.text.endswith("Begin with a letter, and use letters, digits and _ only.")
    assert list(world.turtles) == ["turtle1"]


def test_killing_a_turtle_that_does_not_exist_is_an_error_that_says_which_do(world: TurtleWorld) -> None:
    events = [("error", "Tried to kill turtle [bob], which does not exist. Turtles that do: turtle1.")]
    assert lines(world.kill("bob")) == events
    world.kill("turtle1")
    assert lines(world.kill("bob"))[0][1].endswith("Turtles that do: none.")


def test_a_place_outside_the_window_is_a_warning_that_says_what_is_inside(world: TurtleWorld) -> None:
    message = "[turtle1] stops at the edge: x=99, y=-1 is outside. Choose both between 0 and 11.09."
    assert lines(world.teleport_absolute("turtle1", 99, -1, 0)) == [("warn", message)]
    assert lines(world.teleport_absolute("turtle1", 0, 11.0, 0)) == []
    assert lines(world.spawn(12, 1, 0, "bob"))[1] == (
        "warn",
        message.replace("turtle1", "bob").replace("99, y=-1", "12, y=1"),
    )


def test_turtles_tick_in_the_order_of_their_names(world: TurtleWorld) -> None:
    world.spawn(1, 1, 0, "bob")
    world.spawn(1, 1, 0, "turtle10")
    world.spawn(1, 1, 0, "Ann")
    poses = [event.turtle for event in world.tick(TICK_NS) if isinstance(event, PoseReport)]
    assert poses == ["Ann", "bob", "turtle1", "turtle10"]


def test_reset_begins_again_with_turtle1_alone_and_numbers_anew(world: TurtleWorld) -> None:
    world.spawn(1, 1, 0)
    world.set_pen("turtle1", 1, 2, 3, 4, 0)
    world.teleport_absolute("turtle1", 2, 2, 1)
    world.tick(TICK_NS)
    assert world.trail.strokes
    events = world.reset()
    assert lines(events)[0] == ("info", "Resetting turtlesim.")
    killed = [event for event in events if isinstance(event, TurtleKilled)]
    assert killed == [TurtleKilled("turtle1"), TurtleKilled("turtle2")]
    assert TurtleSpawned("turtle1") in events
    assert world.turtles["turtle1"].pen == Pen(179, 184, 255, 3)
    assert world.trail.strokes == []
    assert TurtleSpawned("turtle2") in world.spawn(1, 1, 0)


def test_clear_wipes_the_trail_and_leaves_the_turtles(world: TurtleWorld) -> None:
    world.teleport_absolute("turtle1", 2, 2, 1)
    world.tick(TICK_NS)
    assert lines(world.clear()) == [("info", "Clearing turtlesim.")]
    assert world.trail.strokes == []
    assert world.turtles["turtle1"].x == 2


def test_a_rotation_turns_at_1_rad_per_s_until_less_than_2_hundredths_remain(world: TurtleWorld) -> None:
    world.rotate("turtle1", 7, 1.0)
    end, feedback = tick_until_rotated(world)
    # After n ticks 1 - 0.016 n remain: 0.024 after 61, 0.008 after 62.
    assert len(feedback) == 63
    assert feedback[0].remaining == 1.0
    assert feedback[-1].remaining == pytest.approx(0.008, abs=1e-6)
    assert (end.goal, end.outcome) == (7, Outcome.SUCCEEDED)
    # The sign is against the turn: start minus end.
    assert end.delta == pytest.approx(-0.992, abs=1e-6)


def test_a_rotation_takes_the_shorter_way(world: TurtleWorld) -> None:
    world.teleport_absolute("turtle1", 5, 5, 3.0)
    world.tick(TICK_NS)
    world.rotate("turtle1", 1, -3.0)
    end, feedback = tick_until_rotated(world)
    assert feedback[0].remaining == pytest.approx(2 * math.pi - 6, abs=1e-6)
    # 0.283 to go: 17 ticks leave 0.0112. The difference of the headings wraps as well.
    assert end.delta == pytest.approx(-17 * 0.016, abs=1e-6)


def test_a_rotation_that_is_there_already_succeeds_at_once(world: TurtleWorld) -> None:
    world.rotate("turtle1", 1, 0.0199)
    events = world.tick(TICK_NS)
    assert lines(events) == [("info", "Rotation goal completed successfully")]
    assert ends(events) == [RotationEnded("turtle1", 1, Outcome.SUCCEEDED, 0.0)]


def test_a_rotation_outlasts_the_timeout_of_commands(world: TurtleWorld) -> None:
    world.rotate("turtle1", 1, 3.0)
    end, feedback = tick_until_rotated(world)
    assert end.outcome is Outcome.SUCCEEDED
    assert len(feedback) > 180


def test_a_command_ends_a_rotation_with_a_warning(world: TurtleWorld) -> None:
    world.rotate("turtle1", 1, 3.0)
    world.tick(TICK_NS)
    world.tick(2 * TICK_NS)
    events = world.command("turtle1", 0.0, None, 0.5, 2 * TICK_NS)
    assert lines(events) == [("warn", "Velocity command received during rotation goal. Aborting goal")]
    (end,) = ends(events)
    # What the last tick saw: one tick of turning.
    assert end.outcome is Outcome.ABORTED
    assert end.delta == pytest.approx(-0.016, abs=1e-6)
    (pose,) = [event for event in world.tick(3 * TICK_NS) if isinstance(event, PoseReport)]
    assert pose.angular_velocity == 0.5


def test_a_new_rotation_ends_the_former_with_a_warning(world: TurtleWorld) -> None:
    world.rotate("turtle1", 1, 3.0)
    events = world.rotate("turtle1", 2, -3.0)
    message = "Rotation goal received before a previous goal finished. Aborting previous goal"
    assert lines(events) == [("warn", message)]
    assert [(end.goal, end.outcome) for end in ends(events)] == [(1, Outcome.ABORTED)]
    end, _ = tick_until_rotated(world)
    assert (end.goal, end.outcome) == (2, Outcome.SUCCEEDED)


def test_a_cancelled_rotation_stops_the_turtle_at_the_next_tick(world: TurtleWorld) -> None:
    world.rotate("turtle1", 1, 3.0)
    world.tick(TICK_NS)
    assert world.cancel_rotation("turtle1", 1)
    events = world.tick(2 * TICK_NS)
    assert lines(events) == [("info", "Rotation goal canceled")]
    assert [end.outcome for end in ends(events)] == [Outcome.CANCELED]
    (pose,) = [event for event in events if isinstance(event, PoseReport)]
    assert pose.theta == pytest.approx(0.016, abs=1e-6)
    assert pose.angular_velocity == 0.0


def test_only_the_rotation_that_is_meant_can_be_cancelled(world: TurtleWorld) -> None:
    assert not world.cancel_rotation("turtle1")
    world.rotate("turtle1", 2, 3.0)
    assert not world.cancel_rotation("turtle1", 1)
    assert world.cancel_rotation("turtle1")


def test_killing_a_turtle_ends_its_rotation(world: TurtleWorld) -> None:
    world.rotate("turtle1", 1, 3.0)
    events = world.kill("turtle1")
    assert [end.outcome for end in ends(events)] == [Outcome.ABORTED]
    assert events[-1] == TurtleKilled("turtle1")
