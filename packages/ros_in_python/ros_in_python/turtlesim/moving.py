"""The turtles' world as an animated SVG of a few KB, in which the turtles drive and draw again."""

from __future__ import annotations

import hashlib
import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from html import escape
from itertools import groupby, pairwise
from typing import Any

from matplotlib.patches import Circle, Ellipse, PathPatch, Polygon
from matplotlib.patches import Patch as Shape
from matplotlib.path import Path

from ros_in_python.animation import Cycle, coord, on_paper
from ros_in_python.thinning import thinned
from ros_in_python.turtlesim.events import DT, PIXELS_PER_UNIT, Pen
from ros_in_python.turtlesim.trail import HEADING_TOLERANCE, PLACE_TOLERANCE, TrackSample
from ros_in_python.turtlesim.trail import thinned as thinned_track
from ros_in_python.turtlesim.world_picture import Color, TrackPicture, TurtlePicture, WorldPicture, caption

#: A wait of all turtles that is longer is shown as this long (s).
LONGEST_WAIT_S = 0.6
#: A longer animation (s) is shown faster, so that it takes no longer than this.
LONGEST_S = 30.0


@dataclass(frozen=True)
class AnimationSchedule:
    """Spans of ticks in which something moves, and when (s) each is shown; `faster` times as fast as it was."""

    spans: tuple[tuple[int, int], ...]
    starts: tuple[float, ...]
    faster: int

    @property
    def seconds(self) -> float:
        """How long it all takes to show."""
        return self.shown(self.spans[-1][1])

    def shown(self, tick: int) -> float:
        """Return when a tick is shown (s from the beginning)."""
        time = 0.0
        for (first, last), start in zip(self.spans, self.starts, strict=True):
            if tick < first:
                break
            time = start + (min(tick, last) - first) * DT
        return time / self.faster


def timeline(tracks: Sequence[Sequence[TrackSample]]) -> AnimationSchedule:
    """Return the timeline of these tracks, of which at least one moves."""
    spans = _joined(sorted(span for track in tracks for span in _moving(track)))
    starts, time = [], 0.0
    for index, (first, last) in enumerate(spans):
        if index:
            time += min(LONGEST_WAIT_S, (first - spans[index - 1][1]) * DT)
        starts.append(time)
        time += (last - first) * DT
    return AnimationSchedule(tuple(spans), tuple(starts), max(1, math.ceil(time / LONGEST_S)))


def _moving(track: Sequence[TrackSample]) -> list[tuple[int, int]]:
    return [(before.tick, after.tick) for before, after in pairwise(track) if not _still(before, after)]


def _still(before: TrackSample, after: TrackSample) -> bool:
    way = max(abs(after.x - before.x), abs(after.y - before.y))
    return way <= PLACE_TOLERANCE and abs(after.theta - before.theta) <= HEADING_TOLERANCE


def _joined(spans: list[tuple[int, int]]) -> list[tuple[int, int]]:
    joined: list[tuple[int, int]] = []
    for first, last in spans:
        if joined and first <= joined[-1][1]:
            joined[-1] = (joined[-1][0], max(last, joined[-1][1]))
        else:
            joined.append((first, last))
    return joined


#: Shell, its plates, skin: one set for each turtle in turn.
COATS = (
    ("#2c7a46", "#57b368", "#a5dc8c"),
    ("#a8541b", "#e2914a", "#f5cf92"),
    ("#5d3f8f", "#9474c8", "#cdb9ec"),
    ("#9c2f4b", "#d86a81", "#f3b6c0"),
    ("#20707c", "#4fb0b6", "#a9e0dd"),
)


# Half the length and half the breadth of the shell.
_LONG, _BROAD = 0.34, 0.29


def turtle_shapes(coat: int) -> Iterator[Shape]:
    """Return the shapes from the lowest to the topmost; `coat` chooses the colours, which repeat."""
    shell, plate, skin = COATS[coat % len(COATS)]
    yield from _limbs(skin)
    yield from _head(skin)
    yield Ellipse((0, 0), 2 * _LONG, 2 * _BROAD, facecolor=shell, edgecolor=_LINE, linewidth=0.9)
    yield from _plates(plate)


def _limbs(skin: str) -> Iterator[Shape]:
    look: dict[str, Any] = {"facecolor": skin, "edgecolor": _LINE, "linewidth": 0.8}
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
    yield Ellipse((0.43, 0), 0.32, 0.27, gid="head", facecolor=skin, edgecolor=_LINE, linewidth=0.8)
    for side in (1, -1):
        yield Circle((0.485, side * 0.078), 0.046, facecolor="white", edgecolor=_LINE, linewidth=0.5)
        yield Circle((0.5, side * 0.08), 0.024, facecolor=_LINE, linewidth=0)


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


