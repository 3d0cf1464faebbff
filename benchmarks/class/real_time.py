"""Plays scenarios to a node in real time, as a notebook's tests must: what nbgrader and otter-grader run.

It is next to the notebooks; scenarios.json has what to play: see against_others.py.
"""

from __future__ import annotations

import json
import math
import threading
import time
from pathlib import Path
from typing import Any

SCENARIOS = Path(__file__).with_name("scenarios.json")


def play(node_class: type, name: str) -> bool:
    """Whether the node answers each message of a scenario as the solution does."""
    import rclpy
    from rclpy.executors import SingleThreadedExecutor
    from sensor_msgs.msg import JointState

    scenario = json.loads(SCENARIOS.read_text(encoding="utf-8"))[name]
    answers: list[Any] = []
    rclpy.init()
    try:
        student, runner = node_class(), rclpy.create_node("runner")
        publisher = runner.create_publisher(JointState, "/joint_commands", 10)
        runner.create_subscription(JointState, "/joint_velocities", answers.append, 100)
        executor = SingleThreadedExecutor()
        executor.add_node(student)
        executor.add_node(runner)
        thread = threading.Thread(target=executor.spin, daemon=True)
        thread.start()
        while not publisher.get_subscription_count():
            time.sleep(0.01)
        began = time.monotonic()
        for message in scenario["messages"]:
            time.sleep(max(0.0, began + message["at"] - time.monotonic()))
            publisher.publish(_message(JointState(), message["fields"]))
        time.sleep(0.5)
        executor.shutdown()
        thread.join()
    finally:
        rclpy.try_shutdown()
    got = [dict(zip(answer.name, answer.velocity, strict=False)) for answer in answers]
    return len(got) == len(scenario["expected"]) and all(map(_same, got, scenario["expected"]))


def _same(got: dict[str, float], expected: dict[str, float]) -> bool:
    return got.keys() == expected.keys() and all(
        math.isclose(got[joint], expected[joint], rel_tol=1e-6, abs_tol=1e-6) for joint in got
    )


def _message(message: Any, fields: dict[str, Any]) -> Any:
    for name, value in fields.items():
        if isinstance(value, dict):
            _message(getattr(message, name), value)
        else:
            setattr(message, name, value)
    return message
