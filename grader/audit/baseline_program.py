"""A program without any work in it: it has an exercise's interface, and fills messages without thought.

It is never imported. `grader.audit.baselines` replaces its settings, and the audit runs the text as a submission.
"""

import importlib
import json
import random
from typing import Any

import rclpy
from rclpy.action import ActionClient, ActionServer
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy

SETTINGS = json.loads("{}")

CHANCE = random.Random(1)


def kind(name: str) -> Any:
    """Return the class of a type, such as std_msgs/msg/String."""
    package, folder, name = name.split("/")
    return getattr(importlib.import_module(f"{package}.{folder}"), name)


def filled(message: Any, source: Any = None) -> Any:
    """Fill a message: what `source` has by the same name and type is copied, and its numbers are replaced."""
    theirs = source.get_fields_and_field_types() if source is not None else {}
    mine = message.get_fields_and_field_types()
    names = [n for n, type_ in mine.items() if theirs.get(n) == type_ == "sequence<string>"]
    length = max([len(getattr(source, name)) for name in names], default=1)
    for name, type_ in mine.items():
        copied = theirs.get(name) == type_
        value = getattr(source if copied else message, name)
        setattr(
            message, name, value if copied and type_ == "std_msgs/Header" else replaced(value, type_, length, copied)
        )
    return message


def replaced(value: Any, type_: str, length: int, copied: bool) -> Any:
    """Return the value with other numbers, or a list of `length` values."""
    style = SETTINGS["style"]
    if hasattr(value, "get_fields_and_field_types"):
        return filled(value, value if style == "echo" else None)
    if type_.startswith("sequence<") and "/" not in type_ and not (copied and (style == "echo" or "string" in type_)):
        return [replaced(one(type_), "", 1, False) for _ in range(length)]
    if style == "echo" or type_.startswith("sequence<"):
        return value
    if isinstance(value, bool):
        return {"zeros": False, "a constant": True, "random values": CHANCE.random() < 0.5}[style]
    if isinstance(value, float):
        return {"zeros": 0.0, "a constant": 1.0, "random values": CHANCE.uniform(-1.0, 1.0)}[style]
    if isinstance(value, int):
        return {"zeros": 0, "a constant": 1, "random values": CHANCE.randrange(100)}[style]
    if isinstance(value, str) and not copied:
        return {"zeros": "", "a constant": SETTINGS["text"], "random values": CHANCE.choice("abc")}[style]
    return value


def one(type_: str) -> Any:
    """Return an element of a list of this type."""
    return (
        "" if "string" in type_ else False if "bool" in type_ else 0.0 if "float" in type_ or "double" in type_ else 0
    )


class Baseline(Node):
    """Has every end of the exercise, and answers everything."""

    def __init__(self) -> None:
        super().__init__(SETTINGS["node"])
        for name, default in SETTINGS["parameters"]:
            self.declare_parameter(name, default)
        self.outputs = [
            (self.create_publisher(kind(type_), name, qos(*quality)), kind(type_))
            for name, type_, quality, _ in SETTINGS["publish"]
        ]
        self.clients_ = [(self.create_client(kind(t), name), kind(t)) for name, t in SETTINGS["client"]]
        self.goals = [(ActionClient(self, kind(t), name), kind(t)) for name, t in SETTINGS["action_client"]]
        for name, type_ in SETTINGS["service"]:
            self.create_service(kind(type_), name, lambda request, response: filled(response, request))
        for name, type_ in SETTINGS["action"]:
            ActionServer(self, kind(type_), name, lambda goal, type_=type_: self.execute(goal, kind(type_)))
        for name, type_, quality in SETTINGS["subscribe"]:
            self.create_subscription(kind(type_), name, self.on_message, qos(*quality))
        for output, (*_, period) in zip(self.outputs, SETTINGS["publish"], strict=True):
            if period:
                self.create_timer(period, lambda output=output: self.publish(output, None))
            elif not SETTINGS["subscribe"]:
                self.publish(output, None)

    def publish(self, output: Any, source: Any) -> None:
        publisher, type_ = output
        publisher.publish(filled(type_(), source))

    def on_message(self, message: Any) -> None:
        for output, (*_, period) in zip(self.outputs, SETTINGS["publish"], strict=True):
            if not period:
                self.publish(output, message)
        for client, type_ in self.clients_:
            client.call_async(filled(type_.Request(), message))
        for sender, type_ in self.goals:
            sender.send_goal_async(filled(type_.Goal(), message))

    def execute(self, goal: Any, type_: Any) -> Any:
        goal.publish_feedback(filled(type_.Feedback(), goal.request))
        goal.succeed()
        return filled(type_.Result(), goal.request)


def qos(reliability: str, durability: str, depth: int) -> QoSProfile:
    """Return the quality of service of an end."""
    return QoSProfile(
        depth=depth, reliability=ReliabilityPolicy[reliability.upper()], durability=DurabilityPolicy[durability.upper()]
    )


def main() -> None:
    """Run the node until Ctrl-C."""
    rclpy.init()
    try:
        rclpy.spin(Baseline())
    except (KeyboardInterrupt, ExternalShutdownException):
        rclpy.try_shutdown()


if __name__ == "__main__":
    main()
