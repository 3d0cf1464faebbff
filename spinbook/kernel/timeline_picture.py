"""A timeline as a picture: an SVG that moves as fast as the events did.

In print, and for readers who prefer no motion, the SVG shows the whole timeline, still.
"""

from __future__ import annotations

import hashlib
import math
from collections.abc import Iterable, Iterator, Sequence
from html import escape
from itertools import chain
from textwrap import wrap

from ros_in_python.animation import Cycle, coord, on_paper
from spinbook.kernel.plot.picture import Scale, pointer_moves, shown_faster, time_axis
from spinbook.kernel.timeline import Lane, Mark, Span, in_words

#: A lane with more ticks than this is thinned out; otherwise they would merge into a bar.
MOST_TICKS = 150
#: The whole width, where labels and lanes begin, and the margins (px). The upper one has room for a page's Pause.
_WIDTH, _MARGIN, _LEFT, _RIGHT, _TOP = 720, 14, 196, 16, 38
_BAR, _ROW, _GAP, _LABEL_CHARS = 16, 14, 12, 24
_CHAR, _CAPITAL = 6.4, 8.0
_GREY = "#808890"
_SPANS = {"waits": ("#a8b0b8", "waits"), "runs": ("#0072B2", "runs"), "cancels": ("#E69F00", "is being canceled")}
_MARKS = {
    "asked": (_GREY, "goal or request"),
    "cancel": ("#D55E00", "cancel"),
    "answered": ("#009E73", "answer"),
    "good": ("#009E73", ""),
    "bad": ("#D55E00", ""),
}
#: How many pixels a bar is narrower than a lane, above and below.
_INSETS = {"waits": 5, "runs": 2, "cancels": 2}
#: Marks of these kinds have their text next to them, unless the legend explains it.
_WRITTEN = ("good", "bad", "cancel", "answered")
_UNWRITTEN = "response"


def span_of(lanes: Iterable[Lane]) -> tuple[float, float]:
    """Return the first and the last time (s) of anything on the lanes."""
    times = [mark.at for lane in lanes for mark in lane.marks]
    return min(times), max(times)


def timeline_svg(lanes: Sequence[Lane], title: str = "", *, moves: bool = True) -> str:
    """Return an SVG of lanes, at least one of which has a mark. While events are still arriving, it must not move."""
    start, end = span_of(lanes)
    across = Scale(start, max(end, start + 0.1), _LEFT, _WIDTH - _RIGHT)
    words = in_words(lanes, start)
    name = title or ", ".join(dict.fromkeys(lane.name for lane in lanes))
    key = "t" + hashlib.sha256(f"{name} {moves} {lanes}".encode()).hexdigest()[:8]
    heading = f'<text x="{_MARGIN}" y="22" font-size="14" font-weight="600">{escape(title)}</text>'
    y, labels, drawn = float(_TOP), [heading], []
    for lane in lanes:
        for row, line in enumerate(_lines(lane.label)):
            labels.append(
                f'<text x="{_MARGIN}" y="{coord(y + 12 + _ROW * row)}" font-weight="600">{escape(line)}</text>'
            )
        part, y = _lane(lane, y, across)
        drawn.append(part)
    # Times count from the first event.
    grid = time_axis(Scale(0.0, across.high - across.low, across.start, across.end), _TOP, y)
    legend, bottom = _legend(lanes, y + 38)
    faster, pace = shown_faster(end - start)
    moving = _moving(Cycle(key, max(end - start, 0.1) / faster), y) if moves else ""
    pointer = f'<path class="{key}x" d="M{_LEFT} {_TOP}V{coord(y)}" stroke="{_GREY}" opacity="0"/>'
    window = f' clip-path="url(#{key}c)"' if moves else ""
    content = (
        f'{moving}<g class="{key}i" font-size="12">{grid}{"".join(labels)}'
        f"<g{window}>{''.join(drawn)}</g>{pointer}{legend}</g>"
    )
    if moves:
        words = f"{words}\nIt is drawn {pace} it happened, again and again."
    return on_paper(content, _WIDTH, math.ceil(bottom), key, name, words)


def _lines(label: str) -> list[str]:
    return wrap(label, _LABEL_CHARS, max_lines=2, placeholder="…")


def _end(lane: Lane, top: float, rows: int) -> float:
    """Return where a lane with this many rows of texts ends (px)."""
    return top + max(_BAR + _ROW * rows, _ROW * len(_lines(lane.label))) + _GAP


def _lane(lane: Lane, top: float, across: Scale) -> tuple[str, float]:
    """Return the bars, marks and texts of a lane below `top`, and where it ends (px)."""
    middle = top + _BAR / 2
    bars = "".join(_bar(span, top, across) for span in lane.spans)
    marks = "".join(_shape(mark.look, across.at(mark.at), middle) for mark in _few(lane.marks))
    rows, texts = 0, ""
    for text, x, row in _placed(lane.marks, across):
        rows = max(rows, row + 1)
        texts += f'<text x="{coord(x)}" y="{coord(top + _BAR + _ROW * row + 11)}" font-size="11">{escape(text)}</text>'
    return bars + marks + texts, _end(lane, top, rows)


