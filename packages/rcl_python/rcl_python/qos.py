"""Quality of service: rclpy's profiles, and what they come to. Which ends match is in `rmw_lockstep.qos`.

Numbers are those of rmw/types.h; the rules of rmw/qos_profiles.h and rmw_dds_common's qos.cpp.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace
from typing import Any

from rcl_python.values import (
    RMW_DURATION_INFINITE,
    RMW_QOS_DEADLINE_BEST_AVAILABLE,
    QoSCompatibility,
    rcl_duration_t,
    rmw_qos_policy_kind_t,
)
from rmw_lockstep.qos import (
    AUTOMATIC,
    BEST_EFFORT,
    KEEP_LAST,
    MANUAL_BY_TOPIC,
    RELIABLE,
    TRANSIENT_LOCAL,
    VOLATILE,
    QosPolicies,
    first_mismatch,
)

# Values of rmw/types.h that only a profile has that is not resolved yet.
SYSTEM_DEFAULT, UNKNOWN = 0, 3
BEST_AVAILABLE, LIVELINESS_UNKNOWN, LIVELINESS_BEST_AVAILABLE = 4, 4, 5

_HISTORY_OF_DEFAULT, _DEPTH_OF_DEFAULT = KEEP_LAST, 1


@dataclass(frozen=True)
class Profile(QosPolicies):
    """A profile of quality of service, as rclpy gives it: 0 means "not given"."""

    liveliness: int = 0
    deadline: int = 0
    lifespan: int = 0
    lease: int = 0
    avoid_ros_namespace_conventions: bool = False

    def to_dict(self) -> dict[str, Any]:
        """Return the profile in the form of rclpy's QoSProfile."""
        from rclpy.duration import Duration

        return {
            "depth": self.depth,
            "history": self.history,
            "reliability": self.reliability,
            "durability": self.durability,
            "lifespan": Duration(nanoseconds=self.lifespan),
            "deadline": Duration(nanoseconds=self.deadline),
            "liveliness": self.liveliness,
            "liveliness_lease_duration": Duration(nanoseconds=self.lease),
            "avoid_ros_namespace_conventions": self.avoid_ros_namespace_conventions,
        }


class rmw_qos_profile_t:  # noqa: N801
    """What rclpy calls to make a profile."""

    to_dict = Profile.to_dict

    def __new__(  # type: ignore[misc]
        cls,
        history: int,
        depth: int,
        reliability: int,
        durability: int,
        lifespan: rcl_duration_t,
        deadline: rcl_duration_t,
        liveliness: int,
        lease: rcl_duration_t,
        avoid: bool,
    ) -> Profile:
        policies = (int(history), int(depth), int(reliability), int(durability))
        times = (deadline.nanoseconds, lifespan.nanoseconds, lease.nanoseconds)
        return Profile(*policies, int(liveliness), *times, bool(avoid))

    @staticmethod
    def predefined(name: str) -> Profile:
        """Return the profile with this name. Raises ValueError for any other."""
        if name not in PREDEFINED:
            raise ValueError(f"Requested unknown rmw_qos_profile: {name}")
        return PREDEFINED[name]


_MANY = Profile(depth=1000)
PREDEFINED = {
    "qos_profile_default": Profile(),
    "qos_profile_services_default": Profile(),
    "qos_profile_sensor_data": Profile(depth=5, reliability=BEST_EFFORT),
    "qos_profile_parameters": _MANY,
    "qos_profile_parameter_events": _MANY,
    "qos_profile_system_default": Profile(SYSTEM_DEFAULT, 0, SYSTEM_DEFAULT, SYSTEM_DEFAULT),
    "qos_profile_unknown": Profile(UNKNOWN, 0, UNKNOWN, UNKNOWN, liveliness=LIVELINESS_UNKNOWN),
    "qos_profile_best_available": Profile(
        reliability=BEST_AVAILABLE,
        durability=BEST_AVAILABLE,
        deadline=RMW_QOS_DEADLINE_BEST_AVAILABLE,
        liveliness=LIVELINESS_BEST_AVAILABLE,
        lease=RMW_QOS_DEADLINE_BEST_AVAILABLE,
    ),
}
ROSOUT = Profile(depth=1000, durability=TRANSIENT_LOCAL, lifespan=10 * 10**9)
"""rcl/logging_rosout.h."""

_ACTION_STATUS = Profile(depth=1, durability=TRANSIENT_LOCAL)


def action_profile(name: str) -> dict[str, Any]:
    """Return the profile of an action's topic. Raises RuntimeError for an invalid name."""
    if name != "rcl_action_qos_profile_status_default":
        raise RuntimeError(f"Requested unknown rmw_qos_profile: {name}")
    return _ACTION_STATUS.to_dict()


def resolved(profile: Profile, others: Iterable[Profile], *, publishes: bool) -> Profile:
    """Return the profile that an endpoint really gets: with defaults, and "best available" chosen by existing ends."""
    others = list(others)
    found = replace(profile, reliability=profile.reliability or RELIABLE, durability=profile.durability or VOLATILE)
    if profile.history == SYSTEM_DEFAULT:
        found = replace(found, history=_HISTORY_OF_DEFAULT, depth=profile.depth or _DEPTH_OF_DEFAULT)
    if profile.reliability == BEST_AVAILABLE:
        strict = publishes or (bool(others) and all(other.reliability == RELIABLE for other in others))
        found = replace(found, reliability=RELIABLE if strict else BEST_EFFORT)
    if profile.durability == BEST_AVAILABLE:
        strict = publishes or (bool(others) and all(other.durability == TRANSIENT_LOCAL for other in others))
        found = replace(found, durability=TRANSIENT_LOCAL if strict else VOLATILE)
    return _best_times(found, others, publishes=publishes)


