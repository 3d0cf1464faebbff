"""A picture of the turtles' world as a matplotlib figure, PNG or SVG."""

from __future__ import annotations

import io
import math
from pathlib import Path
from typing import Any

import matplotlib as mpl
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.patheffects import withStroke
from matplotlib.transforms import Affine2D

from grader.files import write_if_changed
from spinbook.turtlesim.geometry import PIXELS_PER_UNIT
from spinbook.turtlesim.moving import turtle_shapes
from spinbook.turtlesim.world_picture import Color, TurtlePicture, WorldPicture, caption

#: The world's side on paper, and the room around it, in inches.
_SIDE_IN, _LEFT, _RIGHT, _BOTTOM, _TOP = 4.4, 0.42, 0.12, 0.36, 0.34
#: Dots per inch of a PNG.
_DPI = 120
_INK = "#3a3f4b"
_POINTS_PER_INCH = 72


def draw(world: WorldPicture) -> Figure:
    """The world as a figure: background, trails in their colours and widths, turtles; axes in units."""
    width, height = _LEFT + _SIDE_IN + _RIGHT, _BOTTOM + _SIDE_IN + _TOP
    figure = Figure(figsize=(width, height), facecolor="white")
    FigureCanvasAgg(figure)
    axes = figure.add_axes((_LEFT / width, _BOTTOM / height, _SIDE_IN / width, _SIDE_IN / height))
    _prepare(axes, world)
    pixel = _SIDE_IN * _POINTS_PER_INCH / world.size / PIXELS_PER_UNIT
    for stroke in world.trails:
        xs, ys = zip(*stroke.points, strict=True) if stroke.points else ((), ())
        axes.plot(
            xs,
            ys,
            color=_shade(stroke.color),
            linewidth=stroke.width * pixel,
            solid_capstyle="projecting",
            solid_joinstyle="round",
        )
    for coat, turtle in enumerate(world.turtles):
        _draw_turtle(axes, turtle, coat)
        if len(world.turtles) > 1:
            _name(axes, turtle, world.size)
    return figure


def save(world: WorldPicture, file: Path) -> None:
    """Write the picture to a .png or .svg, all at once; the same bytes for the same world.

    Raises:
        ValueError: if the name ends in anything else.
        OSError: if the file can't be written.
    """
    kind = file.suffix.lower().removeprefix(".")
    if kind not in ("png", "svg"):
        raise ValueError(f"{file}: a picture's name must end in .png or .svg")
    # Neither dates nor versions nor random ids, or no two pictures would be alike.
    metadata = {"Date": None, "Creator": None} if kind == "svg" else {"Software": None}
    picture = io.BytesIO()
    with mpl.rc_context({"svg.hashsalt": "turtlesim"}):
        draw(world).savefig(picture, format=kind, dpi=_DPI, metadata=metadata)
    write_if_changed(file, picture.getvalue())


def _prepare(axes: Axes, world: WorldPicture) -> None:
    axes.set(xlim=(0, world.size), ylim=(0, world.size), aspect="equal", facecolor=_shade(world.background))
    ticks = range(0, math.floor(world.size) + 1, 2 if world.size < 30 else 10)
    axes.set_xticks(ticks)
    axes.set_yticks(ticks)
    axes.tick_params(labelsize=8, color=_INK, labelcolor=_INK, length=3, width=0.8, pad=2.5)
    for spine in axes.spines.values():
        spine.set(color=_INK, linewidth=0.8)
    axes.grid(color="white", alpha=0.13, linewidth=0.6)
    axes.set_axisbelow(True)
    look: dict[str, Any] = {"fontsize": 8.5, "color": _INK}
    axes.text(1.0, -0.052, "x", transform=axes.transAxes, ha="right", va="center", style="italic", **look)
    axes.text(-0.046, 1.0, "y", transform=axes.transAxes, ha="center", va="top", style="italic", **look)
    axes.set_title(caption(world), loc="left", pad=6, parse_math=False, **look)


def _draw_turtle(axes: Axes, turtle: TurtlePicture, coat: int) -> None:
    place = Affine2D().rotate(turtle.theta).translate(turtle.x, turtle.y) + axes.transData
    for shape in turtle_shapes(coat):
        shape.set_transform(place)
        shape.set_clip_path(axes.patch)
        shape.set_zorder(10 + coat)
        axes.add_artist(shape)


def _name(axes: Axes, turtle: TurtlePicture, size: float) -> None:
    """Write a turtle's name below it, or above it near the lower wall; readable on any background."""
    below = turtle.y > 1.2
    x = min(max(turtle.x, 0.6), size - 0.6)
    axes.text(
        x,
        turtle.y + (-0.62 if below else 0.62),
        turtle.name,
        ha="center",
        va="top" if below else "bottom",
        fontsize=7.5,
        color="white",
        zorder=30,
        parse_math=False,
        path_effects=[withStroke(linewidth=2, foreground=_INK)],
    )


def _shade(color: Color) -> tuple[float, float, float]:
    r, g, b = (part / 255 for part in color)
    return (r, g, b)