# At the pace at which it was driven, then a rest, then again. In print, and for readers who prefer no motion, it is
# still: every trail drawn, the turtles where they are now.


#: Samples of all tracks together; more are thinned until this many are left, which costs precision.
MOST_SAMPLES = 200
#: Trails that are drawn as one sees; where they are more, they are there from the beginning.
MOST_TRAILS = 30
_LEFT, _TOP, _RIGHT, _BOTTOM = 26, 30, 10, 26
_LINE = "#16301f"


def moving_svg(world: WorldPicture) -> str | None:
    """Return the picture, the same for the same world, or None if no turtle has moved."""
    tracks, error = _few(world.tracks)
    if not tracks:
        return None
    times = timeline([track.samples for track in tracks])
    key = "t" + hashlib.sha256(world.to_json().encode()).hexdigest()[:8]
    cycle = Cycle(key, times.seconds)
    trails = [(track.turtle, list(run)) for track in tracks for run in _drawn(track.samples)]
    rules, content = [], [_ground(world, key)]
    if not all(track.whole for track in tracks):
        content += [_path(list(stroke.points), stroke.color, stroke.width, "", world.size) for stroke in world.trails]
    for index, (_, samples) in enumerate(sorted(trails, key=lambda trail: trail[1][0].tick)):
        name = f"l{index}" if len(trails) <= MOST_TRAILS else ""
        content.append(_trail(samples, key + name if name else "", world.size))
        if name:
            rules.append(cycle.keyframes(name, _drawing(samples, times)))
    moved = {track.turtle: track for track in tracks}
    for coat, turtle in enumerate(world.turtles):
        track = moved.get(turtle.name)
        content.append(_turtle(turtle, coat, f"{key}m{coat}" if track else "", world.size))
        if track:
            rules.append(cycle.keyframes(f"m{coat}", _driving(track.samples, times, world.size)))
    side = round(world.size * PIXELS_PER_UNIT)
    frame = f'<svg x="{_LEFT}" y="{_TOP}" width="{side}" height="{side}">{"".join(content)}</svg>'
    whole = cycle.style(*rules) + _axes(world, key) + frame
    title = "The turtle's way" if len(world.turtles) == 1 else "The turtles' ways"
    words = _words(world, times, error)
    return on_paper(whole, _LEFT + side + _RIGHT, _TOP + side + _BOTTOM, key, title, words)


def _few(tracks: Sequence[TrackPicture]) -> tuple[list[TrackPicture], float]:
    """Return the tracks with few samples, and how far (units) they may be from what was."""
    times, few = 0, list(tracks)
    while sum(len(track.samples) for track in few) > MOST_SAMPLES and times < 12:
        times += 1
        place, heading = PLACE_TOLERANCE * 2**times / 2, HEADING_TOLERANCE * 2**times / 2
        few = [
            TrackPicture(each.turtle, tuple(thinned_track(each.samples, place, heading)), each.whole) for each in tracks
        ]
    return few, PLACE_TOLERANCE * (1 + (2**times / 2 if times else 0))


def _drawn(samples: Sequence[TrackSample]) -> list[list[TrackSample]]:
    """Yield the pieces of a track that one pen drew in one go."""
    runs = []
    for pen, pairs in groupby(pairwise(samples), key=lambda pair: pair[1].pen):
        ways = list(pairs)
        if pen is not None and any((a.x, a.y) != (b.x, b.y) for a, b in ways):
            runs.append([ways[0][0], *(after for _, after in ways)])
    return runs


def _pen(samples: Sequence[TrackSample]) -> Pen:
    pen = samples[-1].pen
    assert pen is not None
    return pen


def _lengths(samples: Sequence[TrackSample]) -> list[float]:
    """Return how much of a trail is drawn (px) at each sample."""
    lengths = [0.0]
    for before, after in pairwise(samples):
        lengths.append(lengths[-1] + PIXELS_PER_UNIT * math.dist((before.x, before.y), (after.x, after.y)))
    return lengths


def _drawing(samples: Sequence[TrackSample], times: AnimationSchedule) -> list[tuple[float, str]]:
    """A dash as long as the trail, pushed along it."""
    whole = math.ceil(_lengths(samples)[-1]) + _pen(samples).width
    drawn = list(zip((times.shown(sample.tick) for sample in samples), _lengths(samples), strict=True))
    return [(time, f"stroke-dashoffset:{coord(whole - done)}") for time, done in thinned(drawn, 1.0)]


def _driving(samples: Sequence[TrackSample], times: AnimationSchedule, size: float) -> list[tuple[float, str]]:
    frames = []
    for sample in samples:
        x, y = _position(sample.x, sample.y, size)
        turn = coord(-math.degrees(sample.theta), 0)
        frames.append((times.shown(sample.tick), f"transform:translate({coord(x)}px,{coord(y)}px)rotate({turn}deg)"))
    return frames


