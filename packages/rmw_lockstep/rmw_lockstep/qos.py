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
#: The policies that can keep endpoints from matching: rmw_qos_policy_kind_t.
DURABILITY, DEADLINE, LIVELINESS, RELIABILITY = 2, 4, 8, 16

_RELIABILITY = {RELIABLE: "reliable", BEST_EFFORT: "best_effort"}
_DURABILITY = {TRANSIENT_LOCAL: "transient_local", VOLATILE: "volatile"}


@dataclass(frozen=True)
class QosPolicies:
    """The policies of one endpoint, with the numbers of rmw/types.h; durations are in ns."""

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


def compatible(offered: QosPolicies, requested: QosPolicies) -> bool:
    """Return whether a subscription that requests `requested` gets messages from a publisher that offers `offered`."""
    return not first_mismatch(offered, requested)


def first_mismatch(offered: QosPolicies, requested: QosPolicies) -> int:
    """Return the policy that keeps two endpoints from matching, or 0 if they match.

    The rules are DDS's "requested versus offered" (DDS 1.4, section 2.2.3), in the order in which Fast DDS reports.
    """
    mismatches = {
        DURABILITY: requested.durability == TRANSIENT_LOCAL != offered.durability,
        DEADLINE: _duration(offered.deadline) > _duration(requested.deadline),
        LIVELINESS: (requested.liveliness == MANUAL_BY_TOPIC != offered.liveliness)
        or _duration(offered.lease) > _duration(requested.lease),
        RELIABILITY: requested.reliability == RELIABLE != offered.reliability,
    }
    return next((policy for policy, differs in mismatches.items() if differs), 0)


def _duration(nanoseconds: int) -> int:
    """Return a duration; 0 means "not specified" in rmw, which is no limit."""
    return nanoseconds or INFINITE
