"""Filters that wait until each of several topics has a message of the same time, or nearly the same."""

from __future__ import annotations

import threading
from collections.abc import Sequence
from itertools import product
from typing import Any

from message_filters.filters import SimpleFilter, time_of


class TimeSynchronizer(SimpleFilter):
    """Calls back with one message of each filter, once all of them have one with exactly the same time stamp.

    Of each filter, the `queue_size` messages with the newest stamps are kept.
    """

    def __init__(self, fs: Sequence[SimpleFilter], queue_size: int) -> None:
        super().__init__()
        self.queue_size = queue_size
        self.lock = threading.Lock()
        self.connectInput(fs)

    def connectInput(self, fs: Sequence[SimpleFilter]) -> None:  # noqa: N802
        """Take the messages of these filters from now on."""
        self.queues: list[dict[int, Any]] = [{} for _ in fs]
        self.input_connections = [
            source.registerCallback(self.add, queue, index)
            for index, (source, queue) in enumerate(zip(fs, self.queues, strict=True))
        ]

    def add(self, msg: Any, my_queue: dict[int, Any], my_queue_index: int | None = None) -> None:
        """Take a message of one filter, and call back with every set that it completes."""
        with self.lock:
            self._keep(msg, time_of(msg, allow_headerless=False).nanoseconds, my_queue)
            complete = set.intersection(*(set(queue) for queue in self.queues))
            sets = [[queue.pop(time) for queue in self.queues] for time in sorted(complete)]
        for messages in sets:
            self.signalMessage(*messages)

    def _keep(self, message: Any, time: int, queue: dict[int, Any]) -> None:
        queue[time] = message
        while len(queue) > self.queue_size:
            del queue[min(queue)]


class ApproximateTimeSynchronizer(TimeSynchronizer):
    """Calls back with one message of each filter whose time stamps are at most `slop` (s) apart.

    With `allow_headerless`, a message without a header has the time at which it arrives.
    """

    def __init__(
        self, fs: Sequence[SimpleFilter], queue_size: int, slop: float, allow_headerless: bool = False
    ) -> None:
        super().__init__(fs, queue_size)
        self.slop = round(slop * 1e9)
        self.allow_headerless = allow_headerless

    def add(self, msg: Any, my_queue: dict[int, Any], my_queue_index: int | None = None) -> None:
        """Take a message of one filter, and call back with the set nearest to it, if it completes one."""
        with self.lock:
            time = time_of(msg, self.allow_headerless).nanoseconds
            self._keep(msg, time, my_queue)
            chosen = self._nearest(time, my_queue)
            messages = [queue.pop(at) for queue, at in zip(self.queues, chosen, strict=True)] if chosen else []
        if messages:
            self.signalMessage(*messages)

    def _nearest(self, time: int, own: dict[int, Any]) -> tuple[int, ...]:
        """Return one time of each queue, no two further apart than `slop`, as near to `time` as can be."""
        choices = [
            [time] if queue is own else [at for at in queue if abs(at - time) <= self.slop] for queue in self.queues
        ]
        sets = (times for times in product(*choices) if max(times) - min(times) <= self.slop)
        return min(sets, key=lambda times: sum(abs(at - time) for at in times), default=())
