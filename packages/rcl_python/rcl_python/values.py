"""The constants, errors and small values that rclpy's compiled module offers.

Names and numbers are those of rcl, rmw and rcutils of ROS 2 Jazzy, because rclpy's own Python files use them.
"""

from __future__ import annotations

import builtins
import enum
from dataclasses import dataclass

RCL_DEFAULT_DOMAIN_ID = 2**64 - 1
RMW_DURATION_INFINITE = 2**63 - 1
RMW_QOS_DEADLINE_BEST_AVAILABLE = 2**63 - 2
RMW_QOS_LIVELINESS_LEASE_DURATION_BEST_AVAILABLE = 2**63 - 2

SECOND = 10**9
"""Nanoseconds."""


class RCLError(RuntimeError):
    """rcl refused to do something."""


class RMWError(RuntimeError):
    """The middleware refused to do something."""


class RCUtilsError(RuntimeError):
    """rcutils refused to do something."""


class RCLInvalidROSArgsError(RCLError):
    """The arguments after --ros-args can't be read."""


class NodeNameNonExistentError(RCLError):
    """No node has that name."""


class UnsupportedEventTypeError(RCLError):
    """The middleware doesn't report this kind of event."""


class UnknownROSArgsError(RuntimeError):
    """There are unknown flags after --ros-args."""


class InvalidHandle(RuntimeError):
    """The object has been destroyed, or is about to be."""


class NotImplementedError(builtins.NotImplementedError):
    """The middleware can't do this."""


def at(text: str, place: str) -> str:
    """Return an error's text as rcl ends it, with the place in its C source, so that logs equal the real ones."""
    return f"{text}, at /project/src/{place}"


class Constant(enum.IntEnum):
    """An enumeration of C, printed as pybind11 prints it."""

    def __str__(self) -> str:
        return f"{type(self).__name__}.{self.name}"

    def __format__(self, spec: str) -> str:
        return format(str(self), spec)


class RCUTILS_LOG_SEVERITY(Constant):  # noqa: N801
    """How severe a log line is."""

    RCUTILS_LOG_SEVERITY_UNSET = 0
    RCUTILS_LOG_SEVERITY_DEBUG = 10
    RCUTILS_LOG_SEVERITY_INFO = 20
    RCUTILS_LOG_SEVERITY_WARN = 30
    RCUTILS_LOG_SEVERITY_ERROR = 40
    RCUTILS_LOG_SEVERITY_FATAL = 50


class ClockType(Constant):
    """What a clock follows."""

    UNINITIALIZED = 0
    ROS_TIME = 1
    SYSTEM_TIME = 2
    STEADY_TIME = 3


class ClockChange(Constant):
    """What happened to a clock when its time jumped."""

    ROS_TIME_NO_CHANGE = 1
    ROS_TIME_ACTIVATED = 2
    ROS_TIME_DEACTIVATED = 3
    SYSTEM_TIME_NO_CHANGE = 4


class GoalEvent(Constant):
    """What moves a goal of an action from one state to the next."""

    EXECUTE = 0
    CANCEL_GOAL = 1
    SUCCEED = 2
    ABORT = 3
    CANCELED = 4


class QoSCompatibility(Constant):
    """Whether a publisher and a subscription can match."""

    OK = 0
    WARNING = 1
    ERROR = 2


class SignalHandlerOptions(Constant):
    """The signals that rclpy handles."""

    NO = 0
    SIGINT = 1
    SIGTERM = 2
    ALL = 3


class rcl_publisher_event_type_t(Constant):  # noqa: N801
    """The events of a publisher."""

    RCL_PUBLISHER_OFFERED_DEADLINE_MISSED = 0
    RCL_PUBLISHER_LIVELINESS_LOST = 1
    RCL_PUBLISHER_OFFERED_INCOMPATIBLE_QOS = 2
    RCL_PUBLISHER_INCOMPATIBLE_TYPE = 3
    RCL_PUBLISHER_MATCHED = 4


