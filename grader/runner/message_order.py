"""Sorts messages and requests into an order that does not depend on how threads were scheduled."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Collection, Sequence
from typing import Any

from rmw_lockstep.hub import DeliveredMessage, PendingRequest

#: A subscription, a node, and the stage and the computer's time (ns) at which the node published.
Place = tuple[int, str, int, int]

#: Which node published for which subscription.
Source = tuple[int, str]


def in_canonical_order(
    heard: Sequence[tuple[int, DeliveredMessage]], unordered: Collection[Source]
) -> list[tuple[int, DeliveredMessage]]:
    """Sort messages by their moment; at the same moment by topic and node, and within these as they were sent.

    What several threads or processes (`unordered`: see `unordered_sources`) may have published on one topic at the same
    moment has no order, so it is sorted by its bytes.
    """
    alone = len({one.publisher.process for _, one in heard}) <= 1

    def key(entry: tuple[int, DeliveredMessage]) -> tuple[Any, ...]:
        number, one = entry
        own = one.handled if alone else 0  # the frames of two processes cannot be compared
        return one.stage, one.now, own, number, one.node, one.cdr if (number, one.node) in unordered else b""

    return sorted(heard, key=key)


def without_order(heard: Sequence[tuple[int, DeliveredMessage]], unordered: Collection[Source]) -> set[Place]:
    """Return where and when several threads or processes (`unordered`) may have published more than one message."""
    counts = Counter(place_of(number, one) for number, one in heard if (number, one.node) in unordered)
    return {place for place, count in counts.items() if count > 1}


def place_of(number: int, one: DeliveredMessage) -> Place:
    """Return where and when a message was published."""
    return number, one.node, one.stage, one.now


def unordered_sources(heard: Sequence[tuple[int, DeliveredMessage]]) -> set[Source]:
    """Return the subscriptions and nodes for which any thread but the main one published, or several processes.

    One thread other than the main one counts as several, because chance decides how many threads of a pool work.
    """
    return {(number, one.node) for number, one in heard if not one.ordered}


def requests_in_order(
    asked: Sequence[PendingRequest], content: Callable[[bytes], bytes] = bytes
) -> list[PendingRequest]:
    """Sort requests by their moment; at the same moment by node, and those of the main thread as they were sent.

    Others, and those of several processes in the name of one node, are sorted by their `content`: their bytes, or what
    of these is not chance, as the id of a goal is.
    """
    alone = len({one.client.process for one in asked}) <= 1
    shared = _of_several_processes(asked)

    def key(one: PendingRequest) -> tuple[Any, ...]:
        moment = one.moment
        own = moment.handled if alone else 0
        as_sent = moment.main and one.node not in shared
        return moment.stage, moment.now, own, one.node, *(() if as_sent else (one.client.name, content(one.cdr)))

    return sorted(asked, key=key)


def _of_several_processes(asked: Sequence[PendingRequest]) -> set[str]:
    counts = Counter(node for node, _ in {(one.node, one.client.process) for one in asked})
    return {node for node, count in counts.items() if count > 1}
