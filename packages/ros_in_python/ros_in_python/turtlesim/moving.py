"""The turtles' world as an animated SVG of a few KB, in which the turtles drive and draw again."""

from __future__ import annotations

import hashlib
import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import groupby, pairwise

from ros_in_python.animation import Cycle, coord, on_paper
from ros_in_python.thinning import thinned
from ros_in_python.turtlesim.events import DT, PIXELS_PER_UNIT, Pen
from ros_in_python.turtlesim.trail import HEADING_TOLERANCE, PLACE_TOLERANCE, TrackSample
from ros_in_python.turtlesim.trail import thinned as thinned_track
from ros_in_python.turtlesim.world_picture import TrackPicture, WorldPicture, caption
from ros_in_python.turtlesim.world_svg import (
    framed,
    ground,
    name_position,
    named,
    path,
    position,
    sizes,
    still_content,
    turtle_mark,
    turtle_name,
)

#: A wait of all turtles that is longer is shown as this long (s).
LONGEST_WAIT_S = 0.6
#: The world's colour is loud: it is on a quiet panel.
PANEL = "<style>.{key}p{{fill:#f4f7f6}}@media(prefers-color-scheme:dark){{.{key}p{{fill:#17211f}}}}</style>"
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
    """Return the timeline of these tracks; it has no spans if none moves."""
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


# At the pace at which it was driven, then a rest, then again. In print, and for readers who prefer no motion, it is
# still: every trail drawn, the turtles where they are now.


#: Samples of all tracks together; more are thinned until this many are left, which costs precision.
MOST_SAMPLES = 200
#: Trails that are drawn as one sees; where they are more, they are there from the beginning.
MOST_TRAILS = 30


def world_svg(world: WorldPicture, *, moves: bool = True) -> str:
    """Return the picture, the same for the same world. If `moves`, the turtles that have moved drive again."""
    key = "t" + hashlib.sha256(world.to_json().encode()).hexdigest()[:8]
    tracks, error = _few(world.tracks if moves else ())
    times = timeline([track.samples for track in tracks])
    if times.spans:
        rules, content = _moving_content(world, tracks, times, key)
        words = _words(world, times, error)
    else:
        rules, content, words = "", still_content(world, key), caption(world)
    whole = PANEL.format(key=key) + rules + framed(world, key, content)
    title = "The turtle's way" if len(world.turtles) == 1 else "The turtles' ways"
    return on_paper(whole, *sizes(world), key, title, words)


def _moving_content(
    world: WorldPicture, tracks: Sequence[TrackPicture], times: AnimationSchedule, key: str
) -> tuple[str, str]:
    """Return the style that moves, and what is within the world's frame."""
    cycle = Cycle(key, times.seconds)
    trails = [(track.turtle, list(run)) for track in tracks for run in _drawn(track.samples)]
    rules, content = [], [ground(world, key)]
    if not all(track.whole for track in tracks):
        content += [path(list(stroke.points), stroke.color, stroke.width, "", world.size) for stroke in world.trails]
    for index, (_, samples) in enumerate(sorted(trails, key=lambda trail: trail[1][0].tick)):
        name = f"l{index}" if len(trails) <= MOST_TRAILS else ""
        content.append(_trail(samples, key + name if name else "", world.size))
        if name:
            rules.append(cycle.keyframes(name, _drawing(samples, times)))
    moved = {track.turtle: track for track in tracks}
    for coat, turtle in enumerate(world.turtles):
        track = moved.get(turtle.name)
        content.append(turtle_mark(turtle, coat, f"{key}m{coat}" if track else "", world.size))
        if track:
            rules.append(cycle.keyframes(f"m{coat}", _driving(track.samples, times, world.size)))
    for number, turtle in enumerate(named(world)):
        track = moved.get(turtle.name)
        content.append(turtle_name(turtle, f"{key}n{number}" if track else "", world.size))
        if track:
            rules.append(cycle.keyframes(f"n{number}", _following(track.samples, times, world.size)))
    return cycle.style(*rules), "".join(content)


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
        x, y = position(sample.x, sample.y, size)
        turn = coord(-math.degrees(sample.theta), 0)
        frames.append((times.shown(sample.tick), f"transform:translate({coord(x)}px,{coord(y)}px)rotate({turn}deg)"))
    return frames


def _following(samples: Sequence[TrackSample], times: AnimationSchedule, size: float) -> list[tuple[float, str]]:
    """A turtle's name stays next to it, and upright."""
    places = [(times.shown(sample.tick), *name_position(sample.x, sample.y, size)) for sample in samples]
    return [(time, f"transform:translate({coord(x)}px,{coord(y)}px)") for time, x, y in places]


def _trail(samples: Sequence[TrackSample], name: str, size: float) -> str:
    pen = _pen(samples)
    length = coord(math.ceil(_lengths(samples)[-1]) + pen.width, 0)
    dash = f' class="{name}" stroke-dasharray="{length}"' if name else ""
    return path([(sample.x, sample.y) for sample in samples], (pen.r, pen.g, pen.b), pen.width, dash, size)


def _words(world: WorldPicture, times: AnimationSchedule, error: float) -> str:
    pace = "at the original speed" if times.faster == 1 else f"{times.faster} times the original speed"
    return (
        f"{caption(world)}. The way is shown within {coord(error, 2)} units, {pace}, "
        f"{times.seconds:.0f} seconds, again and again."
    )
