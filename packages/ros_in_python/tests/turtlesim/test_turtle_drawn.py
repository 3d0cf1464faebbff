"""What turtles draw: the canvas under their colour sensors, and the trail of the picture."""

from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from ros_in_python.turtlesim.canvas import Canvas
from ros_in_python.turtlesim.events import CENTRE, SIDE, TICK_NS, ColorReport, Pen
from ros_in_python.turtlesim.trail import MAX_POINTS, TOLERANCE, Point, Stroke, Trail
from ros_in_python.turtlesim.world import TurtleWorld

WHITE = (255, 255, 255)
RED = Pen(255, 0, 0, 3)


def painted(canvas: Canvas) -> set[tuple[int, int]]:
    """Return columns and rows of the pixels that are not white."""
    return {
        (column, row) for column in range(500) for row in range(500) if canvas.color((column / 45, row / 45)) != WHITE
    }


def test_a_fresh_canvas_reads_white() -> None:
    assert Canvas().color((0.0, 0.0)) == WHITE
    assert Canvas().color((SIDE, SIDE)) == WHITE


def test_a_line_has_the_pen_s_width_and_square_caps() -> None:
    canvas = Canvas()
    canvas.line((100 / 45, 50 / 45), (110 / 45, 50 / 45), RED)
    # Half the width, 1.5, beyond each end and to each side.
    assert painted(canvas) == {(column, row) for column in range(99, 112) for row in range(49, 52)}


def test_a_jump_to_the_same_place_leaves_a_square() -> None:
    canvas = Canvas()
    canvas.line((1.0, 1.0), (1.0, 1.0), Pen(0, 0, 0, 5))
    assert painted(canvas) == {(column, row) for column in range(43, 48) for row in range(43, 48)}


def test_lines_from_beyond_the_canvas_are_cut_off_at_its_edge() -> None:
    canvas = Canvas()
    canvas.line((-1e30, 2.0), (1.0, 2.0), RED)
    canvas.line((-20.0, -20.0), (-10.0, -15.0), RED)
    assert painted(canvas) == {(column, row) for column in range(47) for row in range(89, 92)}


PLACES = st.tuples(st.floats(-1, 12), st.floats(-1, 12))


@given(PLACES, PLACES, st.integers(1, 20), st.lists(PLACES, min_size=5, max_size=30))
def test_the_pixels_of_a_line_are_those_inside_its_caps_and_sides(
    start: Point, end: Point, width: int, places: list[Point]
) -> None:
    canvas = Canvas()
    canvas.line(start, end, Pen(0, 0, 0, width))
    middle, half = ((start[0] + end[0]) / 2, (start[1] + end[1]) / 2), width / 2
    length = 45 * math.dist(start, end)
    angle = math.atan2(end[1] - start[1], end[0] - start[0])
    for place in (*places, start, end, middle):
        dx, dy = (math.floor(45 * part + 0.5) - 45 * from_ for part, from_ in zip(place, start, strict=True))
        along, across = dx * math.cos(angle) + dy * math.sin(angle), dy * math.cos(angle) - dx * math.sin(angle)
        inside = min(along + half, length + half - along, half - abs(across))
        is_on_canvas = all(0 <= math.floor(45 * part + 0.5) < 500 for part in place)
        if is_on_canvas and abs(inside) > 1e-6:
            assert (canvas.color(place) != WHITE) == (inside > 0)


def colors(world: TurtleWorld, ticks: range) -> list[tuple[int, int, int]]:
    reports = [event for n in ticks for event in world.tick(n * TICK_NS) if isinstance(event, ColorReport)]
    return [(each.r, each.g, each.b) for each in reports]


def test_the_colour_sensor_sees_white_ahead_and_the_pen_where_it_has_been() -> None:
    world = TurtleWorld()
    world.start()
    world.set_pen("turtle1", 10, 20, 30, 3, 0)
    world.command("turtle1", 10.0, None, 0.0, 0)
    # 7.2 pixels per tick: beyond the cap of the line drawn so far.
    assert colors(world, range(11)) == [WHITE] * 10
    world.command("turtle1", -10.0, None, 0.0, 10 * TICK_NS)
    # The way out began in the middle and drew to where the tenth tick ended.
    assert colors(world, range(11, 21)) == [(10, 20, 30)] * 10
    assert colors(world, range(21, 23)) == [WHITE] * 2


def test_the_colour_sensor_looks_before_the_tick_s_own_line_is_drawn() -> None:
    world = TurtleWorld()
    world.start()
    world.set_pen("turtle1", 10, 20, 30, 3, 0)
    world.tick(0)
    world.teleport_absolute("turtle1", 2.0, 2.0, 0.0)
    # The teleport's line is drawn first, so its end is visible.
    assert colors(world, range(1, 2)) == [(10, 20, 30)]


