"""Publishers, subscriptions, services and clients, and the events of the first two."""

from __future__ import annotations

import copy
import struct
from typing import Any, Protocol

from rcl_python import participant
from rcl_python.cdr import deserialize, serialize
from rcl_python.clock import Clock
from rcl_python.context import Context
from rcl_python.graph import CLIENT, PUBLISHER, SERVICE, SUBSCRIPTION, NodeInfo
from rcl_python.handle import Destroyable
from rcl_python.names import full_topic_fault, topic_fault
from rcl_python.participant import Arrival, LocalEndpoint
from rcl_python.qos import Profile
from rcl_python.values import (
    RCLError,
    RMWError,
    ServiceIntrospectionState,
    at,
    rcl_duration_t,
    rmw_liveliness_lost_status_t,
    rmw_message_lost_status_t,
    rmw_request_id_t,
    rmw_service_info_t,
)

_DEFAULT = Profile()


def type_name_of(message_class: Any) -> str:
    """Return a type's name in the graph: std_msgs/msg/String."""
    package, middle, *_ = message_class.__module__.split(".")
    return f"{package}/{middle}/{message_class.__name__}"


class Owner(Protocol):
    """What an endpoint needs of its node."""

    context: Context
    info: NodeInfo

    def resolve(self, name: str, kind: str, only_expand: bool = False) -> str:
        """Return the absolute name of a topic or a service (`kind`), remapped."""

    def logger_name(self) -> str:
        """Return the name of the node's logger."""


class _End(Destroyable):
    """What all four have in common: a node, a name and a place in the graph."""

    def __init__(self, node: Owner, kind: str, the_type: Any, name: str, profile: Profile | None, what: str) -> None:
        self._destroyed = True
        service = kind in (SERVICE, CLIENT)
        fault = topic_fault(name)
        if fault is None:
            resolved = node.resolve(name, "service" if service else "topic")
            fault = full_topic_fault(resolved)
        if fault:
            noun = "service" if service else "topic"
            raise ValueError(f"Failed to create {what} due to invalid {noun} name '{name}'")
        node.context.require_valid(f"Failed to create {what}", "rcl/node.c:400")
        self.node = node
        self.type = the_type
        here = participant.current()
        self.end: LocalEndpoint = here.add_endpoint(
            kind, node.info, resolved, type_name_of(the_type), profile or _DEFAULT
        )
        super().__init__()

    def _destroy(self) -> None:
        self.end.close()

    def is_ready(self) -> bool:
        """Return whether anything has arrived."""
        return bool(self.end.inbox)

    def get_logger_name(self) -> str:
        """Return the name of the node's logger."""
        return self.node.logger_name()

    def _matches(self) -> int:
        self.end.participant.pump()
        return len(self.end.matched)


class Publisher(_End):
    """A publisher."""

    def __init__(self, node: Owner, message_class: Any, topic: str, profile: Profile | None) -> None:
        super().__init__(node, PUBLISHER, message_class, topic, profile, "publisher")

    def publish(self, message: Any) -> None:
        """Publish a message. Raises RCLError once the publisher has been destroyed."""
        self.publish_raw(serialize(message))

    def publish_raw(self, data: bytes) -> None:
        """Publish bytes that are already a serialized message."""
        if self._destroyed:
            raise RCLError(f"Failed to publish: {at('publisher pointer is invalid', 'rcl/publisher.c:434')}")
        self.end.publish(bytes(data))

    def get_topic_name(self) -> str:
        """Return the absolute name of the topic."""
        if self._destroyed:
            raise RCLError(f"failed to get topic name: {at('publisher pointer is invalid', 'rcl/publisher.c:434')}")
        return self.end.info.topic

    def get_subscription_count(self) -> int:
        """Return the number of matched subscriptions."""
        return self._matches()

    def wait_for_all_acked(self, timeout: rcl_duration_t) -> bool:
        """Return at once: publishing delivers immediately, so every message is acknowledged."""
        return True


