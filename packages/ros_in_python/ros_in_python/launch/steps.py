"""What a launch description comes to: programs to start, lines to log, and what waits for a time or an event."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, TypeAlias

from ros_in_python.launch import events
from ros_in_python.launch.actions import LaunchedProgram
from ros_in_python.launch.substitutions import Context


@dataclass(frozen=True)
class ProcessToStart:
    """One program's process; `name` stands before each line that it prints: `joint_publisher-1`.

    `respawn_s` is how long after its end it starts again (s), at most `respawns` times; None if it does not. `grace_s`
    is how long it may take to end after SIGINT, and then after SIGTERM (s). `name_again` is the name with its number
    of one that starts again.
    """

    name: str
    argv: tuple[str, ...]
    env: Mapping[str, str]
    action: LaunchedProgram
    cwd: str | None = None
    respawn_s: float | None = None
    respawns: float = math.inf
    grace_s: tuple[float, float] = (5.0, 5.0)
    name_again: str = ""


@dataclass(frozen=True)
class Later:
    """Steps that come after some seconds, unless the launch is ending then and they are cancelled by that."""

    seconds: float
    steps: tuple[Step, ...]
    is_cancelled_at_end: bool = True


@dataclass(frozen=True)
class DeferredAction:
    """A function of the launch file, or what depends on an event: its time has not come when all else is planned."""

    entity: Any
    context: Context


@dataclass(frozen=True)
class EventStep:
    """A handler that holds from here on. `steps` are those of its actions; None if a function gives them."""

    handler: events.EventHandler
    steps: tuple[Step, ...] | None
    context: Context


@dataclass(frozen=True)
class HandlerRemoval:
    """A handler holds no more."""

    handler: events.EventHandler


@dataclass(frozen=True)
class Emission:
    """An event that the launch file lets happen."""

    event: Any


Step: TypeAlias = ProcessToStart | str | Later | DeferredAction | EventStep | HandlerRemoval | Emission
