"""How a class's points are spread, as numbers and as a histogram."""

from __future__ import annotations

import statistics
from collections.abc import Sequence
from dataclasses import dataclass

from grader.pages.rendering import points

BINS = 10

#: In units of the picture.
WIDTH, HEIGHT, TOP, BOTTOM, GAP = 640.0, 200.0, 24.0, 26.0, 6.0


@dataclass(frozen=True)
class Bar:
    """One bar of the histogram: how many students got from `low` to `high` points, and where it is drawn."""

    low: float
    high: float
    count: int
    x: float
    y: float
    width: float
    height: float


@dataclass(frozen=True)
class Distribution:
    """What may be said of the points of a class."""

    count: int
    mean: float
    median: float
    full: int
    bars: tuple[Bar, ...]
    said: str


def distribution(scores: Sequence[float], most: float) -> Distribution | None:
    """The distribution of `scores`, of which `most` is full marks; None of an empty class.

    Ten bins of one width; the last holds full marks, and whoever has more.
    """
    if not scores:
        return None
    counts = [0] * BINS
    for score in scores:
        counts[min(BINS - 1, int(BINS * score / most))] += 1
    bars = tuple(_bar(i, count, max(counts), most) for i, count in enumerate(counts))
    told = [f"{bar.count} from {points(bar.low)} to {points(bar.high)}" for bar in bars if bar.count]
    return Distribution(
        count=len(scores),
        mean=statistics.fmean(scores),
        median=statistics.median(scores),
        full=sum(score >= most for score in scores),
        bars=bars,
        said=f"Histogram of {len(scores)} students' points: " + ", ".join(told) + ".",
    )


def _bar(i: int, count: int, highest: int, most: float) -> Bar:
    width = WIDTH / BINS
    height = (HEIGHT - TOP - BOTTOM) * count / highest
    y = HEIGHT - BOTTOM - height
    return Bar(
        i * most / BINS, (i + 1) * most / BINS, count, i * width + GAP / 2, round(y, 1), width - GAP, round(height, 1)
    )