class Subscription(_End):
    """A subscription."""

    def __init__(self, node: Owner, message_class: Any, topic: str, profile: Profile | None) -> None:
        super().__init__(node, SUBSCRIPTION, message_class, topic, profile, "subscription")

    def take_message(self, message_class: Any, raw: bool) -> tuple[Any, dict[str, int | None]] | None:
        """Return the oldest message and what is known about it, or None."""
        arrival = self.end.take()
        if arrival is None:
            return None
        message = arrival.data if raw else read(arrival.data, message_class)
        return message, {
            "source_timestamp": arrival.sent,
            "received_timestamp": arrival.came,
            "publication_sequence_number": arrival.sequence,
            "reception_sequence_number": None,
        }

    def get_topic_name(self) -> str:
        """Return the absolute name of the topic."""
        return self.end.info.topic

    def get_publisher_count(self) -> int:
        """Return the number of matched publishers."""
        return self._matches()


def read(data: bytes, message_class: Any) -> Any:
    """Return the message in these bytes. Raises RMWError if there is none."""
    try:
        return deserialize(data, message_class)
    except (ValueError, struct.error, UnicodeError) as error:
        raise RMWError(f"failed to deserialize ROS message: {error}") from None


class _IntrospectedEnd(_End):
    """A service or a client, which can publish its requests and responses (REP 2012)."""

    _introspection: ServiceIntrospectionState = ServiceIntrospectionState.OFF
    _publisher: Publisher | None = None
    _clock: Clock | None = None

    def configure_introspection(self, clock: Clock, profile: Any, state: ServiceIntrospectionState) -> None:
        """Set how much is published on the topic NAME/_service_event."""
        self._clock = clock
        self._introspection = ServiceIntrospectionState(int(state))
        if self._introspection is ServiceIntrospectionState.OFF:
            self._stop_introspection()
        elif self._publisher is None:
            topic = f"{self.end.info.topic}/_service_event"
            self._publisher = Publisher(self.node, self.type.Event, topic, profile)

    def _stop_introspection(self) -> None:
        if self._publisher is not None:
            self._publisher.destroy_when_not_in_use()
            self._publisher = None

    def _destroy(self) -> None:
        self._stop_introspection()
        super()._destroy()

    def _report(self, event: int, number: int, client: str, part: str, message: Any) -> None:
        """Publish one step of a call: 0 sent and 1 received a request, 2 sent and 3 received a response."""
        if self._publisher is None or self._clock is None:
            return
        from service_msgs.msg import ServiceEventInfo

        now = self._clock.get_now().nanoseconds
        info = ServiceEventInfo(event_type=event, sequence_number=number, client_gid=_client_gid(client))
        info.stamp.sec, info.stamp.nanosec = divmod(now, 10**9)
        report = self.type.Event(info=info)
        if self._introspection is ServiceIntrospectionState.CONTENTS:
            setattr(report, part, [copy.deepcopy(message)])
        self._publisher.publish(report)


def _client_gid(client: str) -> Any:
    import numpy

    return numpy.array(list(client.encode()[-16:].rjust(16, b"\0")), dtype=numpy.uint8)


class Service(_IntrospectedEnd):
    """The server end of a service."""

    def __init__(self, node: Owner, service_class: Any, name: str, profile: Profile | None) -> None:
        super().__init__(node, SERVICE, service_class, name, profile, "service")

    @property
    def name(self) -> str:
        """The absolute name of the service."""
        return self.end.info.topic

    @property
    def qos(self) -> dict[str, Any]:
        """The profile in the form of rclpy's QoSProfile."""
        return self.end.info.qos.to_dict()

    def service_take_request(self, request_class: Any) -> tuple[Any, rmw_service_info_t | None]:
        """Return the oldest request and its header, or (None, None)."""
        arrival = self.end.take()
        if arrival is None:
            return None, None
        request = read(arrival.data, request_class)
        self._report(1, arrival.sequence, arrival.source, "request", request)
        return request, header_of(arrival)

    def service_send_response(self, response: Any, header: rmw_request_id_t | rmw_service_info_t) -> None:
        """Answer a request."""
        identity = header.request_id if isinstance(header, rmw_service_info_t) else header
        self._report(2, identity.sequence_number, identity.client, "response", response)
        here = self.end.participant
        here.respond(self.end, identity.client, identity.sequence_number, serialize(response))


