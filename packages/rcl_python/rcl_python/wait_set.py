"""Wait sets: they wait until one of a program's entities is ready."""

from __future__ import annotations

from functools import partialmethod
from typing import Any

from rcl_python import participant
from rcl_python.context import Context
from rcl_python.handle import Destroyable
from rcl_python.values import RCLError

KINDS = ("subscription", "guard_condition", "timer", "client", "service", "event")
_NEWS = ("subscription", "client", "service", "event")


class WaitSet(Destroyable):
    """What a program waits for. The numbers say how many of each kind there will be; they are not needed here."""

    def __init__(
        self, subscriptions: int, guards: int, timers: int, clients: int, services: int, events: int, context: Context
    ) -> None:
        self._destroyed = True
        context.require_valid("failed to initialize wait set", "rcl/wait.c:135")
        super().__init__()
        self.context = context
        self.clear_entities()

    def clear_entities(self) -> None:
        """Wait for nothing."""
        self._entities: dict[str, list[Any]] = {kind: [] for kind in KINDS}
        self._ready: dict[str, list[bool]] = {kind: [] for kind in KINDS}

    def _add(self, kind: str, entity: Any) -> int:
        """Wait for an entity of this kind; return its index among them."""
        self._entities[kind].append(entity)
        return len(self._entities[kind]) - 1

    add_subscription = partialmethod(_add, "subscription")
    add_guard_condition = partialmethod(_add, "guard_condition")
    add_timer = partialmethod(_add, "timer")
    add_client = partialmethod(_add, "client")
    add_service = partialmethod(_add, "service")
    add_event = partialmethod(_add, "event")

    def wait(self, timeout: int) -> None:
        """Wait until something is ready, or for `timeout` ns; without a limit if it is negative."""
        if not any(self._entities.values()):
            raise RCLError("failed to wait on wait set: wait set is empty")
        here = participant.current()
        with here.link.lock:
            until = None if timeout < 0 else here.link.steady() + timeout
            here.pump(self._event_is_ready)
            left, news = self._left(until), self._has_news()
            rest = here.link.breathe(left == 0, news)
            self._wait_for_news(min(rest, left) if left else rest)
            while not self._collect() and (until is None or here.link.steady() < until):
                here.link.wait(self._left(until))
                here.pump(self._event_is_ready)

    def _wait_for_news(self, nanoseconds: int) -> None:
        """Wait for news, for so long at most."""
        here = participant.current()
        until = here.link.steady() + nanoseconds
        while not self._has_news() and (left := until - here.link.steady()) > 0:
            here.link.wait(left)
            here.pump(self._event_is_ready)

    def _has_news(self) -> bool:
        """Whether anything is ready that comes from outside."""
        return any(entity.is_ready() for kind in _NEWS for entity in self._entities[kind])

    def _event_is_ready(self) -> bool:
        """Return whether an event can be reported: two in a row are two reports, as over a network."""
        return any(event.is_ready() for event in self._entities["event"])

    def _collect(self) -> bool:
        """Note what is ready. Guard conditions that end the wait are reset."""
        for kind, entities in self._entities.items():
            self._ready[kind] = [entity.is_ready() for entity in entities]
        for guard, ready in zip(self._entities["guard_condition"], self._ready["guard_condition"], strict=True):
            if ready:
                guard.taken()
        return any(map(any, self._ready.values()))

    def _left(self, until: int | None) -> int | None:
        """Return how long the wait can be at most (ns): until the time is up, a timer is due or a deadline passes."""
        now = participant.current().link.steady()
        spans = [] if until is None else [until - now]
        spans += [span for span in (timer.due() for timer in self._entities["timer"]) if span is not None]
        spans += [due - now for due in (event.due() for event in self._entities["event"]) if due is not None]
        return max(0, min(spans)) if spans else None

    def is_ready(self, kind: str, index: int) -> bool:
        """Return whether the last wait found this one ready. Raises RuntimeError for an invalid kind."""
        if kind not in KINDS:
            raise RuntimeError(f"'{kind}' is not a known entity")
        if index >= len(self._entities[kind]):
            raise IndexError("wait set index too big")
        return bool(self._ready[kind]) and self._ready[kind][index]

    def get_ready_entities(self, kind: str) -> list[int]:
        """Return the pointers of the entities of a kind that the last wait found ready."""
        if kind not in KINDS or kind == "event":
            raise RuntimeError(f"'{kind}' is not a known entity")
        return [entity.pointer for entity, ready in zip(self._entities[kind], self._ready[kind], strict=False) if ready]

    def found_ready(self, entity: Any) -> bool:
        """Return whether the last wait found this very thing ready."""
        return any(
            ready and waited is entity
            for kind in KINDS
            for waited, ready in zip(self._entities[kind], self._ready[kind], strict=False)
        )
