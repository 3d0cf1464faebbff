"""The picture of the world: what it shows, and that it looks the same whenever it is drawn."""

from __future__ import annotations

import json
import math
from pathlib import Path
from xml.etree import ElementTree as ET

import matplotlib.image
import numpy as np
import pytest
from matplotlib.colors import to_rgb

from ros_in_python.turtlesim.events import SIDE, TICK_NS, Pen
from ros_in_python.turtlesim.picture import draw, save
from ros_in_python.turtlesim.world import TurtleWorld
from ros_in_python.turtlesim.world_picture import BLUE, StrokePicture, TurtlePicture, WorldPicture, picture_of
from ros_in_python.turtlesim.world_svg import COATS

RED = (255, 0, 0)


def driven(seconds: float) -> TurtleWorld:
    """Return a world after the course's circle controller has driven turtle1 for so long."""
    world = TurtleWorld()
    world.start()
    for n in range(int(seconds / 0.016)):
        if n % 6 == 0:
            world.command("turtle1", 2 + math.sin(n / 60), None, 1.0, n * TICK_NS)
        world.tick(n * TICK_NS)
    return world


def pixels(picture: WorldPicture, tmp_path: Path) -> np.ndarray:
    """Return the colours 0..255 of the picture's PNG, rows from the top."""
    save(picture, tmp_path / "world.png")
    image: np.ndarray = matplotlib.image.imread(tmp_path / "world.png")[:, :, :3] * 255
    return np.asarray(image.round(), dtype=int)


def near(image: np.ndarray, color: tuple[int, int, int]) -> int:
    """Return how many pixels have nearly that colour."""
    return int((np.abs(image - color).max(axis=2) <= 3).sum())


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


@pytest.mark.parametrize("kind", ["png", "svg"])
def test_the_same_world_gives_the_same_file(kind: str, tmp_path: Path) -> None:
    for name in ("one", "two"):
        save(picture_of(driven(3), BLUE), tmp_path / f"{name}.{kind}")
    one, two = ((tmp_path / f"{name}.{kind}").read_bytes() for name in ("one", "two"))
    assert one == two


def test_an_svg_is_xml_of_moderate_size(tmp_path: Path) -> None:
    save(picture_of(driven(7), BLUE), tmp_path / "world.svg")
    assert ET.parse(tmp_path / "world.svg").getroot().tag.endswith("svg")
    assert (tmp_path / "world.svg").stat().st_size < 100_000


def test_nothing_but_the_picture_is_left_in_its_folder(tmp_path: Path) -> None:
    save(picture_of(driven(0), BLUE), tmp_path / "world.png")
    assert [each.name for each in tmp_path.iterdir()] == ["world.png"]


def test_the_name_of_a_picture_tells_its_kind(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match=r"must end in \.png or \.svg"):
        save(picture_of(driven(0), BLUE), tmp_path / "world.gif")


def test_the_background_has_the_colour_of_the_parameters(tmp_path: Path) -> None:
    image = pixels(WorldPicture(SIDE, (10, 120, 60), (), ()), tmp_path)
    assert near(image, (10, 120, 60)) > image.shape[0] * image.shape[1] * 0.6


def test_a_trail_is_as_wide_as_its_pen_and_where_it_was_drawn(tmp_path: Path) -> None:
    # From wall to wall at a height of 8, 45 pixels wide: one unit.
    line = StrokePicture("turtle1", RED, 45, ((0.0, 8.0), (SIDE, 8.0)))
    image = pixels(WorldPicture(SIDE, (0, 0, 0), (), (line,)), tmp_path)
    rows, columns = np.nonzero(np.abs(image - RED).max(axis=2) <= 3)
    width = columns.max() - columns.min()
    assert (rows.max() - rows.min()) / width == pytest.approx(1 / SIDE, rel=0.05)
    frame = np.nonzero(image.max(axis=2) < 20)[0]
    assert rows.mean() - frame.min() == pytest.approx((SIDE - 8.0) / SIDE * width, abs=4)


@pytest.mark.parametrize("theta", [0.0, 2.0, -1.0])
def test_the_turtle_looks_where_it_heads(theta: float, tmp_path: Path) -> None:
    turtle = TurtlePicture("turtle1", 5.0, 5.0, theta, Pen(off=True))
    figure = draw(WorldPicture(SIDE, (0, 0, 0), (turtle,), ()))
    (axes,) = figure.axes
    shapes = [shape for shape in axes.get_children() if shape.get_zorder() >= 10]
    head = next(shape for shape in shapes if shape.get_gid() == "head")
    box = axes.transData.inverted().transform_bbox(head.get_window_extent())
    ahead = complex((box.x0 + box.x1) / 2 - 5.0, (box.y0 + box.y1) / 2 - 5.0)
    assert math.remainder(math.atan2(ahead.imag, ahead.real) - theta, 2 * math.pi) == pytest.approx(0, abs=0.02)
    assert 0.3 < abs(ahead) < 0.6


def test_each_turtle_has_a_coat_of_its_own(tmp_path: Path) -> None:
    turtles = tuple(TurtlePicture(f"turtle{n}", 2.0 + 2 * n, 5.0, 0.0, Pen()) for n in range(3))
    image = pixels(WorldPicture(SIDE, (0, 0, 0), turtles, ()), tmp_path)
    for shell, _, _ in COATS[:3]:
        r, g, b = (round(255 * part) for part in to_rgb(shell))
        assert near(image, (r, g, b)) > 50


def test_a_name_is_written_as_it_is(tmp_path: Path) -> None:
    turtles = tuple(TurtlePicture(name, 2.0, 5.0, 0.0, Pen()) for name in ("$\\frac{", "a$b$c"))
    save(WorldPicture(SIDE, BLUE, turtles, ()), tmp_path / "world.png")


def test_strokes_far_outside_do_not_hurt(tmp_path: Path) -> None:
    far = StrokePicture("turtle1", RED, 3, ((1.0, 1.0), (3e38, 3e38), (1.0, 5.0)))
    image = pixels(WorldPicture(SIDE, BLUE, (), (far, StrokePicture("a", RED, 1, ()))), tmp_path)
    assert near(image, RED) > 100
