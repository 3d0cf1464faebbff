"""The topics of an exercise's node, as exercise.toml declares them."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal

Direction = Literal["subscribe", "publish"]


@dataclass(frozen=True)
class Topic:
    """One topic of the student's node, seen from the node.

    `name` begins with a slash, `type` is written `package/msg/Name`. `units` gives the unit of a field, such as
    `{"velocity": "rad/s"}`. `depth` is the queue depth that the task asks for.
    """

    name: str
    type: str
    direction: Direction
    depth: int = 10
    units: dict[str, str] = field(default_factory=dict)
