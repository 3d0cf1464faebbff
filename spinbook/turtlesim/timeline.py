"""When what is shown: turtles at their real pace, but long waits cut short."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

from spinbook.turtlesim.geometry import DT
from spinbook.turtlesim.track import HEADING_TOLERANCE, PLACE_TOLERANCE, Sample

#: A wait of all turtles that is longer is shown as this long (s).
LONGEST_WAIT_S = 0.6
#: What would take longer than this (s) is shown so many times as fast that it does not.
LONGEST_S = 30.0


@dataclass(frozen=True)
class Timeline:
    """Spans of ticks in which something moves, and when (s) each is shown; `faster` times as fast as it was."""

    spans: tuple[tuple[int, int], ...]
    starts: tuple[float, ...]
    faster: int

    @property
    def seconds(self) -> float:
        """How long it all takes to show."""
        return self.shown(self.spans[-1][1])

    def shown(self, tick: int) -> float:
        """When a tick is shown (s from the beginning)."""
        time = 0.0
        for (first, last), start in zip(self.spans, self.starts, strict=True):
            if tick < first:
                break
            time = start + (min(tick, last) - first) * DT
        return time / self.faster


def timeline(tracks: Sequence[Sequence[Sample]]) -> Timeline:
    """The timeline of these tracks, of which at least one moves."""
    spans = _joined(sorted(span for track in tracks for span in _moving(track)))
    starts, time = [], 0.0
    for index, (first, last) in enumerate(spans):
        if index:
            time += min(LONGEST_WAIT_S, (first - spans[index - 1][1]) * DT)
        starts.append(time)
        time += (last - first) * DT
    return Timeline(tuple(spans), tuple(starts), max(1, math.ceil(time / LONGEST_S)))


def _moving(track: Sequence[Sample]) -> list[tuple[int, int]]:
    return [(before.tick, after.tick) for before, after in pairwise(track) if not _still(before, after)]


def _still(before: Sample, after: Sample) -> bool:
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