def test_a_lifted_pen_draws_nothing_and_keeps_its_colour() -> None:
    world = TurtleWorld()
    world.start()
    world.tick(0)
    world.set_pen("turtle1", 1, 2, 3, 9, 1)
    world.teleport_absolute("turtle1", 2.0, 2.0, 0.0)
    world.tick(TICK_NS)
    assert world.trail.strokes == []
    assert world.turtles["turtle1"].pen == Pen(179, 184, 255, 3, off=True)


def test_a_width_of_zero_means_one() -> None:
    assert Pen().changed(1, 2, 3, 0, 0) == Pen(1, 2, 3, 1)


def test_a_straight_drive_is_one_line_and_a_teleport_a_corner() -> None:
    world = TurtleWorld()
    world.start()
    world.tick(0)
    world.command("turtle1", 2.0, None, 0.0, 0)
    for n in range(1, 51):
        world.tick(n * TICK_NS)
    world.teleport_absolute("turtle1", 2.0, 9.0, 0.0)
    world.tick(51 * TICK_NS)
    (stroke,) = world.trail.strokes
    corners = [(CENTRE, CENTRE), (CENTRE + 1.6, CENTRE), (2.0, 9.0), (2.032, 9.0)]
    assert stroke.points == [pytest.approx(corner, abs=TOLERANCE) for corner in corners]


def test_another_pen_begins_another_stroke() -> None:
    world = TurtleWorld()
    world.start()
    world.tick(0)
    world.command("turtle1", 1.0, None, 0.0, 0)
    world.tick(TICK_NS)
    world.set_pen("turtle1", 255, 0, 0, 5, 0)
    world.tick(2 * TICK_NS)
    first, second = world.trail.strokes
    assert (first.pen, second.pen) == (Pen(), Pen(255, 0, 0, 5))
    assert second.points[0] == first.points[-1]


def distance(point: Point, start: Point, end: Point) -> float:
    """Return the distance from a point to a straight line segment, in units."""
    way, off = complex(*end) - complex(*start), complex(*point) - complex(*start)
    part = 0.0 if way == 0 else min(1.0, max(0.0, (off * way.conjugate()).real / abs(way) ** 2))
    return abs(off - part * way)


steps = st.tuples(st.floats(-0.2, 0.2), st.floats(-0.2, 0.2)) | st.just((0.01, 0.0)) | st.just((-0.003, 0.001))


@given(st.lists(steps, min_size=1, max_size=120))
def test_a_thinned_stroke_passes_near_every_point_it_was_drawn_through(ways: list[Point]) -> None:
    drawn = [(5.0, 5.0)]
    stroke = Stroke("turtle1", Pen(), [drawn[0]])
    for dx, dy in ways:
        drawn.append((drawn[-1][0] + dx, drawn[-1][1] + dy))
        stroke.extend(drawn[-1])
    assert stroke.points[0] == drawn[0]
    assert stroke.points[-1] == drawn[-1]
    pieces = list(zip(stroke.points, stroke.points[1:], strict=False))
    for point in drawn:
        assert min(distance(point, *piece) for piece in pieces) <= TOLERANCE * 1.01


def test_a_lap_of_a_circle_takes_few_points() -> None:
    world = TurtleWorld()
    world.start()
    for n in range(394):
        world.command("turtle1", 2.0, None, 1.0, n * TICK_NS)
        world.tick(n * TICK_NS)
    (stroke,) = world.trail.strokes
    # A chord that bulges by t on a radius of 2 spans 2 acos(1 - t/2): 50 per lap; thinned while recording, some more.
    assert 40 < len(stroke.points) < 100
    radii = [math.dist(point, (CENTRE, CENTRE + 2)) for point in stroke.points]
    assert radii == [pytest.approx(2.0, abs=0.02)] * len(radii)


def test_a_turtle_may_draw_for_ever_and_the_oldest_is_forgotten() -> None:
    trail = Trail()
    for n in range(2 * MAX_POINTS):
        trail.line("turtle1", RED, (n % 10, n % 2), ((n + 1) % 10, (n + 1) % 2))
    assert trail.forgotten
    points = [point for stroke in trail.strokes for point in stroke.points]
    assert MAX_POINTS // 2 < len(points) <= MAX_POINTS
    assert points[-1] == (2 * MAX_POINTS % 10, 0)


def test_many_short_strokes_are_forgotten_one_by_one() -> None:
    trail = Trail()
    for n in range(MAX_POINTS):
        trail.line(f"turtle{n % 3}", Pen(n % 256, 0, 0), (0.0, 0.0), (1.0, n % 5))
    assert trail.forgotten
    assert len(trail.strokes) == MAX_POINTS // 8
    assert trail.strokes[-1].points[-1] == (1.0, (MAX_POINTS - 1) % 5)
