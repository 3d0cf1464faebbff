"""Where messages come from: a topic, or the last ones that another filter gave."""

from __future__ import annotations

from bisect import bisect_left, bisect_right, insort
from collections.abc import Callable
from typing import Any

from rclpy.clock import ROSClock
from rclpy.node import Node
from rclpy.time import Time


class SimpleFilter:
    """Gives each message to the callbacks that are registered with it."""

    def __init__(self) -> None:
        self.callbacks: dict[int, tuple[Callable[..., Any], tuple[Any, ...]]] = {}
        self._count = 0

    def registerCallback(self, cb: Callable[..., Any], *args: Any) -> int:  # noqa: N802
        """Call `cb(message, *args)` with each message from now on. Return a number for the connection."""
        self._count += 1
        self.callbacks[self._count] = (cb, args)
        return self._count

    def signalMessage(self, *msg: Any) -> None:  # noqa: N802
        """Call all registered callbacks with these messages."""
        for callback, arguments in list(self.callbacks.values()):
            callback(*msg, *arguments)


class Subscriber(SimpleFilter):
    """A subscription. The arguments after the node are those of `create_subscription`, without the callback."""

    def __init__(self, node: Node, *args: Any, **kwargs: Any) -> None:
        super().__init__()
        self.node = node
        self.topic = args[1] if len(args) > 1 else kwargs.get("topic")
        options = {"qos_profile": 10, **kwargs, "callback": self.callback}
        self.sub = node.create_subscription(*args, **options)

    def callback(self, msg: Any) -> None:
        """Give a message on."""
        self.signalMessage(msg)

    def getTopic(self) -> Any:  # noqa: N802
        """Return the topic's name as it was given."""
        return self.topic


def time_of(message: Any, allow_headerless: bool) -> Time:
    """Return a message's time stamp; without a header, the current time, if that is allowed."""
    stamp = getattr(getattr(message, "header", None), "stamp", None)
    if stamp is not None:
        return Time.from_msg(stamp)
    if not allow_headerless:
        raise TypeError(
            f"{type(message).__name__} has no header with a time stamp. Give allow_headerless=True to take the time at "
            "which it arrives."
        )
    return ROSClock().now()


class Cache(SimpleFilter):
    """Keeps the last `cache_size` messages of another filter, by their time stamps, and gives them on."""

    def __init__(self, f: SimpleFilter | None = None, cache_size: int = 1, allow_headerless: bool = False) -> None:
        super().__init__()
        self.cache_size = cache_size
        self._allow_headerless = allow_headerless
        self._stamped: list[tuple[int, int, Any]] = []
        self._arrivals = 0
        if f is not None:
            self.connectInput(f)

    def connectInput(self, f: SimpleFilter) -> None:  # noqa: N802
        """Take the messages of another filter from now on."""
        f.registerCallback(self.add)

    def add(self, msg: Any) -> None:
        """Keep a message, forget the oldest if there are too many, and give the message on."""
        self._arrivals += 1
        insort(self._stamped, (time_of(msg, self._allow_headerless).nanoseconds, self._arrivals, msg))
        if len(self._stamped) > self.cache_size:
            del self._stamped[0]
        self.signalMessage(msg)

    @property
    def _times(self) -> list[int]:
        return [time for time, _, _ in self._stamped]

    def getInterval(self, from_stamp: Time, to_stamp: Time) -> list[Any]:  # noqa: N802
        """Return the messages between two times, both included."""
        first, last = bisect_left(self._times, from_stamp.nanoseconds), bisect_right(self._times, to_stamp.nanoseconds)
        return [message for _, _, message in self._stamped[first:last]]

    def getElemAfterTime(self, stamp: Time) -> Any:  # noqa: N802
        """Return the oldest message at or after a time; None if there is none."""
        after = self._stamped[bisect_left(self._times, stamp.nanoseconds) :]
        return after[0][2] if after else None

    def getElemBeforeTime(self, stamp: Time) -> Any:  # noqa: N802
        """Return the newest message at or before a time; None if there is none."""
        before = self._stamped[: bisect_right(self._times, stamp.nanoseconds)]
        return before[-1][2] if before else None

    def getLastestTime(self) -> Time | None:  # noqa: N802
        """Return the newest time stamp; None if there is no message. The name is message_filters' own."""
        return Time(nanoseconds=self._stamped[-1][0]) if self._stamped else None

    getLatestTime = getLastestTime  # noqa: N815

    def getOldestTime(self) -> Time | None:  # noqa: N802
        """Return the oldest time stamp; None if there is no message."""
        return Time(nanoseconds=self._stamped[0][0]) if self._stamped else None

    def getLast(self) -> Any:  # noqa: N802
        """Return the newest message; None if there is none."""
        return self._stamped[-1][2] if self._stamped else None
