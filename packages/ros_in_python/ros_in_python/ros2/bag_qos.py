"""The QoS that a bag keeps of each topic, so that a latched topic is played back as a latched one."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from rclpy.qos import DurabilityPolicy, HistoryPolicy, QoSProfile, ReliabilityPolicy
from rosbags.interfaces import Qos, QosDurability, QosHistory, QosLiveliness, QosReliability, QosTime

#: "For ever", as rosbag2 writes it.
_EVER = QosTime(9223372036, 854775807)

#: The depth of a publisher that plays a topic whose bag says nothing of it.
_DEPTH = 10


def of_profile(profile: Any) -> Qos:
    """Return a publisher's profile as a bag keeps it."""
    return Qos(
        QosHistory[profile.history.name],
        profile.depth,
        QosReliability[profile.reliability.name],
        QosDurability[profile.durability.name],
        _EVER,
        _EVER,
        QosLiveliness.AUTOMATIC,
        _EVER,
        False,
    )


def to_profile(offered: Sequence[Qos]) -> QoSProfile:
    """Return the profile with which to play a topic: as strong as all of its publishers were."""
    profile = QoSProfile(depth=_DEPTH, history=HistoryPolicy.KEEP_LAST)
    if not offered:
        return profile
    if any(qos.reliability is QosReliability.BEST_EFFORT for qos in offered):
        profile.reliability = ReliabilityPolicy.BEST_EFFORT
    if all(qos.durability is QosDurability.TRANSIENT_LOCAL for qos in offered):
        profile.durability = DurabilityPolicy.TRANSIENT_LOCAL
        profile.depth = max(qos.depth for qos in offered) or _DEPTH
    return profile
