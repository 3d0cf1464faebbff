"""One panel of a plot as SVG: axes, grid, curves, and the names of the curves below it."""

from __future__ import annotations

from collections.abc import Mapping
from html import escape
from itertools import pairwise

from spinbook.animation.keyframes import number, thinned
from spinbook.runtime.plot.figure import COLOURS
from spinbook.runtime.plot.recording import Curve
from spinbook.runtime.plot.scale import Scale, around

#: A curve is drawn within so many pixels of its samples, or coarser, where it would have more points than this.
PRECISION_PX, MOST_POINTS = 0.5, 120
#: Width of a plot, of the axis' numbers, and height of a panel (px).
WIDTH, LEFT, RIGHT, HEIGHT = 420, 50, 10, 150
_DASHES = ("", "7 4", "7 3 1.5 3", "1.5 3")
_GREY = "#808890"
_NAME_CHAR = 6.9


def panel(
    name: str, curves: Mapping[str, Curve], top: float, across: Scale, start: float, key: str
) -> tuple[str, float]:
    """The panel below `top` with curves by label, and where it ends.

    Curves are seen through the clip path `key` + "c"; the class `key` + "x" moves the pointer.
    """
    bottom = top + 24 + HEIGHT
    up = around([value for curve in curves.values() for value in curve.values], bottom, bottom - HEIGHT)
    looks = {label: _look(index) for index, label in enumerate(curves)}
    lines = "".join(
        f'<path d="{_polyline(curve, across, up, start)}" {looks[label]} stroke-linejoin="round"/>'
        for label, curve in curves.items()
    )
    legend, end = _legend(looks, bottom + 38)
    title = f'<text x="{LEFT}" y="{number(top + 17)}">{escape(name)}</text>'
    pointer = f'<path class="{key}x" d="M{LEFT} {number(bottom)}v-{HEIGHT}" stroke="{_GREY}" opacity="0"/>'
    return f'{title}{_axes(across, up)}<g clip-path="url(#{key}c)">{lines}</g>{pointer}{legend}', end


def _look(index: int) -> str:
    colour = COLOURS[index % len(COLOURS)].replace("#000000", _GREY)  # black can't be seen on dark paper
    dash = _DASHES[index // len(COLOURS) % len(_DASHES)]
    return f'stroke="{colour}" fill="none" stroke-width="2"' + (f' stroke-dasharray="{dash}"' if dash else "")


def _axes(across: Scale, up: Scale) -> str:
    grid, texts = "", ""
    for mark in up.marks():
        grid += f"M{LEFT} {number(up.at(mark))}H{WIDTH - RIGHT}"
        texts += f'<text x="{LEFT - 6}" y="{number(up.at(mark) + 4)}" text-anchor="end">{mark:g}</text>'
    for mark in across.marks():
        x = number(across.at(mark))
        grid += f"M{x} {number(up.start)}v-{HEIGHT}"
        unit = " s" if mark == across.marks()[-1] else ""
        texts += f'<text x="{x}" y="{number(up.start + 17)}" text-anchor="middle">{mark:g}{unit}</text>'
    return f'<path d="{grid}" stroke="{_GREY}" stroke-opacity=".3" fill="none"/>{texts}'


def _legend(looks: Mapping[str, str], y: float) -> tuple[str, float]:
    """The names, as many in a row as fit, the first row at `y`; and where they end."""
    x, texts = float(LEFT), ""
    for label, look in looks.items():
        width = 38 + _NAME_CHAR * len(label)
        if x > LEFT and x + width > WIDTH:
            x, y = float(LEFT), y + 18
        texts += f'<path d="M{number(x)} {number(y - 4)}h18" {look}/>'
        texts += f'<text x="{number(x + 23)}" y="{number(y)}">{escape(label)}</text>'
        x += width
    return texts, y + 14


def _polyline(curve: Curve, across: Scale, up: Scale, start: float) -> str:
    """The curve's path, each point told from the one before it."""
    places = [(across.at(time - start), up.at(value)) for time, value in zip(curve.times, curve.values, strict=True)]
    precision = PRECISION_PX
    while len(points := thinned(places, precision)) > MOST_POINTS:
        precision *= 2
    whole = [(round(x, 1), round(y, 1)) for x, y in points]
    steps = (f"l{number(b[0] - a[0])} {number(b[1] - a[1])}".replace(" -", "-") for a, b in pairwise(whole))
    return f"M{number(whole[0][0])} {number(whole[0][1])}{''.join(steps)}"
