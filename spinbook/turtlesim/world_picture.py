"""What a picture of the world shows, and the JSON in which the node tells it."""

from __future__ import annotations

import json
import math
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

from spinbook.turtlesim.geometry import SIDE
from spinbook.turtlesim.pen import Pen
from spinbook.turtlesim.trail import Point, Stroke
from spinbook.turtlesim.world import World

Color = tuple[int, int, int]

#: The window's colour where no parameter says otherwise.
BLUE: Color = (69, 86, 255)
#: Digits after the point in what the node tells: 1/200 of a pixel.
_DIGITS = 4


@dataclass(frozen=True)
class TurtlePicture:
    """A turtle: x and y in units (y up), theta in rad, and its pen."""

    name: str
    x: float
    y: float
    theta: float
    pen: Pen


@dataclass(frozen=True)
class StrokePicture:
    """A polyline in units (y up), drawn by `turtle` in a colour (0..255) and width (pixels, 45 a unit)."""

    turtle: str
    color: Color
    width: int
    points: tuple[Point, ...]


@dataclass(frozen=True)
class WorldPicture:
    """The whole world: `size` units wide and high, the turtles, and the strokes in the order to draw them.

    `incomplete` says, where anything of the trail is missing, what and why.
    """

    size: float
    background: Color
    turtles: tuple[TurtlePicture, ...]
    trails: tuple[StrokePicture, ...]
    incomplete: str = ""

    def to_json(self) -> str:
        """As JSON in one line; the same for the same world."""
        told = {
            "size": round(self.size, 6),
            "background": self.background,
            "turtles": [
                {
                    "name": turtle.name,
                    "x": round(turtle.x, _DIGITS),
                    "y": round(turtle.y, _DIGITS),
                    "theta": round(turtle.theta, _DIGITS),
                    "pen": vars(turtle.pen),
                }
                for turtle in self.turtles
            ],
            "trails": [
                {
                    "turtle": stroke.turtle,
                    "color": stroke.color,
                    "width": stroke.width,
                    "points": [[round(x, _DIGITS), round(y, _DIGITS)] for x, y in stroke.points],
                }
                for stroke in self.trails
            ],
            "incomplete": self.incomplete,
        }
        return json.dumps(told, separators=(",", ":"))

    @classmethod
    def from_json(cls, text: str) -> WorldPicture:
        """Read what `to_json` wrote.

        Raises:
            ValueError: if the text is not such a picture.
        """
        try:
            told = json.loads(text)
            return cls(
                size=_number(told["size"]),
                background=_color(told["background"]),
                turtles=tuple(_turtle(turtle) for turtle in told["turtles"]),
                trails=tuple(_stroke(stroke) for stroke in told["trails"]),
                incomplete=str(told.get("incomplete", "")),
            )
        except (KeyError, TypeError, AttributeError, RecursionError) as error:
            raise ValueError(f"not a picture of a turtles' world: {error!r}") from error


def picture_of(world: World, background: Color) -> WorldPicture:
    """The world as it is now."""
    turtles = sorted(world.turtles.values(), key=lambda turtle: turtle.name)
    return WorldPicture(
        size=SIDE,
        background=background,
        turtles=tuple(TurtlePicture(each.name, each.x, each.y, each.theta, each.pen) for each in turtles),
        trails=strokes(world.trail.strokes),
        incomplete="the oldest part of the trail is left out" if world.trail.forgotten else "",
    )


def strokes(drawn: Iterable[Stroke]) -> tuple[StrokePicture, ...]:
    """The strokes of a trail as a picture shows them."""
    return tuple(
        StrokePicture(each.turtle, (each.pen.r, each.pen.g, each.pen.b), each.pen.width, tuple(each.points))
        for each in drawn
    )


def _turtle(told: dict[str, Any]) -> TurtlePicture:
    x, y, theta = (_number(told[key]) for key in ("x", "y", "theta"))
    pen = told["pen"]
    r, g, b = _color([pen["r"], pen["g"], pen["b"]])
    return TurtlePicture(str(told["name"]), x, y, theta, Pen(r, g, b, _byte(pen["width"]), bool(pen["off"])))


def _stroke(told: dict[str, Any]) -> StrokePicture:
    points = tuple((_number(x), _number(y)) for x, y in told["points"])
    return StrokePicture(str(told["turtle"]), _color(told["color"]), _byte(told["width"]), points)


def _number(told: object) -> float:
    if not isinstance(told, int | float) or not math.isfinite(told):
        raise ValueError(f"not a picture of a turtles' world: {told!r} is not a finite number")
    return float(told)


def _byte(told: object) -> int:
    if not isinstance(told, int) or not 0 <= told <= 255:
        raise ValueError(f"not a picture of a turtles' world: {told!r} is not a whole number from 0 to 255")
    return told


def _color(told: list[object]) -> Color:
    r, g, b = (_byte(part) for part in told)
    return (r, g, b)
