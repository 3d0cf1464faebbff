"""How much is right of what a check looks at: messages, calls, goals, scenarios."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import TypeVar

from grader.checking.verdict import Wrong

Item = TypeVar("Item")


def each(items: Iterable[Item], judge: Callable[[Item], None]) -> None:
    """Judge every item. If some are wrong, fail as the first of them does, with the share of what is right.

    An item that is partly right, because `judge` calls `each` itself, counts as that part.

    Example: `each(run.messages_on("/out"), lambda message: None)`
    """
    shares: list[float] = []
    first: Wrong | None = None
    for item in items:
        try:
            judge(item)
            shares.append(1.0)
        except Wrong as wrong:
            shares.append(wrong.share)
            first = first or wrong
    if first:
        raise Wrong(first.finding, sum(shares) / len(shares))
