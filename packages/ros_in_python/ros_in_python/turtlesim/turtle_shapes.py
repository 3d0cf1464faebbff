"""The shapes of a turtle, for matplotlib: around its centre, looking along +x, in units."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

from matplotlib.patches import Circle, Ellipse, PathPatch, Polygon
from matplotlib.patches import Patch as Shape
from matplotlib.path import Path

from ros_in_python.turtlesim.world_svg import COATS, LINE

# Half the length and half the breadth of the shell.
_LONG, _BROAD = 0.34, 0.29


def turtle_shapes(coat: int) -> Iterator[Shape]:
    """Return the shapes from the lowest to the topmost; `coat` chooses the colours, which repeat."""
    shell, plate, skin = COATS[coat % len(COATS)]
    yield from _limbs(skin)
    yield from _head(skin)
    yield Ellipse((0, 0), 2 * _LONG, 2 * _BROAD, facecolor=shell, edgecolor=LINE, linewidth=0.9)
    yield from _plates(plate)


def _limbs(skin: str) -> Iterator[Shape]:
    look: dict[str, Any] = {"facecolor": skin, "edgecolor": LINE, "linewidth": 0.8}
    yield Polygon([(-0.31, 0.06), (-0.5, 0.0), (-0.31, -0.06)], **look)
    for side in (1, -1):
        # A front flipper sweeps back from the shoulder, a hind one is short.
        yield _flipper([(0.27, 0.12), (0.44, 0.46), (0.10, 0.66), (0.03, 0.24)], side, look)
        yield _flipper([(-0.12, 0.20), (-0.20, 0.52), (-0.52, 0.42), (-0.30, 0.10)], side, look)


def _flipper(corners: list[tuple[float, float]], side: int, look: dict[str, Any]) -> Shape:
    """Return a leaf from the first corner to the last, bent towards the two between."""
    (a, b, c, d) = [(x, side * y) for x, y in corners]
    path = Path([a, b, c, d, a], [Path.MOVETO, Path.CURVE4, Path.CURVE4, Path.CURVE4, Path.CLOSEPOLY])
    return PathPatch(path, **look)


def _head(skin: str) -> Iterator[Shape]:
    yield Ellipse((0.43, 0), 0.32, 0.27, gid="head", facecolor=skin, edgecolor=LINE, linewidth=0.8)
    for side in (1, -1):
        yield Circle((0.485, side * 0.078), 0.046, facecolor="white", edgecolor=LINE, linewidth=0.5)
        yield Circle((0.5, side * 0.08), 0.024, facecolor=LINE, linewidth=0)


def _plates(plate: str) -> Iterator[Shape]:
    """Return a hexagon in the middle of the shell and a plate beyond each of its sides."""
    look: dict[str, Any] = {"facecolor": plate, "linewidth": 0}
    yield Polygon(_ring(0.40, 6, 0.0), joinstyle="round", **look)
    for n in range(6):
        middle, half = math.radians(60 * n + 30), math.radians(24)
        inner = [_at(0.52, middle - half), _at(0.52, middle + half)]
        outer = [_at(0.86, middle + half * part) for part in (0.8, 0.4, 0.0, -0.4, -0.8)]
        yield Polygon(inner + outer, joinstyle="round", **look)


def _ring(radius: float, corners: int, first: float) -> list[tuple[float, float]]:
    return [_at(radius, first + 2 * math.pi * n / corners) for n in range(corners)]


def _at(radius: float, angle: float) -> tuple[float, float]:
    """Return a place on the shell: 0 is its centre, 1 its rim."""
    return (_LONG * radius * math.cos(angle), _BROAD * radius * math.sin(angle))
