"""The rate of a topic from a few of its messages, without hearing all of them."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

#: A rate is told from at least this long (s).
ENOUGH_S = 0.8
_NS = 1e9
#: First digits that rates of timers have. A rate within 4 % of one is that one: a measured 9.94 Hz is a 10 Hz timer.
_USUAL = (1.0, 1.25, 1.5, 2.0, 2.5, 3.0, 3.3, 4.0, 5.0, 6.0, 6.25, 7.0, 7.5, 8.0, 9.0, 10.0)
_NEAR = 0.04


@dataclass
class _Stream:
    """One publisher's messages: the sequence number and source time stamp (ns) of the first and the last."""

    first: tuple[int, int]
    last: tuple[int, int]


@dataclass
class Counted:
    """The messages of a topic with so many publishers that were heard, told apart by publisher.

    Each publisher numbers its messages, so that what was missed in between is counted too (RTPS 2.5, 8.3.5.4), and
    stamps them when it sends them, so that the time that they took to come does not matter.
    """

    publishers: int = 1
    _streams: list[_Stream] = field(default_factory=list)

    def heard(self, number: int, sent_ns: int) -> None:
        """Take in a message by its sequence number and source time stamp."""
        following = [stream for stream in self._streams if stream.last[0] < number and stream.last[1] <= sent_ns]
        # The next number goes on with a stream. A gap is another publisher while some have not been heard, then loss,
        # in the stream out of which it leaves the fewest.
        nearest = max(following, key=lambda stream: stream.last[0], default=None)
        unheard = len(self._streams) < self.publishers
        if nearest is None or (unheard and number - nearest.last[0] > 1):
            self._streams.append(_Stream((number, sent_ns), (number, sent_ns)))
        else:
            nearest.last = (number, sent_ns)

    def rate_hz(self) -> float | None:
        """Messages a second of all publishers together; None before enough has been heard of each."""
        rates = []
        for stream in self._streams:
            seconds = (stream.last[1] - stream.first[1]) / _NS
            if seconds < ENOUGH_S:
                return None
            rates.append((stream.last[0] - stream.first[0]) / seconds)
        return sum(rates) if rates else None


def rounded(rate_hz: float) -> float:
    """A rate as it is told: two digits, or that of a usual timer where it is one (9.99 and 10.01 are 10)."""
    if not rate_hz > 0 or not math.isfinite(rate_hz):
        return 0.0
    scale = 10.0 ** math.floor(math.log10(rate_hz))
    digits = rate_hz / scale
    usual = min(_USUAL, key=lambda each: abs(digits / each - 1))
    shown = usual if abs(digits / usual - 1) <= _NEAR else round(digits, 1)
    return float(f"{shown * scale:.6g}")
