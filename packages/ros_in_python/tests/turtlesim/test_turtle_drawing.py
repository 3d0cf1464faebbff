"""The picture of the world: what it shows, and that it looks the same whenever it is drawn."""

from __future__ import annotations

import itertools
import json
import math
import re
from pathlib import Path
from xml.etree import ElementTree as ET

import pytest
from click.testing import CliRunner

from ros_in_python.turtlesim.command import turtle
from ros_in_python.turtlesim.events import SIDE, TICK_NS, Pen
from ros_in_python.turtlesim.moving import world_svg
from ros_in_python.turtlesim.picture import save
from ros_in_python.turtlesim.world import TurtleWorld
from ros_in_python.turtlesim.world_picture import BLUE, StrokePicture, TurtlePicture, WorldPicture, picture_of
from ros_in_python.turtlesim.world_svg import BOTTOM, COATS, HEAD, LEFT, RIGHT, TOP

RED = (255, 0, 0)
SVG = "{http://www.w3.org/2000/svg}"


def driven(seconds: float) -> TurtleWorld:
    """Return a world after the course's circle controller has driven turtle1 for so long."""
    world = TurtleWorld()
    world.start()
    for n in range(int(seconds / 0.016)):
        if n % 6 == 0:
            world.command("turtle1", 2 + math.sin(n / 60), None, 1.0, n * TICK_NS)
        world.tick(n * TICK_NS)
    return world


def world_of(picture: WorldPicture) -> ET.Element:
    """Return what is within the frame of the still picture, in which 45 pixels are a unit."""
    world = ET.fromstring(world_svg(picture, moves=False)).find(f"{SVG}svg")
    assert world is not None
    return world


def corners(path: ET.Element) -> list[complex]:
    """Return the corners of a polyline (px from the upper left corner)."""
    numbers = re.findall(r"-?\d*\.?\d+", path.attrib["d"])
    steps = [complex(float(x), float(y)) for x, y in zip(numbers[::2], numbers[1::2], strict=True)]
    return list(itertools.accumulate(steps))


def test_the_picture_of_a_new_world_shows_turtle1_in_the_middle() -> None:
    picture = picture_of(driven(0), BLUE)
    assert json.loads(picture.to_json()) == {
        "size": 11.088889,
        "background": [69, 86, 255],
        "turtles": [
            {
                "name": "turtle1",
                "x": 5.5444,
                "y": 5.5444,
                "theta": 0.0,
                "pen": {"r": 179, "g": 184, "b": 255, "width": 3, "off": False},
            }
        ],
        "trails": [],
        "incomplete": "",
        "tracks": [],
    }


def test_a_picture_survives_being_written_as_json() -> None:
    picture = picture_of(driven(7), BLUE)
    (stroke,) = picture.trails
    restored = WorldPicture.from_json(picture.to_json())
    assert restored.to_json() == picture.to_json()
    assert [len(each.points) for each in restored.trails] == [len(stroke.points)]


def test_ten_minutes_of_driving_are_stored_in_far_less_than_a_megabyte() -> None:
    assert len(picture_of(driven(600), BLUE).to_json()) < 250_000


@pytest.mark.parametrize(
    "text",
    [
        "",
        "{}",
        "[]",
        "null",
        '{"size": 1}',
        '{"size": NaN, "background": [1,2,3], "turtles": [], "trails": []}',
        '{"size": 1, "background": [1,2,300], "turtles": [], "trails": []}',
        '{"size": 1, "background": [1,2,3], "turtles": [{}], "trails": []}',
        '{"size": 1, "background": [1,2,3], "turtles": [], "trails": [{"points": [1]}]}',
        "[" * 100_000,
    ],
)
def test_what_is_no_picture_is_refused(text: str) -> None:
    with pytest.raises(ValueError, match=r"Expecting|not a picture|values to unpack"):
        WorldPicture.from_json(text)


@pytest.mark.parametrize("moves", [True, False])
def test_the_same_world_gives_the_same_file_and_nothing_else_is_left_in_its_folder(moves: bool, tmp_path: Path) -> None:
    for name in ("one", "two"):
        save(picture_of(driven(3), BLUE), tmp_path / f"{name}.svg", moves=moves)
    one, two = ((tmp_path / f"{name}.svg").read_bytes() for name in ("one", "two"))
    assert one == two
    assert {each.name for each in tmp_path.iterdir()} == {"one.svg", "two.svg"}