def _best_times(profile: Profile, others: list[Profile], *, publishes: bool) -> Profile:
    """Return the longest of the times that publishers offer, or the shortest that subscriptions request."""
    choose = min if publishes else max
    found = profile
    if profile.deadline == RMW_QOS_DEADLINE_BEST_AVAILABLE:
        found = replace(found, deadline=choose((_span(other.deadline) for other in others), default=0))
    if profile.lease == RMW_QOS_DEADLINE_BEST_AVAILABLE:
        found = replace(found, lease=choose((_span(other.lease) for other in others), default=0))
    if profile.liveliness == LIVELINESS_BEST_AVAILABLE:
        manual = any(other.liveliness == MANUAL_BY_TOPIC for other in others)
        found = replace(found, liveliness=MANUAL_BY_TOPIC if publishes and manual else AUTOMATIC)
    return found


def _span(time: int) -> int:
    """Return a time in ns, with "not given" as forever."""
    return time or RMW_DURATION_INFINITE


def reported(profile: Profile) -> Profile:
    """Return the profile as the graph shows it: without history, which is private, and with explicit times."""
    return replace(
        profile,
        history=UNKNOWN,
        depth=0,
        lifespan=_span(profile.lifespan),
        deadline=_span(profile.deadline),
        lease=_span(profile.lease),
        liveliness=profile.liveliness or AUTOMATIC,
    )


def first_incompatible(offered: Profile, requested: Profile) -> rmw_qos_policy_kind_t | None:
    """Return the policy that prevents a match, or None. Both profiles are resolved."""
    policy = first_mismatch(offered, requested)
    return rmw_qos_policy_kind_t(policy) if policy else None


@dataclass(frozen=True)
class QoSCheckCompatibleResult:
    """Whether two profiles match, and why not."""

    compatibility: QoSCompatibility = QoSCompatibility.OK
    reason: str = ""


def check_compatible(publisher: Profile, subscription: Profile) -> QoSCheckCompatibleResult:
    """Return rmw's verdict on two profiles before any endpoint is made with them."""
    errors = list(_errors(publisher, subscription))
    warnings = [] if errors else list(_warnings(publisher, subscription))
    kind = QoSCompatibility.ERROR if errors else QoSCompatibility.WARNING if warnings else QoSCompatibility.OK
    reasons = [f"ERROR: {text};" for text in errors] + [f"WARNING: {text};" for text in warnings]
    return QoSCheckCompatibleResult(kind, "".join(reasons))


def _errors(pub: Profile, sub: Profile) -> Iterable[str]:
    if pub.reliability == BEST_EFFORT and sub.reliability == RELIABLE:
        yield "Best effort publisher and reliable subscription"
    if pub.durability == VOLATILE and sub.durability == TRANSIENT_LOCAL:
        yield "Volatile publisher and transient local subscription"
    yield from _late(pub.deadline, sub.deadline, "deadline")
    if pub.liveliness == AUTOMATIC and sub.liveliness == MANUAL_BY_TOPIC:
        yield "Publisher's liveliness is automatic and subscription's is manual by topic"
    yield from _late(pub.lease, sub.lease, "liveliness lease duration")


def _late(pub: int, sub: int, what: str) -> Iterable[str]:
    if sub and not pub:
        yield f"Subscription has a {what}, but publisher does not"
    elif sub and sub < pub:
        least = "publisher deadline" if what == "deadline" else "publisher"
        yield f"Subscription {what} is less than {least}"


_RMW_SPELLING = {"durability": "durabilty"}
"""A slip of rmw's own, which rclpy shows as it is."""


def _warnings(pub: Profile, sub: Profile) -> Iterable[str]:
    words = {SYSTEM_DEFAULT: "system_default", UNKNOWN: "unknown"}
    yield from _unsure(
        "reliability", words.get(pub.reliability), words.get(sub.reliability), "Best effort publisher", "Reliable",
        pub.reliability == BEST_EFFORT, sub.reliability == RELIABLE,
    )  # fmt: skip
    yield from _unsure(
        "durability", words.get(pub.durability), words.get(sub.durability), "Volatile publisher", "Transient local",
        pub.durability == VOLATILE, sub.durability == TRANSIENT_LOCAL,
    )  # fmt: skip
    words = {SYSTEM_DEFAULT: "system_default", LIVELINESS_UNKNOWN: "unknown"}
    pub_word, sub_word = words.get(pub.liveliness), words.get(sub.liveliness)
    if pub_word and sub_word:
        yield f"Publisher liveliness is {pub_word} and subscription liveliness is {sub_word}"
    elif pub_word and sub.liveliness == MANUAL_BY_TOPIC:
        yield f"Subscription's liveliness is manual by topic, but publisher's is {pub_word}"
    elif sub_word and pub.liveliness == AUTOMATIC:
        yield f"Publisher's liveliness is automatic, but subscription's is {sub_word}"


def _unsure(
    what: str, pub: str | None, sub: str | None, weak: str, strong: str, is_weak: bool, is_strong: bool
) -> Iterable[str]:
    if pub and sub:
        yield f"Publisher {_RMW_SPELLING.get(what, what)} is {pub} and subscription {what} is {sub}"
    elif pub and is_strong:
        yield f"{strong} subscription, but publisher is {pub}"
    elif sub and is_weak:
        yield f"{weak}, but subscription is {sub}"
