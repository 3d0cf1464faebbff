"""Draws recordings: as a figure, and as an animated SVG of a few KB."""

from __future__ import annotations

import hashlib
import io
import math
from collections.abc import Mapping
from dataclasses import dataclass
from html import escape
from itertools import chain, pairwise
from typing import TYPE_CHECKING

from ros_in_python.animation import Cycle, coord, on_paper
from ros_in_python.axis_marks import round_values
from ros_in_python.thinning import thinned
from spinbook.kernel.plot.recording import PlotCurve, PlotRecording

if TYPE_CHECKING:
    from matplotlib.figure import Figure

#: Distinct in grey and for colour-blind readers (after Okabe and Ito, 2008).
COLOURS = ["#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#000000"]
_DASHES = ["-", "--", "-.", ":"]


def draw(recording: PlotRecording, title: str = "") -> Figure:
    """Return a figure of what was recorded. Time counts from the first sample."""
    # Web pages import other parts of this module and have no matplotlib.
    from matplotlib.figure import Figure

    shown = panels(recording)
    figure = Figure(figsize=(8, 1.2 + 2.6 * len(shown)), layout="constrained")
    axes = figure.subplots(len(shown), 1, sharex=True, squeeze=False)[:, 0]
    for axis, (name, curves) in zip(axes, shown.items(), strict=True):
        for number, (label, curve) in enumerate(curves.items()):
            axis.plot(
                [time - recording.start for time in curve.times],
                curve.values,
                color=COLOURS[number % len(COLOURS)],
                linestyle=_DASHES[number // len(COLOURS) % len(_DASHES)],
                linewidth=1.6,
                marker="." if len(curve.times) < 40 else None,
                markersize=4,
                label=label,
            )
        axis.set_ylabel(name)
        axis.grid(alpha=0.3)
        axis.spines[["top", "right"]].set_visible(False)
        axis.margins(x=0.01)
        axis.legend(loc="center left", bbox_to_anchor=(1.0, 0.5), frameon=False, fontsize="small")
    axes[-1].set_xlabel("time (s)")
    figure.suptitle(title or ", ".join(dict.fromkeys(c.quantity.topic for c in recording.in_order())), fontsize=11)
    return figure


def panels(recording: PlotRecording) -> dict[str, dict[str, PlotCurve]]:
    """Return axis -> label -> the curves that share this axis, in the order of the paths."""
    several_topics = len({quantity.topic for quantity in recording.curves}) > 1
    panels: dict[str, dict[str, PlotCurve]] = {}
    for curve in recording.in_order():
        quantity = curve.quantity
        axis = quantity.kind.replace("_", " ") + (f" ({quantity.unit})" if quantity.unit else "")
        label = f"{quantity.topic} {quantity.label}" if several_topics else quantity.label
        panels.setdefault(axis, {})[label] = curve
    return panels


def in_words(recording: PlotRecording) -> str:
    """Describe the figure, for those who can't see it and for front ends without pictures."""
    lines = []
    for curve in chain.from_iterable(curves.values() for curves in panels(recording).values()):
        quantity = curve.quantity
        span = f"{min(curve.values):.3f} … {max(curve.values):.3f} {quantity.unit}".rstrip()
        lines.append(f"{quantity.kind} {quantity.label}: {len(curve.values)} samples, {span}")
    return "\n".join(lines)


def as_png(figure: Figure) -> bytes:
    """Return the figure as a PNG, without the date or the version of what drew it."""
    out = io.BytesIO()
    figure.savefig(out, format="png", dpi=110, metadata={"Software": None})
    return out.getvalue()


@dataclass(frozen=True)
class Scale:
    """`low` is at `start`, `high`, which is greater, at `end` (px)."""

    low: float
    high: float
    start: float
    end: float

    def at(self, value: float) -> float:
        """Return the position of a value (px)."""
        return self.start + (value - self.low) / (self.high - self.low) * (self.end - self.start)

    def marks(self) -> list[float]:
        """Return up to five round values."""
        return round_values(self.low, self.high)


def around(values: list[float], start: float, end: float) -> Scale:
    """Return a scale for these values, with some room beyond the outermost."""
    low, high = min(values), max(values)
    room = (high - low) * 0.06 or abs(high) * 0.1 or 1.0
    return Scale(low - room, high + room, start, end)


#: A curve is drawn to within this many pixels of its samples, or more coarsely if it would have more points than this.
PRECISION_PX, MOST_POINTS = 0.5, 120
#: Width of a plot, of the axis' numbers, and height of a panel (px).
WIDTH, LEFT, RIGHT, HEIGHT = 420, 50, 10, 150
_SVG_DASHES = ("", "7 4", "7 3 1.5 3", "1.5 3")
_GREY = "#808890"
_NAME_CHAR = 6.9


def panel(
    name: str, curves: Mapping[str, PlotCurve], top: float, across: Scale, start: float, key: str
) -> tuple[str, float]:
    """Return the panel of these curves below `top`, and where it ends (px).

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
    title = f'<text x="{LEFT}" y="{coord(top + 17)}">{escape(name)}</text>'
    pointer = f'<path class="{key}x" d="M{LEFT} {coord(bottom)}v-{HEIGHT}" stroke="{_GREY}" opacity="0"/>'
    return f'{title}{_axes(across, up)}<g clip-path="url(#{key}c)">{lines}</g>{pointer}{legend}', end


def _look(index: int) -> str:
    colour = COLOURS[index % len(COLOURS)].replace("#000000", _GREY)  # black can't be seen on dark paper
    dash = _SVG_DASHES[index // len(COLOURS) % len(_SVG_DASHES)]
    return f'stroke="{colour}" fill="none" stroke-width="2"' + (f' stroke-dasharray="{dash}"' if dash else "")


def _axes(across: Scale, up: Scale) -> str:
    grid, texts = "", ""
    for mark in up.marks():
        grid += f"M{LEFT} {coord(up.at(mark))}H{WIDTH - RIGHT}"
        texts += f'<text x="{LEFT - 6}" y="{coord(up.at(mark) + 4)}" text-anchor="end">{mark:g}</text>'
    for mark in across.marks():
        x = coord(across.at(mark))
        grid += f"M{x} {coord(up.start)}v-{HEIGHT}"
        unit = " s" if mark == across.marks()[-1] else ""
        texts += f'<text x="{x}" y="{coord(up.start + 17)}" text-anchor="middle">{mark:g}{unit}</text>'
    return f'<path d="{grid}" stroke="{_GREY}" stroke-opacity=".3" fill="none"/>{texts}'


def _legend(looks: Mapping[str, str], y: float) -> tuple[str, float]:
    """Return the names in rows, the first at `y`, and where they end (px)."""
    x, texts = float(LEFT), ""
    for label, look in looks.items():
        width = 38 + _NAME_CHAR * len(label)
        if x > LEFT and x + width > WIDTH:
            x, y = float(LEFT), y + 18
        texts += f'<path d="M{coord(x)} {coord(y - 4)}h18" {look}/>'
        texts += f'<text x="{coord(x + 23)}" y="{coord(y)}">{escape(label)}</text>'
        x += width
    return texts, y + 14


def _polyline(curve: PlotCurve, across: Scale, up: Scale, start: float) -> str:
    """Return the curve's path, each point relative to the one before it."""
    places = [(across.at(time - start), up.at(value)) for time, value in zip(curve.times, curve.values, strict=True)]
    precision = PRECISION_PX
    while len(points := thinned(places, precision)) > MOST_POINTS:
        precision *= 2
    whole = [(round(x, 1), round(y, 1)) for x, y in points]
    steps = (f"l{coord(b[0] - a[0])} {coord(b[1] - a[1])}".replace(" -", "-") for a, b in pairwise(whole))
    return f"M{coord(whole[0][0])} {coord(whole[0][1])}{''.join(steps)}"


# In print, and for readers who prefer no motion, the whole curves are shown, still.


#: A longer recording (s) is shown faster, so that it takes no longer than this.
LONGEST_S = 20.0
#: More curves than this do not move: the picture would be large, and nobody could follow.
MOST_CURVES = 12
_TOP = 28


def moving_plot(recording: PlotRecording, title: str = "") -> str | None:
    """Return the picture, or None if nothing can move: no time has passed, or there are too many curves."""
    return plot_svg(recording, title) if sum(map(len, _shown(recording).values())) <= MOST_CURVES else None


def plot_svg(recording: PlotRecording, title: str = "") -> str | None:
    """Return the picture, without motion if there are too many curves; None if no time has passed."""
    shown = _shown(recording)
    curves = [curve for by_label in shown.values() for curve in by_label.values()]
    end = max((curve.times[-1] for curve in curves), default=recording.start) - recording.start
    if end <= 0:
        return None
    name = title or ", ".join(dict.fromkeys(curve.quantity.topic for curve in curves))
    words = in_words(recording)
    key = "p" + hashlib.sha256(repr((name, words, [curve.values for curve in curves])).encode()).hexdigest()[:8]
    y, drawn = float(_TOP), []
    for kind, by_label in shown.items():
        part, y = panel(kind, by_label, y, Scale(0.0, end, LEFT, WIDTH - RIGHT), recording.start, key)
        drawn.append(part)
    heading = f'<text x="{LEFT}" y="20" font-size="14" font-weight="600">{escape(name)}</text>'
    content = f'<g class="{key}i" font-size="12">{heading}{"".join(drawn)}</g>'
    if len(curves) <= MOST_CURVES:
        faster, pace = shown_faster(end)
        content = _moving(Cycle(key, end / faster), y) + content
        words = f"{words}\nThe curves are drawn {pace} they were recorded, again and again."
    return on_paper(content, WIDTH, math.ceil(y), key, name, words)


def _shown(recording: PlotRecording) -> dict[str, dict[str, PlotCurve]]:
    """Return the panels with the curves that can be drawn."""
    shown = {
        axis: {label: curve for label, curve in curves.items() if _is_drawn(curve)}
        for axis, curves in panels(recording).items()
    }
    return {axis: curves for axis, curves in shown.items() if curves}


def shown_faster(duration: float) -> tuple[int, str]:
    """Return how many times as fast a recording (s) is shown, as a number and as the words before a clause."""
    faster = max(1, math.ceil(duration / LONGEST_S))
    return faster, "as fast as" if faster == 1 else f"{faster} times as fast as"


def pointer_moves(cycle: Cycle, width: float) -> str:
    """Return the keyframes of the pointer: to the right over this width (px), and gone when it is there."""
    away = f"transform:translateX({width}px)"
    return cycle.keyframes(
        "x",
        [
            (0.0, "transform:translateX(0px);opacity:1"),
            (cycle.moving_s, f"{away};opacity:1"),
            (cycle.moving_s + 0.2, f"{away};opacity:0"),
        ],
    )


def _is_drawn(curve: PlotCurve) -> bool:
    return len(curve.values) > 1 and all(map(math.isfinite, curve.values))


def _moving(cycle: Cycle, height: float) -> str:
    """Return the window through which the curves are seen, which grows to the right, and the pointers at its edge."""
    key, width = cycle.key, WIDTH - LEFT - RIGHT
    rules = cycle.style(
        cycle.keyframes("w", [(0.0, "transform:scaleX(0)"), (cycle.moving_s, "transform:scaleX(1)")]),
        pointer_moves(cycle, width),
        f".{key}w{{transform-origin:{LEFT}px 0}}",
    )
    window = f'<rect class="{key}w" x="{LEFT}" y="0" width="{width}" height="{coord(height)}"/>'
    return f'{rules}<clipPath id="{key}c">{window}</clipPath>'