class rcl_subscription_event_type_t(Constant):  # noqa: N801
    """The events of a subscription."""

    RCL_SUBSCRIPTION_REQUESTED_DEADLINE_MISSED = 0
    RCL_SUBSCRIPTION_LIVELINESS_CHANGED = 1
    RCL_SUBSCRIPTION_REQUESTED_INCOMPATIBLE_QOS = 2
    RCL_SUBSCRIPTION_MESSAGE_LOST = 3
    RCL_SUBSCRIPTION_INCOMPATIBLE_TYPE = 4
    RCL_SUBSCRIPTION_MATCHED = 5


class rmw_qos_policy_kind_t(Constant):  # noqa: N801
    """The policies of quality of service."""

    RMW_QOS_POLICY_INVALID = 1
    RMW_QOS_POLICY_DURABILITY = 2
    RMW_QOS_POLICY_DEADLINE = 4
    RMW_QOS_POLICY_LIVELINESS = 8
    RMW_QOS_POLICY_RELIABILITY = 16
    RMW_QOS_POLICY_HISTORY = 32
    RMW_QOS_POLICY_LIFESPAN = 64
    RMW_QOS_POLICY_DEPTH = 128
    RMW_QOS_POLICY_LIVELINESS_LEASE_DURATION = 256
    RMW_QOS_POLICY_AVOID_ROS_NAMESPACE_CONVENTIONS = 512


class TransitionCallbackReturnType(Constant):
    """What a callback of a lifecycle node returns."""

    SUCCESS = 97
    FAILURE = 98
    ERROR = 99

    def to_label(self) -> str:
        """Return the label of the transition that follows."""
        return f"transition_{self.name.lower()}"


class ServiceIntrospectionState(Constant):
    """How much of a service's traffic is published."""

    OFF = 0
    METADATA = 1
    CONTENTS = 2


def _int64(value: int) -> int:
    if not -(2**63) <= value < 2**63:
        raise TypeError(f"incompatible constructor arguments: {value} is not a 64-bit integer")
    return int(value)


class rcl_time_point_t:  # noqa: N801
    """A moment of a clock (ns)."""

    nanoseconds: int = 0
    clock_type: ClockType = ClockType.UNINITIALIZED

    def __init__(self, nanoseconds: int, clock_type: int) -> None:
        self.nanoseconds = _int64(nanoseconds)
        self.clock_type = ClockType(int(clock_type))


class rcl_duration_t:  # noqa: N801
    """A span of time (ns)."""

    nanoseconds: int = 0

    def __init__(self, nanoseconds: int) -> None:
        self.nanoseconds = _int64(nanoseconds)


@dataclass
class Count:
    """How often something has happened, in all and since it was last read."""

    total_count: int = 0
    total_count_change: int = 0


@dataclass
class rmw_matched_status_t(Count):  # noqa: N801
    """How many endpoints have been matched, and how many are matched now."""

    current_count: int = 0
    current_count_change: int = 0


@dataclass
class rmw_requested_qos_incompatible_event_status_t(Count):  # noqa: N801
    """How many endpoints requested another quality of service, and the policy that prevented the last match."""

    last_policy_kind: rmw_qos_policy_kind_t = rmw_qos_policy_kind_t.RMW_QOS_POLICY_INVALID


class rmw_requested_deadline_missed_status_t(Count):  # noqa: N801
    """How often no message arrived in time."""


class rmw_offered_deadline_missed_status_t(Count):  # noqa: N801
    """How often no message was published in time."""


class rmw_message_lost_status_t(Count):  # noqa: N801
    """How many messages were lost."""


class rmw_liveliness_lost_status_t(Count):  # noqa: N801
    """How often a publisher failed to assert its liveliness."""


@dataclass
class rmw_liveliness_changed_status_t:  # noqa: N801
    """How many publishers are alive, and how many are not any more."""

    alive_count: int = 0
    alive_count_change: int = 0
    not_alive_count: int = 0
    not_alive_count_change: int = 0


class rmw_incompatible_type_status_t(Count):  # noqa: N801
    """How many endpoints have another type."""


@dataclass(frozen=True)
class rmw_request_id_t:  # noqa: N801
    """A request: its number, and the gid of the client that sent it."""

    sequence_number: int = 0
    client: str = ""


@dataclass(frozen=True)
class rmw_service_info_t:  # noqa: N801
    """A request or a response in transit (times in ns since the epoch)."""

    request_id: rmw_request_id_t = rmw_request_id_t()
    source_timestamp: int = 0
    received_timestamp: int = 0
