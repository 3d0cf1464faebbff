"""Records what happens on services, actions and topics, one JSON array per line, in its own process next to the kernel.

    python -m spinbook.kernel.timeline_recorder NAME …

Lines: ["found", name, "action" | "service" | "topic"], ["error", words], and events, ["event", time (s), name, what,
goal, text], where `what` is one of those in timeline.py, `goal` is a goal's number (hexadecimal) or "".

Requests are read by a second server that never answers, answers from their DDS topic, feedback and status by
subscribing. Times are those of sending.

A client that has found this second server and not yet the real one believes that the service is ready, and its request
would be lost. So the requests of a service are read only if it has a client already, which then knows the real one.
Clients of an action also wait for its status and feedback, which this does not publish.
"""

from __future__ import annotations

import signal
import sys
import threading
import time
from collections.abc import Callable, Iterator, Mapping
from functools import partial
from typing import Any

import rclpy
from action_msgs.msg import GoalStatus
from rclpy.action import get_action_names_and_types
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy, qos_profile_services_default
from rclpy.signals import SignalHandlerOptions

from ros_in_python.ros2.interfaces import action_class, message_class, service_class
from spinbook.kernel.recorder_lines import errors_written, write_line
from spinbook.kernel.reply_reader import ServiceReplyReader

_HEARS_ALL = QoSProfile(depth=100, reliability=ReliabilityPolicy.BEST_EFFORT, durability=DurabilityPolicy.VOLATILE)
_FEEDBACK = QoSProfile(depth=100)
_STATUS = QoSProfile(depth=100, durability=DurabilityPolicy.TRANSIENT_LOCAL)
_LOOK_S = 0.01
#: How long after a service its clients are discovered at the latest (s).
_CLIENTS_S = 0.5

#: Reads what has arrived: (time of sending in s, message).
Take = Callable[[], Iterator[tuple[float, Any]]]


class TimelineRecorder(Node):
    """Finds out what the names mean, and prints each of their events."""

    def __init__(self, names: list[str]) -> None:
        # With parameter services: the `ros2` command uses them to make sure that a server has discovered its client.
        super().__init__("_spinbook_timeline", enable_rosout=False)
        self._began = time.time()
        self._missing = list(names)
        self._polled: list[tuple[Take, Callable[[float, Any], None]]] = []
        self._states: dict[str, int] = {}
        self._kept: list[Any] = []
        self._seen: dict[str, float] = {}

    def look(self) -> None:
        """Look for what has not been found yet, and take in what has arrived."""
        for name in list(self._missing):
            if (found := self._kind(name)) and self._is_known(name, found[0]):
                self._missing.remove(name)
                kind, type_name = found
                getattr(self, f"_follow_{kind}")(name, type_name)
                write_line("found", name, kind)
        for take, record in self._polled:
            for sent, message in take():
                record(sent, message)

    def _is_known(self, name: str, kind: str) -> bool:
        """Return whether the users of what was found are known: a service's clients may not be discovered yet."""
        since = time.monotonic() - self._seen.setdefault(name, time.monotonic())
        return kind != "service" or self.count_clients(name) > 0 or since > _CLIENTS_S

    def _kind(self, name: str) -> tuple[str, str] | None:
        """Return what a name means, and its type, if there is a node that serves or publishes it."""
        ready = self.count_publishers(f"{name}/_action/status") > 0
        tables: Mapping[str, tuple[bool, list[tuple[str, list[str]]]]] = {
            "action": (ready, get_action_names_and_types(self)),
            "service": (self.count_services(name) > 0, self.get_service_names_and_types()),
            "topic": (self.count_publishers(name) > 0, self.get_topic_names_and_types()),
        }
        for kind, (is_there, table) in tables.items():
            if is_there and name in dict(table):
                return kind, dict(table)[name][0]
        return None

    # Topics

    def _follow_topic(self, name: str, type_name: str) -> None:
        self._subscribe(message_class(type_name), name, _HEARS_ALL, partial(_event, name, "message"))

    def _subscribe(self, kind: Any, topic: str, qos: QoSProfile, record: Callable[..., None]) -> None:
        self._kept.append(self.create_subscription(kind, topic, _callback(record), qos))

    # Services

    def _follow_service(self, name: str, type_name: str) -> None:
        kind = service_class(type_name)
        if self.count_clients(name):
            self._polled.append((self._requests(kind, name), partial(_event, name, "request")))
        self._polled.append((ServiceReplyReader(self, name, kind.Response).take, partial(_event, name, "response")))

    def _follow_calls(self, kind: Any, name: str, asked: Callable[..., None], answered: Callable[..., None]) -> None:
        self._polled.append((self._requests(kind, name), asked))
        self._polled.append((ServiceReplyReader(self, name, kind.Response).take, answered))

    def _requests(self, kind: Any, name: str) -> Take:
        """Return a reader of a service's requests, which takes them like a server but never answers."""
        from rclpy.impl.implementation_singleton import rclpy_implementation
        from rclpy.type_support import check_for_type_support

        check_for_type_support(kind)
        with self.handle:
            qos = qos_profile_services_default.get_c_qos_profile()
            server = rclpy_implementation.Service(self.handle, kind, name, qos)
        self._kept.append(server)

        def take() -> Iterator[tuple[float, Any]]:
            while True:
                with server:
                    request, header = server.service_take_request(kind.Request)
                if request is None or header is None:
                    return
                yield header.source_timestamp / 1e9, request

        return take

    # Actions

    def _follow_action(self, name: str, type_name: str) -> None:
        kind = action_class(type_name).Impl
        own = f"{name}/_action"
        self._follow_calls(
            kind.SendGoalService,
            f"{own}/send_goal",
            lambda at, asked: _event(name, "goal", at, asked.goal, _number(asked.goal_id)),
            lambda at, answer: write_line("event", at, name, "accepted" if answer.accepted else "rejected", "", ""),
        )
        self._follow_calls(
            kind.CancelGoalService,
            f"{own}/cancel_goal",
            lambda at, asked: write_line("event", at, name, "cancel", _number(asked.goal_info.goal_id), ""),
            lambda at, answer: write_line(
                "event", at, name, "cancel answered", "", f"{len(answer.goals_canceling)} to be canceled"
            ),
        )
        self._subscribe(
            kind.FeedbackMessage,
            f"{own}/feedback",
            _FEEDBACK,
            lambda at, message: _event(name, "feedback", at, message.feedback, _number(message.goal_id)),
        )
        self._subscribe(kind.GoalStatusMessage, f"{own}/status", _STATUS, partial(self._on_status, name))

    def _on_status(self, name: str, at: float, message: Any) -> None:
        """Write the states of goals that have changed."""
        for goal in message.status_list:
            number = _number(goal.goal_info.goal_id)
            if self._states.get(number) != goal.status:
                self._states[number] = goal.status
                # The status is kept for late subscribers: ignore what is older than the recording.
                if at >= self._began:
                    write_line("event", at, name, _STATES.get(goal.status, "UNKNOWN"), number, "")


