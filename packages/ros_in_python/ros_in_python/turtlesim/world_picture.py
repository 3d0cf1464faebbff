"""What a picture of the world shows, and the JSON in which the node sends it."""

from __future__ import annotations

import json
import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any

from ros_in_python.turtlesim.events import SIDE, Pen
from ros_in_python.turtlesim.trail import Point, Stroke, Track, TrackSample, moves
from ros_in_python.turtlesim.world import TurtleWorld

Color = tuple[int, int, int]

#: The window's colour, unless parameters change it.
BLUE: Color = (69, 86, 255)
#: More turtles than this are not described one by one.
_MOST_DESCRIBED = 2
#: Digits after the point in what the node reports: 1/200 of a pixel.
_DIGITS = 4
#: In tracks: half a tenth of a pixel.
_TRACK_DIGITS = 3


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
    """A polyline in units (y up), drawn by `turtle` in a colour (0..255) and width (pixels, 45 per unit)."""

    turtle: str
    color: Color
    width: int
    points: tuple[Point, ...]


@dataclass(frozen=True)
class TrackPicture:
    """The path of `turtle` over time. `whole` is False if its oldest part was dropped."""

    turtle: str
    samples: tuple[TrackSample, ...]
    whole: bool


@dataclass(frozen=True)
class WorldPicture:
    """The whole world: `size` units wide and high, the turtles, and the strokes in the order to draw them.

    `tracks` tell how the turtles that have moved came there.
    `incomplete` says, where anything of the trail is missing, what and why.
    """

    size: float
    background: Color
    turtles: tuple[TurtlePicture, ...]
    trails: tuple[StrokePicture, ...]
    incomplete: str = ""
    tracks: tuple[TrackPicture, ...] = ()

    def to_json(self) -> str:
        """Return JSON in one line, the same for the same world."""
        text = {
            **vars(self),
            "turtles": [vars(turtle) | {"pen": vars(turtle.pen)} for turtle in self.turtles],
            "trails": [vars(stroke) for stroke in self.trails],
            "tracks": [_track_as_json(track) for track in self.tracks],
        }
        return json.dumps(text, separators=(",", ":"))

    @classmethod
    def from_json(cls, text: str) -> WorldPicture:
        """Read what `to_json` wrote.

        Raises:
            ValueError: if the text is not such a picture.
        """
        try:
            message = json.loads(text)
            return cls(
                size=_number(message["size"]),
                background=_color(message["background"]),
                turtles=tuple(_turtle(turtle) for turtle in message["turtles"]),
                trails=tuple(_stroke(stroke) for stroke in message["trails"]),
                incomplete=str(message.get("incomplete", "")),
                tracks=tuple(_track(track) for track in message.get("tracks", ())),
            )
        except (KeyError, TypeError, AttributeError, RecursionError) as error:
            raise ValueError(f"not a picture of a turtles' world: {error!r}") from error


def picture_of(world: TurtleWorld, background: Color) -> WorldPicture:
    """Return the world as it is now."""
    turtles = sorted(world.turtles.values(), key=lambda turtle: turtle.name)
    return WorldPicture(
        size=round(SIDE, 6),
        background=background,
        turtles=tuple(TurtlePicture(each.name, *_rounded(each.x, each.y, each.theta), each.pen) for each in turtles),
        trails=strokes(world.trail.strokes),
        incomplete="the oldest part of the trail is left out" if world.trail.forgotten else "",
        tracks=tracks(world.tracks),
    )


def _rounded(x: float, y: float, theta: float) -> tuple[float, float, float]:
    return round(x, _DIGITS), round(y, _DIGITS), round(theta, _DIGITS)


def tracks(by_turtle: Mapping[str, Track]) -> tuple[TrackPicture, ...]:
    """Return the tracks of the turtles that have moved, as a picture shows them."""
    return tuple(
        TrackPicture(name, tuple(track.samples), not track.forgotten)
        for name, track in sorted(by_turtle.items())
        if moves(track.samples)
    )


def caption(world: WorldPicture) -> str:
    """Return where the turtles are, in words, and what the picture lacks."""
    if not world.turtles:
        text = "no turtle"
    elif len(world.turtles) > _MOST_DESCRIBED:
        text = f"{len(world.turtles)} turtles"
    else:
        text = "     ".join(_describe(turtle) for turtle in world.turtles)
    return f"{text}   ({world.incomplete})" if world.incomplete else text


def _describe(turtle: TurtlePicture) -> str:
    return f"{turtle.name}:  x {turtle.x:.2f}   y {turtle.y:.2f}   heading {math.degrees(turtle.theta):.0f}°"


def strokes(drawn: Iterable[Stroke]) -> tuple[StrokePicture, ...]:
    """Return the strokes of a trail as a picture shows them."""
    return tuple(
        StrokePicture(
            each.turtle,
            (each.pen.r, each.pen.g, each.pen.b),
            each.pen.width,
            tuple((round(x, _DIGITS), round(y, _DIGITS)) for x, y in each.points),
        )
        for each in drawn
    )


def _turtle(text: dict[str, Any]) -> TurtlePicture:
    x, y, theta = (_number(text[key]) for key in ("x", "y", "theta"))
    return TurtlePicture(str(text["name"]), x, y, theta, _pen(text["pen"]))


def _stroke(text: dict[str, Any]) -> StrokePicture:
    points = tuple((_number(x), _number(y)) for x, y in text["points"])
    return StrokePicture(str(text["turtle"]), _color(text["color"]), _byte(text["width"]), points)


def _track_as_json(track: TrackPicture) -> dict[str, Any]:
    """Return a track as plain data; samples refer to its pens by number."""
    pens = list(dict.fromkeys(sample.pen for sample in track.samples if sample.pen is not None))
    samples = [
        [
            sample.tick,
            round(sample.x, _TRACK_DIGITS),
            round(sample.y, _TRACK_DIGITS),
            round(sample.theta, _TRACK_DIGITS),
            None if sample.pen is None else pens.index(sample.pen),
        ]
        for sample in track.samples
    ]
    return {"turtle": track.turtle, "pens": [vars(pen) for pen in pens], "samples": samples, "whole": track.whole}


def _track(text: dict[str, Any]) -> TrackPicture:
    pens = [_pen(pen) for pen in text["pens"]]
    samples = []
    for tick, x, y, theta, pen in text["samples"]:
        if not isinstance(tick, int) or not (pen is None or (isinstance(pen, int) and 0 <= pen < len(pens))):
            raise ValueError(
                f"not a picture of a turtles' world: {[tick, x, y, theta, pen]!r} is not a sample of a track"
            )
        drawn = None if pen is None else pens[pen]
        samples.append(TrackSample(tick, _number(x), _number(y), _number(theta), drawn))
    return TrackPicture(str(text["turtle"]), tuple(samples), bool(text["whole"]))


def _pen(text: dict[str, Any]) -> Pen:
    r, g, b = _color([text["r"], text["g"], text["b"]])
    return Pen(r, g, b, _byte(text["width"]), bool(text["off"]))


def _number(text: object) -> float:
    if not isinstance(text, int | float) or not math.isfinite(text):
        raise ValueError(f"not a picture of a turtles' world: {text!r} is not a finite number")
    return float(text)


def _byte(text: object) -> int:
    if not isinstance(text, int) or not 0 <= text <= 255:
        raise ValueError(f"not a picture of a turtles' world: {text!r} is not a whole number from 0 to 255")
    return text


def _color(text: list[object]) -> Color:
    r, g, b = (_byte(part) for part in text)
    return (r, g, b)
