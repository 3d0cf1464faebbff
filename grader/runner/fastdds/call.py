"""Calls services of the student's nodes without an executor, in the way of rclpy's own `wait_for_message`."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from rclpy.impl.implementation_singleton import rclpy_implementation
from rclpy.node import Node

NANOSECONDS = 1_000_000_000


class Caller:
    """Calls one service, as often as `call` says, and keeps the last answer."""

    def __init__(self, node: Any, kind: Any, name: str) -> None:
        self._node: Node = node
        self._client = node.create_client(kind, name)
        self._kind = kind
        self._unanswered: set[int] = set()
        self.answer: Any = None

    @property
    def ready(self) -> bool:
        """Whether the service can be called."""
        return bool(self._client.service_is_ready())

    @property
    def handle(self) -> Any:
        """What can be waited for."""
        return self._client.handle

    @property
    def answered(self) -> bool:
        """Whether all calls are."""
        return not self._unanswered

    def call(self, request: Any) -> None:
        """Send a request and return at once."""
        self._unanswered.add(self._client.handle.send_request(request))

    def call_again(self, request: Any) -> None:
        """Send a request in place of all that have had no answer; should theirs come yet, they count for nothing."""
        times, self._unanswered = len(self._unanswered), set()
        for _ in range(times):
            self.call(request)

    def take(self) -> None:
        """Take the answers that have come."""
        while self._unanswered:
            header, answer = self._client.handle.take_response(self._kind.Response)
            if header is None:
                return
            number = header.request_id.sequence_number
            if number in self._unanswered:
                self._unanswered.remove(number)
                self.answer = answer

    def close(self) -> None:
        """Forget the service."""
        self._node.destroy_client(self._client)


class Calls:
    """Calls under way, each of `(caller, request)`, all of one context's."""

    def __init__(self, context: Any, calls: Sequence[tuple[Caller, Any]]) -> None:
        self._calls = calls
        self._waiting = rclpy_implementation.WaitSet(0, 0, 0, len(calls), 0, 0, context.handle)

    def ready(self) -> bool:
        """Whether every service can be called."""
        return all(caller.ready for caller, _ in self._calls)

    def call(self, times: int) -> None:
        """Call every service so often, and return at once."""
        for caller, request in self._calls:
            for _ in range(times):
                caller.call(request)

    def call_again(self) -> None:
        """Repeat what has not been answered.

        An answer is lost where the service has not yet heard of who asks: a service of rclpy that does not find the
        reader of its answer drops it (rmw_fastrtps, `__rmw_send_response`).
        """
        for caller, request in self._calls:
            caller.call_again(request)

    def answered(self) -> bool:
        """Whether every call is answered."""
        return all(caller.answered for caller, _ in self._calls)

    def wait(self, at_most_s: float) -> None:
        """Wait until an answer comes, and take what has come."""
        self._waiting.clear_entities()
        for caller, _ in self._calls:
            if not caller.answered:
                self._waiting.add_client(caller.handle)
        self._waiting.wait(int(at_most_s * NANOSECONDS))
        for caller, _ in self._calls:
            caller.take()
