"""Draws recordings as SVG of a few KB, in which the curves appear as fast as they were recorded, or which is still."""

from __future__ import annotations

import hashlib
import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from html import escape
from itertools import chain, groupby, pairwise
from operator import itemgetter

from ros_in_python.animation import Cycle, coord, on_paper
from ros_in_python.axis_marks import round_values
from ros_in_python.thinning import thinned
from spinbook.kernel.plot.recording import PlotCurve, PlotRecording

_GREY = "#808890"
#: Distinct in grey and for colour-blind readers (after Okabe and Ito, 2008; grey for black, which dark paper hides).
COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", _GREY)


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
    """Describe the picture, for those who can't see it and for front ends without pictures."""
    lines = []
    for curve in chain.from_iterable(curves.values() for curves in panels(recording).values()):
        quantity = curve.quantity
        drawn = list(filter(_is_drawn, curve.values))
        span = f"{min(drawn):.3f} … {max(drawn):.3f} {quantity.unit}".rstrip() if drawn else "none can be drawn"
        lines.append(f"{quantity.kind} {quantity.label}: {len(curve.values)} samples, {span}")
    return "\n".join(lines)


def _is_drawn(value: float) -> bool:
    """Return whether it is a number, and not so large that differences overflow."""
    return abs(value) < 1e300


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


#: A plot's width (px) in pages, where it has to be small and fits a phone; and in a notebook on its reader's screen.
FOR_PAGES, FOR_NOTEBOOKS = 420, 640
#: A curve is drawn to within this many pixels of its samples.
PRECISION_PX = 0.5
#: Width of the axis' numbers and of the margin on the other side, and height of a panel (px).
LEFT, RIGHT, HEIGHT = 50, 10, 150
GRID = f'stroke="{_GREY}" stroke-opacity=".3" fill="none"'
_DASHES = ("", "7 4", "7 3 1.5 3", "1.5 3")
_NAME_CHAR = 6.9


def panel(
    name: str, curves: Mapping[str, PlotCurve], top: float, across: Scale, start: float, key: str, width: int
) -> tuple[str, float]:
    """Return the panel of these curves below `top`, and where it ends (px).

    Curves are seen through the clip path `key` + "c"; the class `key` + "x" moves the pointer.
    """
    bottom = top + 24 + HEIGHT
    values = [value for curve in curves.values() for value in curve.values if _is_drawn(value)]
    up = around(values or [0.0], bottom, bottom - HEIGHT)
    looks = {label: _look(index) for index, label in enumerate(curves)}
    lines = "".join(
        f'<path d="{_path(curve, across, up, start)}" {looks[label]} {_ROUND}/>' for label, curve in curves.items()
    )
    legend, end = _legend(looks, bottom + 38, width)
    title = f'<text x="{LEFT}" y="{coord(top + 17)}">{escape(name)}</text>'
    pointer = f'<path class="{key}x" d="M{LEFT} {coord(bottom)}v-{HEIGHT}" stroke="{_GREY}" opacity="0"/>'
    return f'{title}{_axes(across, up)}<g clip-path="url(#{key}c)">{lines}</g>{pointer}{legend}', end


