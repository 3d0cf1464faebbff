"""Asks `peer.py` for the same types and prints what is not as expected: `python asker.py FILE`.

FILE contains JSON: each type, and the values of its message's or request's fields to send.
"""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import Any

import rclpy
from peer import load
from rclpy.action import ActionClient
from rclpy.node import Node

DEADLINE_S = 60.0


def fill(message: Any, values: dict[str, Any]) -> Any:
    for name, value in values.items():
        if isinstance(value, dict):
            fill(getattr(message, name), value)
        elif isinstance(value, list) and value and isinstance(value[0], dict):
            kind = message.get_fields_and_field_types()[name].partition("<")[2].partition(">")[0].partition(",")[0]
            package, short = kind.split("/")
            setattr(message, name, [fill(load(f"{package}/msg/{short}")(), each) for each in value])
        else:
            setattr(message, name, value)
    return message


def wait(node: Node, future: Any, what: str) -> Any:
    rclpy.spin_until_future_complete(node, future, timeout_sec=DEADLINE_S)
    if not future.done():
        raise SystemExit(f"{what}: no answer within {DEADLINE_S} s")
    return future.result()


def ask_message(node: Node, number: int, kind: Any, values: dict[str, Any]) -> None:
    sent = fill(kind(), values)
    back: Any = rclpy.task.Future()
    node.create_subscription(kind, f"/back_{number}", lambda message: back.done() or back.set_result(message), 10)
    publisher = node.create_publisher(kind, f"/there_{number}", 10)
    # Until both sides know each other, some are lost.
    timer = node.create_timer(0.1, lambda: publisher.publish(sent))
    received = wait(node, back, kind.__name__)
    timer.cancel()
    if received != sent:
        raise SystemExit(f"sent {sent}, received {received}")


def ask_service(node: Node, number: int, kind: Any, values: dict[str, Any]) -> None:
    request = fill(kind.Request(), values)
    client = node.create_client(kind, f"/ask_{number}")
    if not client.wait_for_service(DEADLINE_S):
        raise SystemExit(f"{kind.__name__}: there is no such service")
    response = wait(node, client.call_async(request), kind.__name__)
    expected = fill(
        kind.Response(),
        {"sum": request.a + request.b}
        if hasattr(response, "sum")
        else {name: getattr(request, name) for name in values if hasattr(response, name)},
    )
    if response != expected:
        raise SystemExit(f"expected {expected}, received {response}")


def ask_action(node: Node, number: int, kind: Any, values: dict[str, Any]) -> None:
    client = ActionClient(node, kind, f"/do_{number}")
    if not client.wait_for_server(DEADLINE_S):
        raise SystemExit(f"{kind.__name__}: there is no such action")
    step: Any = rclpy.task.Future()
    goal = wait(
        node,
        client.send_goal_async(
            kind.Goal(**values), feedback_callback=lambda arrived: step.done() or step.set_result(arrived.feedback)
        ),
        "goal",
    )
    if values["order"] > 10:
        # rclpy drops feedback that arrives before the response to the goal; only continued feedback is sure to arrive.
        wait(node, step, "feedback")
        wait(node, goal.cancel_goal_async(), "cancelling")
    ended = wait(node, goal.get_result_async(), "result")
    expected = 5 if values["order"] > 10 else 4
    if ended.status != expected:
        raise SystemExit(f"status {ended.status} instead of {expected}")
    if expected == 4 and list(ended.result.sequence) != [0, 1, 1, 2, 3, 5, 8][: values["order"] + 1]:
        raise SystemExit(f"the result is {ended.result}")


def main() -> None:
    rclpy.init()
    node = Node("asker")
    for number, (name, values) in enumerate(json.loads(Path(sys.argv[1]).read_text())):
        ask = {"msg": ask_message, "srv": ask_service, "action": ask_action}[name.split("/")[1]]
        ask(node, number, load(name), values)
    print("all as expected")
    rclpy.shutdown()


if __name__ == "__main__":
    main()
