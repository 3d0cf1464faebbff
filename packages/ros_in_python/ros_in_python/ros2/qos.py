"""Quality of service: the options, and the choice of one that suits the publishers on a topic."""

from __future__ import annotations

import copy
import functools
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, cast

import click

from ros_in_python.ros2.cli import CommandError, F

if TYPE_CHECKING:
    from rclpy.qos import QoSProfile

    from ros_in_python.ros2.graph import GraphView

_PREFIX = "qos_"


@dataclass(frozen=True)
class QosOptions:
    """The QoS options of one call: a profile's name, and the policies that were typed, by rclpy's names."""

    profile: str
    policies: Mapping[str, Any] = field(default_factory=dict)


def qos_options(default_profile: str) -> Callable[[F], F]:
    """Add the seven `--qos-…` options. The function gets `qos`, a `QosOptions`."""

    def add(command: F) -> F:
        @click.option("--qos-profile", default=default_profile, show_default=True, metavar="NAME")
        @click.option("--qos-depth", type=click.IntRange(min=0), metavar="N", help="Queue size.")
        @click.option("--qos-history", metavar="POLICY", help="keep_last or keep_all.")
        @click.option("--qos-reliability", metavar="POLICY", help="reliable or best_effort.")
        @click.option("--qos-durability", metavar="POLICY", help="volatile or transient_local.")
        @click.option("--qos-liveliness", metavar="POLICY", help="automatic or manual_by_topic.")
        @click.option(
            "--qos-liveliness-lease-duration-seconds", "qos_liveliness_lease_duration", type=float, metavar="N"
        )
        @functools.wraps(command)
        def run(*arguments: Any, qos_profile: str, **named: Any) -> Any:
            typed = {name: named.pop(name) for name in list(named) if name.startswith(_PREFIX)}
            policies = {name.removeprefix(_PREFIX): value for name, value in typed.items() if value is not None}
            return command(*arguments, qos=QosOptions(qos_profile, policies), **named)

        return cast("F", run)

    return add


def profile(options: QosOptions) -> QoSProfile:
    """Return the profile with the chosen policies. Raises `CommandError` for an unknown name."""
    from rclpy.qos import QoSPresetProfiles

    names = QoSPresetProfiles.short_keys()
    if options.profile.lower() not in names:
        raise CommandError(f"There is no QoS profile '{options.profile}'.", f"There is: {', '.join(names)}.")
    chosen: QoSProfile = copy.copy(QoSPresetProfiles.get_from_short_key(options.profile))
    for policy, typed in options.policies.items():
        setattr(chosen, policy, _value(policy, typed))
    return chosen


def _value(policy: str, typed: Any) -> Any:
    """Return what was typed for a policy as rclpy has it."""
    from rclpy.duration import Duration
    from rclpy.qos import DurabilityPolicy, HistoryPolicy, LivelinessPolicy, ReliabilityPolicy

    if policy == "depth":
        return typed
    if policy == "liveliness_lease_duration":
        return Duration(seconds=typed)
    kinds: dict[str, Any] = {
        "history": HistoryPolicy,
        "reliability": ReliabilityPolicy,
        "durability": DurabilityPolicy,
        "liveliness": LivelinessPolicy,
    }
    kind = kinds[policy]
    if typed.lower() not in kind.short_keys():
        raise CommandError(f"There is no QoS policy '{typed}'.", f"There is: {', '.join(kind.short_keys())}.")
    return kind.get_from_short_key(typed)


def suiting(graph: GraphView, topic: str, options: QosOptions) -> QoSProfile:
    """Return the profile for a subscription that matches every publisher on `topic`.

    Reliable and transient local if all publishers are; otherwise what connects to all, which is then said. What was
    asked for is taken as it is.
    """
    from rclpy.qos import DurabilityPolicy, ReliabilityPolicy

    chosen = profile(options)
    offered = [end.qos_profile for end in graph.publishers(topic)]
    if options.policies or not offered:
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
