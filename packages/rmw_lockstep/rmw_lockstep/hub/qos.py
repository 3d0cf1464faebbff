"""Quality of service: what publishers offer, what subscriptions request, and when the two match."""

from __future__ import annotations

from dataclasses import dataclass

#: "No limit" for a duration (ns).
INFINITE = 2**63 - 1

# Values of rmw/types.h.
KEEP_LAST, KEEP_ALL = 1, 2
RELIABLE, BEST_EFFORT = 1, 2
TRANSIENT_LOCAL, VOLATILE = 1, 2
AUTOMATIC, MANUAL_BY_TOPIC = 1, 3

_RELIABILITY = {RELIABLE: "reliable", BEST_EFFORT: "best_effort"}
_DURABILITY = {TRANSIENT_LOCAL: "transient_local", VOLATILE: "volatile"}


@dataclass(frozen=True)
class Qos:
    """The policies of one end point, with the numbers of rmw/types.h; durations are in ns."""

    history: int = KEEP_LAST
    depth: int = 10
    reliability: int = RELIABLE
    durability: int = VOLATILE
    liveliness: int = AUTOMATIC
    deadline: int = INFINITE
    lifespan: int = INFINITE
    lease: int = INFINITE

    @property
    def reliability_name(self) -> str:
        """The name in rclpy, in lower case."""
        return _RELIABILITY.get(self.reliability, "system_default")

    @property
    def durability_name(self) -> str:
        """The name in rclpy, in lower case."""
        return _DURABILITY.get(self.durability, "system_default")


def compatible(offered: Qos, requested: Qos) -> bool:
    """Return whether a subscription that requests one gets what a publisher sends that offers the other.

    The rules are DDS's "requested versus offered" (DDS 1.4, section 2.2.3).
    """
    return (
        (requested.reliability != RELIABLE or offered.reliability == RELIABLE)
        and (requested.durability != TRANSIENT_LOCAL or offered.durability == TRANSIENT_LOCAL)
        and (requested.liveliness != MANUAL_BY_TOPIC or offered.liveliness == MANUAL_BY_TOPIC)
        and _duration(offered.deadline) <= _duration(requested.deadline)
        and _duration(offered.lease) <= _duration(requested.lease)
    )


def _duration(nanoseconds: int) -> int:
    """Return a duration; zero means "not specified" in rmw, which is no limit."""
    return nanoseconds or INFINITE
