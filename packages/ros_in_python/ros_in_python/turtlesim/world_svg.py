"""The turtles' world as SVG: the ground, the trails, the turtles and the axes; as it is now, or to be set in motion."""

from __future__ import annotations

import math
from collections.abc import Sequence
from html import escape
from itertools import pairwise

from ros_in_python.animation import coord
from ros_in_python.turtlesim.events import PIXELS_PER_UNIT
from ros_in_python.turtlesim.world_picture import Color, TurtlePicture, WorldPicture, caption

#: Shell, its plates, skin: one set for each turtle in turn.
COATS = (
    ("#2c7a46", "#57b368", "#a5dc8c"),
    ("#a8541b", "#e2914a", "#f5cf92"),
    ("#5d3f8f", "#9474c8", "#cdb9ec"),
    ("#9c2f4b", "#d86a81", "#f3b6c0"),
    ("#20707c", "#4fb0b6", "#a9e0dd"),
)

# A turtle around its centre, looking along +x (px). A flipper is a curve from its first place to its last, bent towards
# the two between. An ellipse is its middle, half its length and half its breadth. A circle ends in its radius.
Place = tuple[float, float]
FLIPPERS: tuple[tuple[Place, ...], ...] = (
    ((12, 5), (20, 21), (5, 30), (1, 11)),
    ((-5, 9), (-9, 23), (-23, 19), (-14, 4)),
)
TAIL: tuple[Place, ...] = ((-14, 3), (-22, 0), (-14, -3))
PLATE: tuple[Place, ...] = ((6, 0), (3, 4.6), (-3, 4.6), (-6, 0), (-3, -4.6), (3, -4.6))
HEAD, SHELL = (19.5, 7.2, 6), (0, 15.3, 13)
EYE, PUPIL = (22, 3.5, 1.9), (22.6, 3.6, 1.1)

#: Space around the world for its axes and caption (px).
LEFT, TOP, RIGHT, BOTTOM = 26, 30, 10, 26
LINE = "#16301f"
#: What is farther outside than this (units) is drawn as if it were here.
_FAR = 1e4


def still_svg(world: WorldPicture, key: str) -> str:
    """Return the world as it is now: an SVG element for a page that gives the class `key` + "i" the colour of text,
    and dims `key` + "b" in the dark."""
    width, height = sizes(world)
    return f'<svg viewBox="0 0 {width} {height}">{framed(world, key, still_content(world, key))}</svg>'


def still_content(world: WorldPicture, key: str) -> str:
    """Return what is within the world's frame as it is now."""
    trails = "".join(path(stroke.points, stroke.color, stroke.width, "", world.size) for stroke in world.trails)
    turtles = "".join(turtle_mark(turtle, coat, "", world.size) for coat, turtle in enumerate(world.turtles))
    names = "".join(turtle_name(turtle, "", world.size) for turtle in named(world))
    return ground(world, key) + trails + turtles + names


def framed(world: WorldPicture, key: str, content: str) -> str:
    """Return the world's axes and caption, and within its frame this content."""
    side = _side(world)
    return f'{axes(world, key)}<svg x="{LEFT}" y="{TOP}" width="{side}" height="{side}">{content}</svg>'


def _side(world: WorldPicture) -> int:
    return round(world.size * PIXELS_PER_UNIT)


def sizes(world: WorldPicture) -> tuple[int, int]:
    """Return the width and height of the whole picture (px)."""
    side = _side(world)
    return LEFT + side + RIGHT, TOP + side + BOTTOM


def position(x: float, y: float, size: float) -> tuple[float, float]:
    """Pixels from the upper left corner; what is very far outside is as far as SVG can draw."""
    x, y = (max(-_FAR, min(part, _FAR)) for part in (x, y))
    return x * PIXELS_PER_UNIT, (size - y) * PIXELS_PER_UNIT


def path(points: Sequence[tuple[float, float]], color: Color, width: int, more: str, size: float) -> str:
    """A polyline, each point relative to the one before it."""
    places = [tuple(round(part, 1) for part in position(x, y, size)) for x, y in points]
    steps = "".join(
        f"l{coord(b[0] - a[0])} {coord(b[1] - a[1])}".replace(" -", "-") for a, b in pairwise(places) if a != b
    )
    start = " ".join(map(coord, places[0])) if places else "0 0"
    look = 'fill="none" stroke="#{:02x}{:02x}{:02x}" stroke-linejoin="round"'.format(*color)
    return f'<path d="M{start}{steps}" {look} stroke-width="{width}"{more}/>'


