"""The interface of an exercise's program, as exercise.toml declares it: topics, services, actions and parameters."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, Literal

Direction = Literal["subscribe", "publish"]
Reliability = Literal["reliable", "best_effort"]
Durability = Literal["volatile", "transient_local"]

#: What the program does with a service or an action.
Role = Literal["service", "client", "action", "action_client"]


@dataclass(frozen=True)
class Qos:
    """Quality of service of one end of a topic: keep the last `depth` messages."""

    reliability: Reliability = "reliable"
    durability: Durability = "volatile"
    depth: int = 10


@dataclass(frozen=True)
class Elements:
    """What the elements of a message's lists are `called`, such as a joint; the list `named_by` has their names."""

    called: str
    named_by: str


@dataclass(frozen=True)
class Topic:
    """One topic of the student's program, seen from the program.

    `name` begins with a slash, `type` is written `package/msg/Name`. `units` gives the unit of a field, such as
    `{"velocity": "rad/s"}`. `depth`, `reliability` and `durability` are what the task asks for.
    """

    name: str
    type: str
    direction: Direction
    depth: int = 10
    units: dict[str, str] = field(default_factory=dict)
    reliability: Reliability = "reliable"
    durability: Durability = "volatile"
    elements: Elements | None = None

    @property
    def qos(self) -> Qos:
        """What the task asks for."""
        return Qos(self.reliability, self.durability, self.depth)


@dataclass(frozen=True)
class Endpoint:
    """A service or an action that the student's program serves (`role` "service", "action") or calls."""

    name: str
    type: str
    role: Role
    units: dict[str, str] = field(default_factory=dict)


@dataclass(frozen=True)
class Parameter:
    """A parameter of the student's node. `type` is one of rclpy's, in lower case, such as "double" or "string_array".

    `range` are the lowest and the highest value that the task allows.
    """

    name: str
    type: str
    default: Any = None
    unit: str = ""
    range: tuple[float, float] | None = None


@dataclass(frozen=True)
class ProgramFile:
    """One of several programs of a submission: a file, and the node that it creates."""

    file: str
    node: str
    class_name: str = ""
