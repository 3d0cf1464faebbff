"""What is known of one frame: where it was in its parent, and when."""

from __future__ import annotations

from bisect import bisect_left
from dataclasses import dataclass, field

from tf2_py.exceptions import ExtrapolationException
from tf2_py.rigid_motion import RigidMotion, between

SECOND = 1_000_000_000


@dataclass
class FrameHistory:
    """The transforms of one frame, oldest first: times (ns), parents and motions. A static frame has one, for ever."""

    keep: int
    is_static: bool = False
    authority: str = ""
    times: list[int] = field(default_factory=list)
    parents: list[str] = field(default_factory=list)
    motions: list[RigidMotion] = field(default_factory=list)

    def add(self, time: int, parent: str, motion: RigidMotion) -> str:
        """Add a transform, and forget those that are too old. Return why it was not taken, if so."""
        if self.is_static:
            self.times, self.parents, self.motions = [time], [parent], [motion]
            return ""
        if self.times and time < self.times[-1] - self.keep:
            return f"it is more than {self.keep / SECOND:g} s older than the newest one"
        place = bisect_left(self.times, time)
        if place < len(self.times) and self.times[place] == time:
            return "there is one with the same time already"
        self.times.insert(place, time)
        self.parents.insert(place, parent)
        self.motions.insert(place, motion)
        self._forget()
        return ""

    def _forget(self) -> None:
        expired = bisect_left(self.times, self.times[-1] - self.keep)
        for values in (self.times, self.parents, self.motions):
            del values[:expired]

    @property
    def newest(self) -> int:
        """The time of the newest transform (ns)."""
        return self.times[-1]

    def at(self, time: int) -> tuple[str, RigidMotion]:
        """Return the parent and the motion at a time (ns; 0 is the newest), between two transforms if need be.

        Raises `ExtrapolationException` outside of what is known.
        """
        if self.is_static or time == 0:
            return self.parents[-1], self.motions[-1]
        place = bisect_left(self.times, time)
        if place < len(self.times) and self.times[place] == time:
            return self.parents[place], self.motions[place]
        if place == 0 or place == len(self.times):
            raise ExtrapolationException(self._outside(time))
        before, after = self.times[place - 1], self.times[place]
        if self.parents[place - 1] != self.parents[place]:
            return self.parents[place - 1], self.motions[place - 1]
        ratio = (time - before) / (after - before)
        return self.parents[place], between(self.motions[place - 1], self.motions[place], ratio)

    def _outside(self, time: int) -> str:
        """Say where a time is, beside the times that are known."""
        asked = f"at {time / SECOND:.6f} s"
        if len(self.times) == 1:
            return f"{asked}: extrapolation would be needed, because only {self.newest / SECOND:.6f} s is known"
        if time > self.newest:
            return f"{asked}: extrapolation into the future would be needed, the newest is {self.newest / SECOND:.6f} s"
        return f"{asked}: extrapolation into the past would be needed, the oldest is {self.times[0] / SECOND:.6f} s"
