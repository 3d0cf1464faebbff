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
        self.unanswered = 0
        self.answer: Any = None

    @property
    def ready(self) -> bool:
        """Whether the service can be called."""
        return bool(self._client.service_is_ready())

    @property
    def handle(self) -> Any:
        """What can be waited for."""
        return self._client.handle

    def call(self, request: Any) -> None:
        """Send a request and return at once."""
        self._client.handle.send_request(request)
        self.unanswered += 1

    def take(self) -> None:
        """Take the answers that have come."""
        while self.unanswered:
            header, answer = self._client.handle.take_response(self._kind.Response)
            if header is None:
                return
            self.answer = answer
            self.unanswered -= 1

    def close(self) -> None:
        """Forget the service."""
        self._node.destroy_client(self._client)


class Answers:
    """What is still to be answered by any of `callers`, all of them of one node's context."""

    def __init__(self, context: Any, callers: Sequence[Caller]) -> None:
        self._callers = callers
        self._waiting = rclpy_implementation.WaitSet(0, 0, 0, len(callers), 0, 0, context.handle)

    def all_there(self) -> bool:
        """Whether every call is answered."""
        return not any(caller.unanswered for caller in self._callers)

    def wait(self, at_most_s: float) -> None:
        """Wait until an answer comes, and take what has come."""
        self._waiting.clear_entities()
        for caller in self._callers:
            if caller.unanswered:
                self._waiting.add_client(caller.handle)
        self._waiting.wait(int(at_most_s * NANOSECONDS))
        for caller in self._callers:
            caller.take()