def _bar(span: Span, top: float, across: Scale) -> str:
    x, width = across.at(span.start), max(1.0, across.at(span.end) - across.at(span.start))
    colour, _ = _SPANS[span.look]
    inset = _INSETS[span.look]
    dash = ' stroke-dasharray="4 3" fill-opacity=".15"' if span.open else ' fill-opacity=".45"'
    return (
        f'<rect x="{coord(x)}" y="{coord(top + inset)}" width="{coord(width)}" height="{_BAR - 2 * inset}" '
        f'fill="{colour}" stroke="{colour}"{dash}/>'
    )


def _few(marks: Sequence[Mark]) -> Iterator[Mark]:
    """Return the marks; of too many ticks only every n-th."""
    ticks = [mark for mark in marks if mark.look == "tick"]
    step = math.ceil(len(ticks) / MOST_TICKS) or 1
    return chain(ticks[::step], (mark for mark in marks if mark.look != "tick"))


def _shape(look: str, x: float, y: float) -> str:
    if look == "tick":
        return f'<path d="M{coord(x - 0.6)} {coord(y - 6)}h1.2v12h-1.2z"/>'
    colour, _ = _MARKS[look]
    if look == "asked":
        return f'<path d="M{coord(x - 4)} {coord(y - 6)}l9 6l-9 6z" fill="{colour}"/>'
    if look in ("cancel", "bad"):
        cross = f"M{coord(x - 5)} {coord(y - 5)}l10 10m0-10l-10 10"
        return f'<path d="{cross}" stroke="{colour}" stroke-width="2.6"/>'
    return f'<circle cx="{coord(x)}" cy="{coord(y)}" r="4.5" fill="{colour}"/>'


def _placed(marks: Sequence[Mark], across: Scale) -> Iterator[tuple[str, float, int]]:
    """Yield (text, x in px, row) for each text, so that no two overlap."""
    ends: list[float] = []
    for mark in (mark for mark in marks if mark.look in _WRITTEN and mark.text not in ("", _UNWRITTEN)):
        width = sum(_CAPITAL if char.isupper() else _CHAR for char in mark.text)
        x = min(max(across.at(mark.at) - width / 2, _LEFT), _WIDTH - 4 - width)
        row = next((row for row, end in enumerate(ends) if end + 6 <= x), len(ends))
        ends[row : row + 1] = [x + width]
        yield mark.text, x, row


def _legend(lanes: Sequence[Lane], y: float) -> tuple[str, float]:
    """Return the legend of the bars and marks in use, and where it ends (px)."""
    spans = {span.look for lane in lanes for span in lane.spans}
    marks = {mark.look for lane in lanes for mark in lane.marks}
    entries: list[tuple[str, str]] = [(look, text) for look, (_, text) in _SPANS.items() if look in spans]
    entries += [(look, text) for look, (_, text) in _MARKS.items() if look in marks and text]
    entries += [("tick", "feedback" if spans and not _plain_ticks(lanes) else "message")] if "tick" in marks else []
    x, drawn = float(_MARGIN), ""
    for look, text in entries:
        width = 34 + _CHAR * len(text)
        if x > _MARGIN and x + width > _WIDTH:
            x, y = float(_MARGIN), y + 18
        drawn += _in_legend(look, x, y)
        drawn += f'<text x="{coord(x + 21)}" y="{coord(y)}" font-size="11">{escape(text)}</text>'
        x += width
    return drawn, y + 12


def _in_legend(look: str, x: float, y: float) -> str:
    """Return a bar or a mark as the legend shows it, left of a text at `y`."""
    if look not in _SPANS:
        return _shape(look, x + 8, y - 4)
    colour, _ = _SPANS[look]
    place = f'x="{coord(x)}" y="{coord(y - 8)}" width="16" height="8"'
    return f'<rect {place} fill="{colour}" fill-opacity=".45" stroke="{colour}"/>'


def _plain_ticks(lanes: Sequence[Lane]) -> bool:
    """Return whether a lane is a topic's, so that its ticks are messages."""
    return any(not lane.spans and any(mark.look == "tick" for mark in lane.marks) for lane in lanes)


def _moving(cycle: Cycle, height: float) -> str:
    """Return the window through which the lanes are seen, which grows to the right, and the pointer at its edge."""
    key, width = cycle.key, _WIDTH - _LEFT - _RIGHT
    shown = f"transform:scaleX({coord(_LEFT / _WIDTH, 4)})"
    last = f"transform:scaleX({coord(1 - _RIGHT / _WIDTH, 4)})"
    rules = cycle.style(
        cycle.keyframes("w", [(0.0, shown), (cycle.moving_s, last), (cycle.moving_s + 0.1, "transform:scaleX(1)")]),
        pointer_moves(cycle, width),
        f".{key}w{{transform-origin:0 0}}",
    )
    window = f'<rect class="{key}w" x="0" y="0" width="{_WIDTH}" height="{coord(height)}"/>'
    return f'{rules}<clipPath id="{key}c">{window}</clipPath>'