def _position(x: float, y: float, size: float) -> tuple[float, float]:
    """Pixels from the upper left corner."""
    return x * PIXELS_PER_UNIT, (size - y) * PIXELS_PER_UNIT


def _trail(samples: Sequence[TrackSample], name: str, size: float) -> str:
    pen = _pen(samples)
    dash = (
        f' class="{name}" stroke-dasharray="{coord(math.ceil(_lengths(samples)[-1]) + pen.width, 0)}"' if name else ""
    )
    return _path([(sample.x, sample.y) for sample in samples], (pen.r, pen.g, pen.b), pen.width, dash, size)


def _path(points: Sequence[tuple[float, float]], color: Color, width: int, more: str, size: float) -> str:
    """A polyline, each point relative to the one before it."""
    places = [tuple(round(part, 1) for part in _position(x, y, size)) for x, y in points]
    steps = "".join(
        f"l{coord(b[0] - a[0])} {coord(b[1] - a[1])}".replace(" -", "-") for a, b in pairwise(places) if a != b
    )
    start = " ".join(map(coord, places[0])) if places else "0 0"
    look = 'fill="none" stroke="#{:02x}{:02x}{:02x}" stroke-linejoin="round"'.format(*color)
    return f'<path d="M{start}{steps}" {look} stroke-width="{width}"{more}/>'


def _turtle(turtle: TurtlePicture, coat: int, name: str, size: float) -> str:
    """A turtle around its centre, looking along +x, put to its place; `name` is the class that moves it."""
    shell, plate, skin = COATS[coat % len(COATS)]
    limbs = "".join(
        f'<path d="M12 {s * 5}C20 {s * 21} 5 {s * 30} 1 {s * 11}zM-5 {s * 9}C-9 {s * 23}-23 {s * 19}-14 {s * 4}z"/>'
        for s in (1, -1)
    )
    eyes = "".join(
        f'<circle cx="22" cy="{s * 3.5}" r="1.9" fill="#fff"/><circle cx="22.6" cy="{s * 3.6}" r="1.1"/>'
        for s in (1, -1)
    )
    x, y = _position(turtle.x, turtle.y, size)
    place = f"translate({coord(x)} {coord(y)})rotate({coord(-math.degrees(turtle.theta), 0)})"
    moving = f' class="{name}"' if name else ""
    return (
        f'<g{moving} transform="{place}" fill="{_LINE}">'
        f'<g fill="{skin}" stroke="{_LINE}" stroke-width=".8"><path d="M-14 3L-22 0L-14-3z"/>{limbs}'
        f'<ellipse cx="19.5" rx="7.2" ry="6"/><ellipse rx="15.3" ry="13" fill="{shell}"/></g>'
        f'<path d="M6 0L3 4.6H-3L-6 0L-3-4.6H3z" fill="{plate}"/>{eyes}</g>'
    )


def _ground(world: WorldPicture, key: str) -> str:
    side = round(world.size * PIXELS_PER_UNIT)
    lines = "".join(
        f"M0 {coord(side - n * PIXELS_PER_UNIT)}H{side}M{coord(n * PIXELS_PER_UNIT)} 0V{side}" for n in _marks(world)
    )
    ground = "#{:02x}{:02x}{:02x}".format(*world.background)
    return f'<path d="M0 0H{side}V{side}H0z" fill="{ground}"/><path d="{lines}" stroke="#fff" stroke-opacity=".13"/>'


def _marks(world: WorldPicture) -> range:
    return range(0, math.floor(world.size) + 1, 2 if world.size < 30 else 10)


def _axes(world: WorldPicture, key: str) -> str:
    side = round(world.size * PIXELS_PER_UNIT)
    texts = []
    for n in _marks(world):
        at = n * PIXELS_PER_UNIT
        texts.append(f'<text x="{_LEFT + at}" y="{_TOP + side + 18}" text-anchor="middle">{n}</text>')
        texts.append(f'<text x="{_LEFT - 6}" y="{_TOP + side - at + 5}" text-anchor="end">{n}</text>')
    text = escape(caption(world))
    return f'<g class="{key}i" font-size="14">{"".join(texts)}<text x="{_LEFT}" y="20" font-size="15">{text}</text></g>'


def _words(world: WorldPicture, times: AnimationSchedule, error: float) -> str:
    pace = "at the original speed" if times.faster == 1 else f"{times.faster} times the original speed"
    return (
        f"{caption(world)}. The way is shown within {coord(error, 2)} units, {pace}, "
        f"{times.seconds:.0f} seconds, again and again."
    )
