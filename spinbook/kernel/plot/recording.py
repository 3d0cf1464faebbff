"""What the recorder has recorded so far, as curves, and when a recording is over."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from typing import Any

from spinbook.kernel.plot.quantity import PlotQuantity
from spinbook.kernel.recorder_lines import read_lines


@dataclass
class PlotCurve:
    """One quantity over time: `times` and `values` have the same length; times in s, on the messages' own clock."""

    quantity: PlotQuantity
    times: list[float] = field(default_factory=list)
    values: list[float] = field(default_factory=list)


@dataclass
class PlotRecording:
    """Curves, and the paths without a topic yet. `topics` are those found, in the order of the paths."""

    curves: dict[PlotQuantity, PlotCurve] = field(default_factory=dict)
    waiting: list[str] = field(default_factory=list)
    published: list[str] = field(default_factory=list)
    topics: list[str] = field(default_factory=list)
    error: str | None = None
    is_looking: bool = False
    """Whether the recorder takes part in ROS yet."""

    def take(self, lines: Iterable[str]) -> None:
        """Add lines that the recorder printed."""
        for kind, values in read_lines(lines):
            self.note(kind, *values)

    def note(self, kind: str, *values: Any) -> None:
        """Add one line of the recorder: its kind and values."""
        if kind == "sample":
            *about, when, value = values
            quantity = PlotQuantity(*about)
            curve = self.curves.setdefault(quantity, PlotCurve(quantity))
            curve.times.append(when)
            curve.values.append(value)
        elif kind == "looking":
            self.is_looking = True
        elif kind == "waiting":
            self.waiting, self.published = values
        elif kind == "topics":
            (self.topics,) = values
        elif kind == "error":
            self.error = values[0]

    def in_order(self) -> list[PlotCurve]:
        """Return the curves topic by topic in the order of the paths, whichever topic's message arrived first."""
        places = {topic: place for place, topic in enumerate(self.topics)}
        return sorted(self.curves.values(), key=lambda curve: places.get(curve.quantity.topic, 0))

    def why_empty(self, paths: Sequence[str]) -> str:
        """Return why nothing was recorded for these paths."""
        if self.waiting:
            there = ", ".join(self.published) or "none"
            return f"Nobody publishes {', '.join(self.waiting)}. Topics with a publisher are: {there}."
        return f"{', '.join(paths)}: there is a publisher, but no message arrived."

    @property
    def start(self) -> float:
        """The earliest time (s): not the first sample's where a publisher's clock was put back."""
        return min((min(curve.times) for curve in self.curves.values()), default=0.0)


#: How long the recorder may take to start, and after that a topic's first message to arrive (s).
_STARTING_S = 30.0
APPEAR_S = 7.0


class RecordingTime:
    """Says when a recording is over: its seconds count from the first sample, and waiting for that has a limit, too.

    The recorder's own start does not count as waiting: on a busy machine it may take longer than the recording.
    """

    def __init__(self, seconds: float, now: float, appear_s: float = APPEAR_S) -> None:
        self._seconds, self._appear_s = seconds, appear_s
        self._ends = now + _STARTING_S
        self._is_looking = self._has_samples = False

    def is_over(self, recording: PlotRecording, now: float) -> bool:
        """Return whether the time is over, when polled; `now` is a monotonic clock's time (s)."""
        if recording.is_looking and not self._is_looking:
            self._is_looking, self._ends = True, now + self._appear_s
        if recording.curves and not self._has_samples:
            self._has_samples, self._ends = True, now + self._seconds
        return now > self._ends
