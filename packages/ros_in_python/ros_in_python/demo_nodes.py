"""The nodes of demo_nodes_cpp and demo_nodes_py that introductions to ROS 2 begin with: topics and a service.

    python -m ros_in_python.demo_nodes cpp talker

PyPI has neither package. These nodes are written anew; their names, topics and log lines are those of ROS 2 Jazzy:
https://github.com/ros2/demos. Both packages run on rclpy here; what differs between the two is in `LANGUAGES`.
"""

from __future__ import annotations

import importlib
import itertools
import signal
import sys
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import rclpy
from rclpy.node import Node
from rclpy.signals import SignalHandlerOptions
from std_msgs.msg import String

from interface_compiler import shipped
from ros_in_python.spinning import NOTICE_S, spin_until_stopped

#: The time between two messages, and how long the client waits before it says that there is no service (s).
PERIOD_S = 1.0


@dataclass(frozen=True)
class Language:
    """How the nodes of one package differ from the other's."""

    first: int
    """The number in the talker's first message."""
    quote: str
    """The quotation mark around a message in the talker's log."""
    depth: int
    """The depth of the talker's queue."""
    logs_waiting: bool
    """Whether the client logs that it is waiting; otherwise it prints that."""


LANGUAGES = {
    "cpp": Language(first=1, quote="'", depth=7, logs_waiting=True),
    "py": Language(first=0, quote='"', depth=10, logs_waiting=False),
}


def talker(language: Language) -> Node:
    """Make the node that publishes a numbered greeting on `chatter` every second."""
    node = Node("talker")
    publisher = node.create_publisher(String, "chatter", language.depth)
    numbers = itertools.count(language.first)

    def publish() -> None:
        message = String(data=f"Hello World: {next(numbers)}")
        node.get_logger().info(f"Publishing: {language.quote}{message.data}{language.quote}")
        publisher.publish(message)

    node.create_timer(PERIOD_S, publish)
    return node


def listener(language: Language) -> Node:
    """Make the node that logs what it hears on `chatter`, the same in both packages."""
    node = Node("listener")

    def hear(message: Any) -> None:
        node.get_logger().info(f"I heard: [{message.data}]")

    node.create_subscription(String, "chatter", hear, 10)
    return node


def add_two_ints_server(language: Language) -> Node:
    """Make the node that offers the service `add_two_ints`, the same in both packages."""
    node = Node("add_two_ints_server")

    def add(request: Any, response: Any) -> Any:
        node.get_logger().info(f"Incoming request\na: {request.a} b: {request.b}")
        response.sum = request.a + request.b
        return response

    node.create_service(_add_two_ints(), "add_two_ints", add)
    return node


def add_two_ints_client(language: Language) -> int:
    """Wait for the service, ask it for 2 + 3 and log the answer; return the exit code.

    The signals are ours and not rclpy's, for the reason that `spin_until_stopped` gives.
    """
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, signal.default_int_handler)
    rclpy.init(signal_handler_options=SignalHandlerOptions.NO)
    try:
        node = Node("add_two_ints_client")
        say = node.get_logger().info if language.logs_waiting else _print
        client = node.create_client(_add_two_ints(), "add_two_ints")
        while not client.wait_for_service(timeout_sec=PERIOD_S):
            say("service not available, waiting again...")
        answer = client.call_async(_add_two_ints().Request(a=2, b=3))
        while not answer.done():
            rclpy.spin_once(node, timeout_sec=NOTICE_S)
        node.get_logger().info(f"Result of add_two_ints: {answer.result().sum}")
    except KeyboardInterrupt:
        pass
    finally:
        rclpy.shutdown()
    return 0


def _print(text: str) -> None:
    print(text, flush=True)


def _add_two_ints() -> Any:
    try:
        service = importlib.import_module("example_interfaces.srv").AddTwoInts
    except ImportError:
        raise SystemExit(
            f"example_interfaces is not installed here. {shipped.how_to_add('example_interfaces')}\n"
            "With a sourced ROS 2: sudo apt-get install ros-jazzy-example-interfaces"
        ) from None
    return service


#: Executable -> the function that makes its node, which is spun until the process is stopped.
NODES: dict[str, Callable[[Language], Node]] = {
    "add_two_ints_server": add_two_ints_server,
    "listener": listener,
    "talker": talker,
}


def main(words: Sequence[str]) -> int:
    """Run an executable, given by its package's language and its name; return the exit code."""
    language, executable = LANGUAGES[words[0]], words[1]
    if executable == "add_two_ints_client":
        return add_two_ints_client(language)
    return spin_until_stopped(lambda: NODES[executable](language))


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
