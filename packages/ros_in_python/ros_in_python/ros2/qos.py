"""Quality of service: the options, and the choice of one that suits the publishers on a topic."""

from __future__ import annotations

import copy
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, TypeVar

import click

from ros_in_python.ros2.cli import CommandError

if TYPE_CHECKING:
    from rclpy.qos import QoSProfile

    from ros_in_python.ros2.graph import GraphView

F = TypeVar("F", bound=Callable[..., Any])


@dataclass(frozen=True)
class QosOptions:
    """The QoS options of one call, as typed; None where they were not."""

    profile: str
    depth: int | None = None
    history: str | None = None
    reliability: str | None = None
    durability: str | None = None
    liveliness: str | None = None
    liveliness_lease_duration_seconds: float | None = None

    @property
    def anything(self) -> bool:
        """Whether a policy was given, so that none is chosen automatically."""
        return any(value is not None for name, value in vars(self).items() if name != "profile")


def qos_options(default_profile: str) -> Callable[[F], F]:
    """Add the seven `--qos-…` options. The function gets each by name; `asked` collects them."""

    def add(command: F) -> F:
        options = [
            ("--qos-profile", {"default": default_profile, "show_default": True, "metavar": "NAME"}),
            ("--qos-depth", {"type": click.IntRange(min=0), "metavar": "N", "help": "Queue size."}),
            ("--qos-history", {"metavar": "POLICY", "help": "keep_last or keep_all."}),
            ("--qos-reliability", {"metavar": "POLICY", "help": "reliable or best_effort."}),
            ("--qos-durability", {"metavar": "POLICY", "help": "volatile or transient_local."}),
            ("--qos-liveliness", {"metavar": "POLICY", "help": "automatic or manual_by_topic."}),
            ("--qos-liveliness-lease-duration-seconds", {"type": float, "metavar": "N"}),
        ]
        for name, attributes in reversed(options):
            command = click.option(name, **attributes)(command)  # type: ignore[arg-type]
        return command

    return add


def asked(options: dict[str, Any]) -> QosOptions:
    """Take the `qos_…` entries out of a function's options."""
    mine = {name: options.pop(name) for name in list(options) if name.startswith("qos_")}
    return QosOptions(**{name.removeprefix("qos_"): value for name, value in mine.items()})


def profile(asked: QosOptions) -> QoSProfile:
    """Return the profile with the chosen policies. Raises `CommandError` for an unknown name."""
    from rclpy.duration import Duration
    from rclpy.qos import (
        DurabilityPolicy,
        HistoryPolicy,
        LivelinessPolicy,
        QoSPresetProfiles,
        ReliabilityPolicy,
    )

    if asked.profile.lower() not in QoSPresetProfiles.short_keys():
        raise CommandError(
            f"There is no QoS profile '{asked.profile}'.", f"There is: {', '.join(QoSPresetProfiles.short_keys())}."
        )
    chosen: QoSProfile = copy.copy(QoSPresetProfiles.get_from_short_key(asked.profile))
    if asked.depth is not None:
        chosen.depth = asked.depth
    if asked.history is not None:
        chosen.history = _policy(HistoryPolicy, asked.history)
    if asked.reliability is not None:
        chosen.reliability = _policy(ReliabilityPolicy, asked.reliability)
    if asked.durability is not None:
        chosen.durability = _policy(DurabilityPolicy, asked.durability)
    if asked.liveliness is not None:
        chosen.liveliness = _policy(LivelinessPolicy, asked.liveliness)
    if asked.liveliness_lease_duration_seconds is not None:
        chosen.liveliness_lease_duration = Duration(seconds=asked.liveliness_lease_duration_seconds)
    return chosen


def suiting(graph: GraphView, topic: str, asked: QosOptions) -> QoSProfile:
    """Return the profile for a subscription that matches every publisher on `topic`.

    Reliable and transient local if all publishers are; otherwise what connects to all, which is then said. What was
    asked for is taken as it is.
    """
    from rclpy.qos import DurabilityPolicy, ReliabilityPolicy

    chosen = profile(asked)
    offered = [end.qos_profile for end in graph.publishers(topic)]
    if asked.anything or not offered:
        return chosen
    chosen.reliability = _common(
        [offer.reliability for offer in offered], ReliabilityPolicy.RELIABLE, ReliabilityPolicy.BEST_EFFORT
    )
    chosen.durability = _common(
        [offer.durability for offer in offered], DurabilityPolicy.TRANSIENT_LOCAL, DurabilityPolicy.VOLATILE
    )
    return chosen


def _common(offered: list[Any], stronger: Any, weaker: Any) -> Any:
    strong = sum(offer == stronger for offer in offered)
    if strong == len(offered):
        return stronger
    if strong:
        kind = f"QoS{type(stronger).__name__}"
        print(
            f"Some, but not all, publishers are offering {kind}.{stronger.name}. "
            f"Falling back to {kind}.{weaker.name} as it will connect to all publishers",
            flush=True,
        )
    return weaker


def _policy(kind: Any, name: str) -> Any:
    if name.lower() not in kind.short_keys():
        raise CommandError(f"There is no QoS policy '{name}'.", f"There is: {', '.join(kind.short_keys())}.")
    return kind.get_from_short_key(name)
