"""The turtle that drives again: its positions, within the stated tolerance, and without motion if preferred."""

from __future__ import annotations

import math
import re
from itertools import pairwise
from pathlib import Path
from xml.etree import ElementTree as ET

import pytest
from browser import opened
from hypothesis import given, settings
from hypothesis import strategies as st
from playwright.sync_api import Browser

from ros_in_python.animation import BEFORE_S, still
from ros_in_python.thinning import thinned
from ros_in_python.turtlesim.events import DT, PIXELS_PER_UNIT, SIDE, TICK_NS, Pen
from ros_in_python.turtlesim.moving import LONGEST_S, LONGEST_WAIT_S, MOST_SAMPLES, timeline, world_svg
from ros_in_python.turtlesim.trail import HEADING_TOLERANCE, PLACE_TOLERANCE, Track, TrackSample
from ros_in_python.turtlesim.world import TurtleWorld
from ros_in_python.turtlesim.world_picture import BLUE, WorldPicture, picture_of

#: A quarter of a turn on a radius of 2, then a wait of 5 s, then 2 units straight on.
TURN_TICKS, WAIT_TICKS, STRAIGHT_TICKS = 98, 312, 62


def driven() -> tuple[TurtleWorld, list[tuple[float, float, float]]]:
    """Return a world, and where its turtle was after each tick."""
    world = TurtleWorld()
    world.start()
    world.tick(0)
    places = []
    for n in range(1, TURN_TICKS + WAIT_TICKS + STRAIGHT_TICKS + 1):
        if n <= TURN_TICKS:
            world.command("turtle1", 2.0, None, 1.0, n * TICK_NS)
        elif n <= TURN_TICKS + WAIT_TICKS:
            world.command("turtle1", 0.0, None, 0.0, n * TICK_NS)
        else:
            world.command("turtle1", 2.0, None, 0.0, n * TICK_NS)
        world.tick(n * TICK_NS)
        turtle = world.turtles["turtle1"]
        places.append((turtle.x, turtle.y, turtle.theta))
    return world, places


def picture() -> WorldPicture:
    """Return the node's picture of that world."""
    return WorldPicture.from_json(picture_of(driven()[0], BLUE).to_json())


steps = st.tuples(st.floats(-0.2, 0.2), st.floats(-0.2, 0.2), st.floats(-3, 3)) | st.just((0.0, 0.0, 0.0))


@given(st.lists(steps, min_size=1, max_size=100))
@settings(deadline=None)
def test_between_the_samples_of_a_track_the_turtle_is_where_they_say(ways: list[tuple[float, float, float]]) -> None:
    track, x, y, theta = Track(), 5.0, 5.0, 0.0
    was = []
    for tick, (dx, dy, turn) in enumerate(ways):
        x, y, theta = x + dx, y + dy, theta + turn
        was.append((x, y, theta))
        track.add(tick, x, y, math.remainder(theta, 2 * math.pi), Pen())
    for before, after in pairwise(track.samples):
        for tick in range(before.tick, after.tick + 1):
            part = (tick - before.tick) / (after.tick - before.tick)
            assert before.x + part * (after.x - before.x) == pytest.approx(was[tick][0], abs=PLACE_TOLERANCE * 1.01)
            assert before.y + part * (after.y - before.y) == pytest.approx(was[tick][1], abs=PLACE_TOLERANCE * 1.01)
            heading = before.theta + part * (after.theta - before.theta) - was[tick][2]
            assert abs(math.remainder(heading, 2 * math.pi)) <= HEADING_TOLERANCE * 1.01
    assert (track.samples[0].tick, track.samples[-1].tick) == (0, len(ways) - 1)


@given(st.lists(st.floats(-9, 9), min_size=2, max_size=60), st.floats(0.01, 5))
@settings(deadline=None)
def test_thinned_points_pass_near_all_of_them(values: list[float], tolerance: float) -> None:
    points = list(enumerate(values))
    kept = thinned([(float(t), v) for t, v in points], tolerance)
    for (t0, v0), (t1, v1) in pairwise(kept):
        for t, value in points:
            if t0 <= t <= t1:
                assert abs(v0 + (v1 - v0) * (t - t0) / (t1 - t0) - value) <= tolerance + 1e-9


def test_a_track_for_ever_forgets_the_oldest() -> None:
    track = Track()
    for tick in range(8_000):
        track.add(tick, (tick % 2) * 1.0, 0.0, 0.0, None)
    assert track.forgotten
    assert len(track.samples) <= 3_000


def test_the_pace_is_real_and_waits_are_cut_short() -> None:
    (track,) = picture().tracks
    times = timeline([track.samples])

    assert times.faster == 1
    assert times.seconds == pytest.approx((TURN_TICKS + STRAIGHT_TICKS) * DT + LONGEST_WAIT_S, abs=0.15)


def test_a_long_way_is_shown_faster_and_says_so() -> None:
    samples = tuple(TrackSample(tick, tick % 11, 0.0, 0.0, Pen()) for tick in range(0, 7_000, 100))
    times = timeline([samples])

    assert times.faster == 4
    assert times.seconds <= LONGEST_S