def header_of(arrival: Arrival) -> rmw_service_info_t:
    """Return the header: the number of a request, or of the one it answers, and times."""
    return rmw_service_info_t(rmw_request_id_t(arrival.sequence, arrival.source), arrival.sent, arrival.came)


class Client(_IntrospectedEnd):
    """The client end of a service."""

    def __init__(self, node: Owner, service_class: Any, name: str, profile: Profile | None) -> None:
        super().__init__(node, CLIENT, service_class, name, profile, "client")

    @property
    def service_name(self) -> str:
        """The absolute name of the service."""
        return self.end.info.topic

    def service_server_is_available(self) -> bool:
        """Return whether there is a server."""
        return self._matches() > 0

    def send_request(self, request: Any) -> int:
        """Send a request; return its number."""
        number = self.end.participant.request(self.end, serialize(request))
        self._report(0, number, self.end.info.gid, "request", request)
        return number

    def take_response(self, response_class: Any) -> tuple[rmw_service_info_t | None, Any]:
        """Return the oldest response and its header, or (None, None)."""
        arrival = self.end.take()
        if arrival is None:
            return None, None
        response = read(arrival.data, response_class)
        self._report(3, arrival.sequence, self.end.info.gid, "response", response)
        return header_of(arrival), response


#: Which of an endpoint's statuses an event takes.
_STATUS = {
    "RCL_PUBLISHER_OFFERED_DEADLINE_MISSED": "offered_deadline",
    "RCL_PUBLISHER_OFFERED_INCOMPATIBLE_QOS": "incompatible",
    "RCL_PUBLISHER_INCOMPATIBLE_TYPE": "other_type",
    "RCL_PUBLISHER_MATCHED": "matched",
    "RCL_SUBSCRIPTION_REQUESTED_DEADLINE_MISSED": "requested_deadline",
    "RCL_SUBSCRIPTION_LIVELINESS_CHANGED": "liveliness",
    "RCL_SUBSCRIPTION_REQUESTED_INCOMPATIBLE_QOS": "incompatible",
    "RCL_SUBSCRIPTION_INCOMPATIBLE_TYPE": "other_type",
    "RCL_SUBSCRIPTION_MATCHED": "matched",
}


class EventHandle(Destroyable):
    """Reports events of a publisher or a subscription to a program."""

    def __init__(self, parent: Publisher | Subscription, event_type: Any) -> None:
        super().__init__()
        self.parent = parent
        self._event = event_type
        self._kind = _STATUS.get(event_type.name, "")

    def is_ready(self) -> bool:
        """Return whether anything has changed since the last time."""
        self.parent.end.late()
        status = getattr(self.parent.end.statuses, self._kind, None)
        return status is not None and any(value for name, value in vars(status).items() if name.endswith("_change"))

    def due(self) -> int | None:
        """Return when the next deadline passes (ns, steady), if this reports deadlines."""
        return self.parent.end.due if self._kind.endswith("deadline") else None

    def take_event(self) -> Any:
        """Return the counts, and their changes since the last time; None if nothing is counted."""
        self.parent.end.late()
        status = getattr(self.parent.end.statuses, self._kind, None)
        if status is None:
            return self._nothing()
        taken = copy.copy(status)
        for name in vars(status):
            if name.endswith("_change"):
                setattr(status, name, 0)
        return taken

    def _nothing(self) -> Any:
        """Return zeros for lost messages and lost liveliness: neither ever happens here."""
        is_liveliness = self._event.name == "RCL_PUBLISHER_LIVELINESS_LOST"
        return rmw_liveliness_lost_status_t() if is_liveliness else rmw_message_lost_status_t()