def test_a_picture_is_xml_of_moderate_size_with_the_world_and_its_axes() -> None:
    svg = world_svg(picture_of(driven(7), BLUE), moves=False)
    root = ET.fromstring(svg)
    side = 499
    assert (int(root.attrib["width"]), int(root.attrib["height"])) == (LEFT + side + RIGHT, TOP + side + BOTTOM)
    texts = [node.text or "" for node in root.iter(f"{SVG}text")]
    assert [text for text in texts if text.isdigit()] == [str(n) for n in (0, 2, 4, 6, 8, 10) for _ in "xy"]
    assert texts[-1].startswith("turtle1:  x ")
    assert len(svg) < 5_000


def test_the_background_has_the_colour_of_the_parameters() -> None:
    square, *_ = world_of(WorldPicture(SIDE, (10, 120, 60), (), ()))
    assert square.attrib["fill"] == "#0a783c"
    assert square.attrib["d"] == "M0 0H499V499H0z"


def test_a_trail_is_as_wide_as_its_pen_and_where_it_was_drawn() -> None:
    # From wall to wall at a height of 8, 45 pixels wide: one unit.
    line = StrokePicture("turtle1", RED, 45, ((0.0, 8.0), (SIDE, 8.0)))
    *_, drawn = world_of(WorldPicture(SIDE, (0, 0, 0), (), (line,)))
    assert (drawn.attrib["stroke"], drawn.attrib["stroke-width"]) == ("#ff0000", "45")
    assert corners(drawn) == pytest.approx([complex(0, (SIDE - 8) * 45), complex(SIDE * 45, (SIDE - 8) * 45)], abs=0.1)


@pytest.mark.parametrize("theta", [0.0, 2.0, -1.0])
def test_the_turtle_looks_where_it_heads(theta: float) -> None:
    turtle = TurtlePicture("turtle1", 5.0, 4.0, theta, Pen(off=True))
    *_, drawn = world_of(WorldPicture(SIDE, (0, 0, 0), (turtle,), ()))
    place = re.fullmatch(r"translate\((\S+) (\S+)\)rotate\((\S+)\)", drawn.attrib["transform"])
    assert place
    x, y, degrees = map(float, place.groups())
    assert (x, y) == pytest.approx((225, (SIDE - 4) * 45), abs=0.1)
    # SVG's y axis points down, and the head is ahead on the turtle's own x axis.
    assert math.remainder(-math.radians(degrees) - theta, 2 * math.pi) == pytest.approx(0, abs=0.01)
    assert HEAD[0] > 0


def test_each_turtle_has_a_coat_of_its_own_and_its_name() -> None:
    turtles = tuple(TurtlePicture(name, 2.0 + n, n, 0.0, Pen()) for n, name in enumerate(("a<b", "$x$", "&c")))
    world = world_of(WorldPicture(SIDE, (0, 0, 0), turtles, ()))
    colours = {node.get("fill") for node in world.iter()}
    assert {shell for shell, _, _ in COATS[:3]} <= colours
    names = {node.text: node.attrib["transform"] for node in world.iter(f"{SVG}text")}
    assert set(names) == {"a<b", "$x$", "&c"}
    assert names["a<b"] == "translate(90 467)", "above the turtle, for below it is the wall"
    assert names["&c"] == "translate(180 451)"


def test_strokes_far_outside_do_not_hurt() -> None:
    far = StrokePicture("turtle1", RED, 3, ((1.0, 1.0), (3e38, 3e38), (1.0, 5.0)))
    *_, drawn, empty = world_of(WorldPicture(SIDE, BLUE, (), (far, StrokePicture("a", RED, 1, ()))))
    first, outside, last = corners(drawn)
    assert first == pytest.approx(complex(45, (SIDE - 1) * 45), abs=0.1)
    assert 1e5 < abs(outside) < 1e6, "more than SVG's smallest numbers can hold"
    assert last == pytest.approx(complex(45, (SIDE - 5) * 45), abs=0.1)
    assert empty.attrib["d"] == "M0 0"


@pytest.mark.parametrize("name", ["turtle.png", "turtle.gif"])
def test_a_picture_of_another_kind_is_refused_before_anything_is_looked_for(name: str) -> None:
    refused = CliRunner().invoke(turtle, [name])
    assert refused.exit_code == 2
    assert f"{name}: pictures are SVG files. Choose a name that ends in .svg." in refused.output