def _look(index: int) -> str:
    colour, dash = COLOURS[index % len(COLOURS)], _DASHES[index // len(COLOURS) % len(_DASHES)]
    return f'stroke="{colour}" fill="none" stroke-width="2"' + (f' stroke-dasharray="{dash}"' if dash else "")


def _axes(across: Scale, up: Scale) -> str:
    grid, texts = "", ""
    for mark in up.marks():
        grid += f"M{LEFT} {coord(up.at(mark))}H{across.end:g}"
        texts += f'<text x="{LEFT - 6}" y="{coord(up.at(mark) + 4)}" text-anchor="end">{mark:g}</text>'
    return f'<path d="{grid}" {GRID}/>{texts}{time_axis(across, up.end, up.start)}'


def time_axis(across: Scale, top: float, bottom: float) -> str:
    """Return lines at round times (s), and the times below them."""
    lines = texts = ""
    for mark in (marks := across.marks()):
        x, unit = coord(across.at(mark)), " s" if mark == marks[-1] else ""
        lines += f"M{x} {coord(top)}V{coord(bottom)}"
        texts += f'<text x="{x}" y="{coord(bottom + 17)}" text-anchor="middle">{mark:g}{unit}</text>'
    return f'<path d="{lines}" {GRID}/>{texts}'


def _legend(looks: Mapping[str, str], y: float, room: float) -> tuple[str, float]:
    """Return the names in rows of this width, the first at `y`, and where they end (px); of longer ones, the end."""
    x, texts, most = float(LEFT), "", int((room - LEFT - 23) / _NAME_CHAR)
    for name, look in looks.items():
        label = name if len(name) <= most else f"…{name[1 - most :]}"
        width = 38 + _NAME_CHAR * len(label)
        if x > LEFT and x + width > room:
            x, y = float(LEFT), y + 18
        texts += f'<path d="M{coord(x)} {coord(y - 4)}h18" {look}/>'
        texts += f'<text x="{coord(x + 23)}" y="{coord(y)}">{escape(label)}</text>'
        x += width
    return texts, y + 14


_ROUND = 'stroke-linejoin="round" stroke-linecap="round"'
#: Half the length of the line that shows a single sample (px).
_DOT = 2


def _path(curve: PlotCurve, across: Scale, up: Scale, start: float) -> str:
    """Return the curve's path, with a gap where a value is no finite number; its outline if it has too many points."""
    pieces = list(_pieces(curve, across, up, start))
    drawn = [thinned(piece, PRECISION_PX) for piece in pieces]
    if sum(map(len, drawn)) > across.end:
        drawn = [list(_outline(piece)) for piece in pieces]
    return "".join(map(_polyline, drawn))


def _outline(points: list[tuple[float, float]]) -> Iterator[tuple[float, float]]:
    """Yield the lowest and the highest point of each two pixels, in the order in which they were recorded."""
    for _, column in groupby(points, lambda point: int(point[0] / 2)):
        by_height = sorted(column, key=itemgetter(1))
        yield from sorted({by_height[0], by_height[-1]})


def _pieces(curve: PlotCurve, across: Scale, up: Scale, start: float) -> Iterator[list[tuple[float, float]]]:
    every = zip(curve.times, curve.values, strict=True)
    for is_drawn, samples in groupby(every, lambda sample: _is_drawn(sample[1])):
        if is_drawn:
            yield [(across.at(time - start), up.at(value)) for time, value in samples]


def _polyline(points: list[tuple[float, float]]) -> str:
    """Return these points as a path, each relative to the one before it; a single one as a short line through it."""
    whole = [(round(x, 1), round(y, 1)) for x, y in points]
    steps = (f"l{coord(b[0] - a[0])} {coord(b[1] - a[1])}".replace(" -", "-") for a, b in pairwise(whole))
    return f"M{coord(whole[0][0])} {coord(whole[0][1])}{''.join(steps) or f'm-{_DOT} 0h{2 * _DOT}'}"


#: A longer recording (s) is shown faster, so that it takes no longer than this.
LONGEST_S = 20.0
#: More curves than this do not move: the picture would be large, and nobody could follow.
MOST_CURVES = 12
_TOP = 28


def plot_svg(recording: PlotRecording, title: str = "", *, moves: bool = True) -> str:
    """Return the picture of a recording that has a curve.

    It moves unless it must not, or no time has passed, or there are too many curves. In print, and for readers who
    prefer no motion, the whole curves are shown, still.
    """
    width = FOR_PAGES if moves else FOR_NOTEBOOKS
    curves = recording.in_order()
    end = max(max(curve.times) for curve in curves) - recording.start
    across = Scale(0.0, end or 1.0, LEFT, width - RIGHT)
    name = title or ", ".join(dict.fromkeys(curve.quantity.topic for curve in curves))
    words = in_words(recording)
    shown = repr((name, words, moves, end, [curve.values for curve in curves]))
    key = "p" + hashlib.sha256(shown.encode()).hexdigest()[:8]
    y, drawn = float(_TOP), []
    for kind, by_label in panels(recording).items():
        part, y = panel(kind, by_label, y, across, recording.start, key, width)
        drawn.append(part)
    heading = f'<text x="{LEFT}" y="20" font-size="14" font-weight="600">{escape(name)}</text>'
    content = f'<g class="{key}i" font-size="12">{heading}{"".join(drawn)}</g>'
    faster, pace = shown_faster(end)
    moving = _moving(Cycle(key, end / faster), across, y) if moves and end > 0 and len(curves) <= MOST_CURVES else ""
    if moving:
        words = f"{words}\nThe curves are drawn {pace} they were recorded, again and again."
    window = moving or _window(across, y, key)
    return on_paper(window + content, width, math.ceil(y), key, name, words)


def shown_faster(duration: float) -> tuple[int, str]:
    """Return how many times as fast a recording (s) is shown, as a number and as the words before a clause."""
    faster = max(1, math.ceil(duration / LONGEST_S))
    return faster, "as fast as" if faster == 1 else f"{faster} times as fast as"


def pointer_moves(cycle: Cycle, width: float) -> str:
    """Return the keyframes of the pointer: to the right over this width (px), and gone when it is there."""
    away = f"transform:translateX({width}px)"
    end = [(cycle.moving_s, f"{away};opacity:1"), (cycle.moving_s + 0.2, f"{away};opacity:0")]
    return cycle.keyframes("x", [(0.0, "transform:translateX(0px);opacity:1"), *end])


def _moving(cycle: Cycle, across: Scale, height: float) -> str:
    """Return the window through which the curves are seen, which grows to the right, and the pointers at its edge."""
    rules = cycle.style(
        cycle.keyframes("w", [(0.0, "transform:scaleX(0)"), (cycle.moving_s, "transform:scaleX(1)")]),
        pointer_moves(cycle, across.end - across.start),
        f".{cycle.key}w{{transform-origin:{LEFT}px 0}}",
    )
    return rules + _window(across, height, cycle.key)


def _window(across: Scale, height: float, key: str) -> str:
    place = f'x="{LEFT - 2 * _DOT}" y="0" width="{across.end - across.start + 4 * _DOT:g}" height="{coord(height)}"'
    return f'<clipPath id="{key}c"><rect class="{key}w" {place}/></clipPath>'