_STATES = {
    getattr(GoalStatus, f"STATUS_{state}"): state
    for state in ("ACCEPTED", "EXECUTING", "CANCELING", "SUCCEEDED", "CANCELED", "ABORTED")
}


def _callback(record: Callable[..., None]) -> Any:
    """Return a callback with two parameters, to which rclpy also passes information about the message."""

    def callback(message: Any, information: dict[str, int]) -> None:
        record(information["source_timestamp"] / 1e9, message)

    return callback


def _number(goal_id: Any) -> str:
    return bytes(goal_id.uuid).hex()


def _event(name: str, what: str, at: float, message: Any, goal: str = "") -> None:
    write_line("event", at, name, what, goal, in_short(message))


def in_short(message: Any) -> str:
    """Return the first plain field of a message with its value, such as `position 1.0`; "" if it has none."""
    for field in message.get_fields_and_field_types():
        value = getattr(message, field)
        if isinstance(value, bool):
            return f"{field} {str(value).lower()}"
        if isinstance(value, int | str) and value != "":
            return f"{field} {value}"[:40]
        if isinstance(value, float):
            return f"{field} {value:.4g}"
    return ""


#: How many messages may still be unread when the recorder is stopped.
_MAY_WAIT = 300


def _stop_event() -> threading.Event:
    """Return an event that SIGINT and SIGTERM set. ROS keeps running, so that what has arrived can still be read."""
    text = threading.Event()
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, lambda *_: text.set())
    return text


def record(recorder: TimelineRecorder, stop_requested: threading.Event) -> None:
    """Record until stopped, then read what has already arrived: on a busy machine that may be a lot."""
    while not stop_requested.is_set():
        rclpy.spin_once(recorder, timeout_sec=_LOOK_S)
        recorder.look()
    for _ in range(_MAY_WAIT):
        rclpy.spin_once(recorder, timeout_sec=0)
        recorder.look()


def main() -> None:
    """Record until stopped."""
    stop_requested = _stop_event()
    rclpy.init(signal_handler_options=SignalHandlerOptions.NO)
    try:
        with errors_written():
            recorder: TimelineRecorder = TimelineRecorder(sys.argv[1:])
            try:
                record(recorder, stop_requested)
            finally:
                recorder.destroy_node()  # type: ignore[no-untyped-call]
    finally:
        rclpy.try_shutdown()


if __name__ == "__main__":
    main()