def turtle_mark(turtle: TurtlePicture, coat: int, name: str, size: float) -> str:
    """A turtle around its centre, looking along +x, put to its place; `name` is the class that moves it."""
    shell, plate, skin = COATS[coat % len(COATS)]
    limbs = "".join(_drawn("C", flipper, side) for flipper in FLIPPERS for side in (1, -1))
    eyes = "".join(
        f'<circle cx="{x}" cy="{side * y}" r="{radius}"{fill}/>'
        for side in (1, -1)
        for (x, y, radius), fill in ((EYE, ' fill="#fff"'), (PUPIL, ""))
    )
    head, body = (f'<ellipse cx="{x}" rx="{wide}" ry="{high}"' for x, wide, high in (HEAD, SHELL))
    x, y = position(turtle.x, turtle.y, size)
    place = f"translate({coord(x)} {coord(y)})rotate({coord(-math.degrees(turtle.theta), 0)})"
    moving = f' class="{name}"' if name else ""
    return (
        f'<g{moving} transform="{place}" fill="{LINE}">'
        f'<g fill="{skin}" stroke="{LINE}" stroke-width=".8">{_drawn("L", TAIL)}{limbs}'
        f'{head}/>{body} fill="{shell}"/></g><g fill="{plate}">{_drawn("L", PLATE)}</g>{eyes}</g>'
    )


def named(world: WorldPicture) -> Sequence[TurtlePicture]:
    """Return the turtles whose names are written next to them: where there is one, the caption has its name."""
    return world.turtles if len(world.turtles) > 1 else ()


def turtle_name(turtle: TurtlePicture, name: str, size: float) -> str:
    """A turtle's name, readable on any background; `name` is the class that moves it."""
    x, y = name_position(turtle.x, turtle.y, size)
    moving = f' class="{name}"' if name else ""
    look = f'fill="#fff" stroke="{LINE}" stroke-width="3" paint-order="stroke" font-size="13" text-anchor="middle"'
    return f'<text{moving} transform="translate({coord(x)} {coord(y)})" {look}>{escape(turtle.name)}</text>'


def name_position(x: float, y: float, size: float) -> tuple[float, float]:
    """Where a turtle's name begins to be written (px): below it, or above it near the lower wall."""
    middle, base = position(min(max(x, 0.6), size - 0.6), y, size)
    return middle, base + (42 if y > 1.2 else -32)


def _drawn(command: str, places: Sequence[Place], side: int = 1) -> str:
    first, *others = (f"{x} {side * y}" for x, y in places)
    return f'<path d="M{first}{command}{" ".join(others)}z"/>'


def ground(world: WorldPicture, key: str) -> str:
    side = _side(world)
    lines = "".join(
        f"M0 {coord(side - n * PIXELS_PER_UNIT)}H{side}M{coord(n * PIXELS_PER_UNIT)} 0V{side}" for n in _marks(world)
    )
    fill = "#{:02x}{:02x}{:02x}".format(*world.background)
    square = f'<path class="{key}b" d="M0 0H{side}V{side}H0z" fill="{fill}"/>'
    return f'{square}<path d="{lines}" stroke="#fff" stroke-opacity=".13"/>'


def _marks(world: WorldPicture) -> range:
    return range(0, math.floor(world.size) + 1, 2 if world.size < 30 else 10)


def axes(world: WorldPicture, key: str) -> str:
    side = _side(world)
    texts = []
    for n in _marks(world):
        at = n * PIXELS_PER_UNIT
        texts.append(f'<text x="{LEFT + at}" y="{TOP + side + 18}" text-anchor="middle">{n}</text>')
        texts.append(f'<text x="{LEFT - 6}" y="{TOP + side - at + 5}" text-anchor="end">{n}</text>')
    text = escape(caption(world))
    return f'<g class="{key}i" font-size="14">{"".join(texts)}<text x="{LEFT}" y="20" font-size="15">{text}</text></g>'
