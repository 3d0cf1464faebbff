"""A node that answers, for tests of types between two processes: `python peer.py TYPE …`.

For each message type N it sends back on /back_N what arrives on /there_N. A service's response gets the request's
fields of the same names, or the sum of a and b. An action is Fibonacci, which gives each step as feedback; if more
than ten are requested, it repeats the tenth until it is cancelled.
"""

from __future__ import annotations

import importlib
import sys
from typing import Any

import rclpy
from rclpy.action import ActionServer, CancelResponse
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.executors import ExternalShutdownException, MultiThreadedExecutor
from rclpy.node import Node


def load(name: str) -> Any:
    package, kind, short = name.split("/")
    return getattr(importlib.import_module(f"{package}.{kind}"), short)


class Peer(Node):
    def __init__(self, types: list[str]) -> None:
        super().__init__("peer")
        for number, name in enumerate(types):
            getattr(self, name.split("/")[1])(number, load(name))

    def msg(self, number: int, kind: Any) -> None:
        back = self.create_publisher(kind, f"/back_{number}", 10)
        self.create_subscription(kind, f"/there_{number}", back.publish, 10)

    def srv(self, number: int, kind: Any) -> None:
        self.create_service(kind, f"/ask_{number}", answer)

    def action(self, number: int, kind: Any) -> None:
        self.kind = kind
        ActionServer(
            self,
            kind,
            f"/do_{number}",
            self.fibonacci,
            cancel_callback=lambda _: CancelResponse.ACCEPT,
            callback_group=ReentrantCallbackGroup(),
        )

    def fibonacci(self, goal: Any) -> Any:
        sequence = [0, 1]
        clock = self.get_clock()
        while len(sequence) <= goal.request.order:
            if goal.is_cancel_requested:
                goal.canceled()
                return self.kind.Result(sequence=sequence)
            if len(sequence) <= 10:
                sequence.append(sequence[-1] + sequence[-2])
            else:
                clock.sleep_for(rclpy.duration.Duration(seconds=0.02))
            goal.publish_feedback(self.kind.Feedback(sequence=sequence))
        goal.succeed()
        return self.kind.Result(sequence=sequence)


def answer(request: Any, response: Any) -> Any:
    if hasattr(response, "sum"):
        response.sum = request.a + request.b
    for field in response.get_fields_and_field_types():
        if hasattr(request, field):
            setattr(response, field, getattr(request, field))
    return response


def main() -> None:
    rclpy.init()
    executor = MultiThreadedExecutor(4)
    executor.add_node(Peer(sys.argv[1:]))
    try:
        executor.spin()
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        rclpy.try_shutdown()


if __name__ == "__main__":
    main()
