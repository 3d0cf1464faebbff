"""A recording as a moving picture: an SVG of a few KB in which the curves are drawn as fast as they were recorded.

Then a rest, then again. In print, and for readers who prefer no motion, it is still: the whole curves.
"""

from __future__ import annotations

import hashlib
import math
from html import escape

from spinbook.animation.keyframes import Cycle, number
from spinbook.animation.paper import on_paper
from spinbook.runtime.plot.figure import in_words, panels
from spinbook.runtime.plot.panel import LEFT, RIGHT, WIDTH, panel
from spinbook.runtime.plot.recording import Curve, Recording
from spinbook.runtime.plot.scale import Scale

#: What was recorded for longer (s) is shown so many times as fast that it takes no longer.
LONGEST_S = 20.0
#: More curves than this do not move: the picture would be large, and nobody could follow.
MOST_CURVES = 12
_TOP = 28


def moving_plot(recording: Recording, title: str = "") -> str | None:
    """The picture, or None where nothing can move: no time has passed, or there are too many curves."""
    shown = _shown(recording)
    curves = [curve for by_label in shown.values() for curve in by_label.values()]
    end = max((curve.times[-1] for curve in curves), default=recording.start) - recording.start
    if end <= 0 or len(curves) > MOST_CURVES:
        return None
    name = title or ", ".join(dict.fromkeys(curve.quantity.topic for curve in curves))
    words = in_words(recording)
    key = "p" + hashlib.sha256(repr((name, words, [curve.values for curve in curves])).encode()).hexdigest()[:8]
    faster = max(1, math.ceil(end / LONGEST_S))
    y, drawn = float(_TOP), []
    for kind, by_label in shown.items():
        part, y = panel(kind, by_label, y, Scale(0.0, end, LEFT, WIDTH - RIGHT), recording.start, key)
        drawn.append(part)
    heading = f'<text x="{LEFT}" y="20" font-size="14" font-weight="600">{escape(name)}</text>'
    content = _moving(Cycle(key, end / faster), y) + f'<g class="{key}i" font-size="12">{heading}{"".join(drawn)}</g>'
    pace = "as fast as they were recorded" if faster == 1 else f"{faster} times as fast as they were recorded"
    return on_paper(content, WIDTH, math.ceil(y), key, name, f"{words}\nThe curves are drawn {pace}, again and again.")


def _shown(recording: Recording) -> dict[str, dict[str, Curve]]:
    """Axis -> label -> curve, of curves that can be drawn."""
    several_topics = len({quantity.topic for quantity in recording.curves}) > 1
    shown: dict[str, dict[str, Curve]] = {}
    for (kind, unit), curves in panels(recording).items():
        axis = f"{kind.replace('_', ' ')} ({unit})" if unit else kind.replace("_", " ")
        for curve in curves:
            if len(curve.values) > 1 and all(map(math.isfinite, curve.values)):
                label = f"{curve.quantity.topic} {curve.quantity.label}" if several_topics else curve.quantity.label
                shown.setdefault(axis, {})[label] = curve
    return shown


def _moving(cycle: Cycle, height: float) -> str:
    """The window through which the curves are seen, which grows to the right, and the pointers at its edge."""
    key, width = cycle.key, WIDTH - LEFT - RIGHT
    away = f"transform:translateX({width}px)"
    rules = cycle.style(
        cycle.keyframes("w", [(0.0, "transform:scaleX(0)"), (cycle.moving_s, "transform:scaleX(1)")]),
        cycle.keyframes(
            "x",
            [
                (0.0, "transform:translateX(0px);opacity:1"),
                (cycle.moving_s, f"{away};opacity:1"),
                (cycle.moving_s + 0.2, f"{away};opacity:0"),
            ],
        ),
        f".{key}w{{transform-origin:{LEFT}px 0}}",
    )
    window = f'<rect class="{key}w" x="{LEFT}" y="0" width="{width}" height="{number(height)}"/>'
    return f'{rules}<clipPath id="{key}c">{window}</clipPath>'
