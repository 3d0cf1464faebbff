"""The shapes of a turtle, for matplotlib: those of world_svg.py, around its centre, looking along +x, in units."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

from matplotlib.patches import Circle, Ellipse, PathPatch, Polygon
from matplotlib.patches import Patch as Shape
from matplotlib.path import Path

from ros_in_python.turtlesim.events import PIXELS_PER_UNIT
from ros_in_python.turtlesim.world_svg import COATS, EYE, FLIPPERS, HEAD, LINE, PLATE, PUPIL, SHELL, TAIL, Place

_CURVE = (Path.MOVETO, Path.CURVE4, Path.CURVE4, Path.CURVE4, Path.CLOSEPOLY)


def turtle_shapes(coat: int) -> Iterator[Shape]:
    """Yield the shapes from the lowest to the topmost; `coat` chooses the colours, which repeat."""
    shell, plate, skin = COATS[coat % len(COATS)]
    look: dict[str, Any] = {"edgecolor": LINE, "linewidth": 0.8}
    yield Polygon(_units(TAIL), facecolor=skin, **look)
    for side in (1, -1):
        for flipper in FLIPPERS:
            corners = [(x, side * y) for x, y in _units(flipper)]
            yield PathPatch(Path([*corners, corners[0]], _CURVE), facecolor=skin, **look)
    for (x, wide, high), colour, name in ((HEAD, skin, "head"), (SHELL, shell, "shell")):
        ((middle, _), (width, height)) = _units([(x, 0), (2 * wide, 2 * high)])
        yield Ellipse((middle, 0), width, height, gid=name, facecolor=colour, **look)
    yield Polygon(_units(PLATE), facecolor=plate, linewidth=0)
    for side in (1, -1):
        for (x, y, radius), colour in ((EYE, "white"), (PUPIL, LINE)):
            (place,) = _units([(x, side * y)])
            yield Circle(place, radius / PIXELS_PER_UNIT, facecolor=colour, linewidth=0)


def _units(places: Sequence[Place]) -> list[Place]:
    """Return places given in pixels."""
    return [(x / PIXELS_PER_UNIT, y / PIXELS_PER_UNIT) for x, y in places]