def test_a_world_in_which_nothing_moved_or_too_little_to_see_has_a_still_picture() -> None:
    world = TurtleWorld()
    world.start()
    for n in range(20):
        world.tick(n * TICK_NS)
    svg = world_svg(picture_of(world, BLUE))
    assert svg == still(svg)
    world.command("turtle1", 0.1, None, 0.0, 20 * TICK_NS)
    world.tick(20 * TICK_NS)
    nudged = picture_of(world, BLUE)
    assert nudged.tracks
    assert world_svg(nudged) == still(world_svg(nudged))


def test_clear_and_reset_begin_the_way_anew() -> None:
    world, _ = driven()
    world.clear()
    world.tick(10**12)
    assert picture_of(world, BLUE).tracks == ()


def test_a_lifted_pen_drives_and_draws_nothing() -> None:
    world = TurtleWorld()
    world.start()
    world.tick(0)
    world.set_pen("turtle1", 0, 0, 0, 1, 1)
    world.command("turtle1", 2.0, None, 0.0, 0)
    for n in range(1, 40):
        world.tick(n * TICK_NS)
    svg = world_svg(picture_of(world, BLUE))
    assert "stroke-dashoffset" not in svg
    assert "translate(" in svg


def test_it_is_a_few_kilobytes_of_xml_without_script_and_the_same_each_time() -> None:
    svg = world_svg(picture())

    assert svg == world_svg(picture())
    assert ET.fromstring(svg).tag.endswith("svg")
    assert len(svg) < 10_000
    assert not re.search(r"<script|https?://(?!www\.w3\.org/2000/svg)|@import|<image", svg)
    assert f"within {PLACE_TOLERANCE:g}".replace("0.", ".") in svg


def test_ten_minutes_of_driving_are_thinned_and_the_error_is_reported() -> None:
    world = TurtleWorld()
    world.start()
    for n in range(9_000):
        world.command("turtle1", 2 + math.sin(n / 60), None, 1.0, n * TICK_NS)
        world.tick(n * TICK_NS)
    svg = world_svg(picture_of(world, BLUE))

    assert svg.count("rotate(") <= MOST_SAMPLES + 2
    assert re.search(r"within \.\d+ units, \d times the original speed", svg)


_STATE = """ms => {
    for (const each of document.getAnimations()) { each.pause(); each.currentTime = ms; }
    const turtle = new DOMMatrix(getComputedStyle(document.querySelector('g[transform]')).transform);
    const trail = document.querySelector('path[stroke-dasharray]');
    const style = getComputedStyle(trail);
    return {x: turtle.e, y: turtle.f, heading: Math.atan2(-turtle.b, turtle.a),
        animations: document.getAnimations().length,
        drawn: parseFloat(style.strokeDasharray) - parseFloat(style.strokeDashoffset), length: trail.getTotalLength()};
}"""


def test_in_a_browser_the_turtle_is_where_it_was_at_each_time(browser: Browser, tmp_path: Path) -> None:
    world, places = driven()
    (tmp_path / "page.html").write_text("<!doctype html><title>turtle</title>" + world_svg(picture_of(world, BLUE)))
    with opened(browser, tmp_path / "page.html") as shown:
        for tick in (20, 60, TURN_TICKS, TURN_TICKS + WAIT_TICKS + 30, len(places)):
            shift = 0.0 if tick <= TURN_TICKS else WAIT_TICKS * DT - LONGEST_WAIT_S
            state = shown.page.evaluate(_STATE, 1000 * (BEFORE_S + tick * DT - shift))
            x, y, theta = places[tick - 1]
            near = PIXELS_PER_UNIT * (PLACE_TOLERANCE + 0.1)  # and what a few ticks are at the edges of a wait
            assert state["x"] == pytest.approx(x * PIXELS_PER_UNIT, abs=near)
            assert state["y"] == pytest.approx((SIDE - y) * PIXELS_PER_UNIT, abs=near)
            assert state["heading"] == pytest.approx(theta, abs=0.1)
            driving = min(tick, TURN_TICKS) + max(0, tick - TURN_TICKS - WAIT_TICKS)
            assert state["drawn"] == pytest.approx(2.0 * DT * driving * PIXELS_PER_UNIT, abs=8)
        assert shown.faults == []


@pytest.mark.parametrize("media", [{"media": "print"}, {"reduced_motion": "reduce"}])
def test_in_print_and_for_who_wants_no_motion_it_is_the_whole_way_and_still(
    browser: Browser, tmp_path: Path, media: dict[str, str]
) -> None:
    world, places = driven()
    (tmp_path / "page.html").write_text("<!doctype html><title>turtle</title>" + world_svg(picture_of(world, BLUE)))
    with opened(browser, tmp_path / "page.html") as shown:
        shown.page.emulate_media(**media)  # type: ignore[arg-type]
        state = shown.page.evaluate(_STATE, 0)
    assert state["animations"] == 0
    assert state["x"] == pytest.approx(places[-1][0] * PIXELS_PER_UNIT, abs=1)
    assert state["drawn"] >= state["length"]
