"""The rig's own part of the ROS graph: one participant, the nodes in it, and an executor that turns them."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any

import rclpy
from rclpy.context import Context
from rclpy.executors import SingleThreadedExecutor, TimeoutException
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, HistoryPolicy, QoSProfile, ReliabilityPolicy
from rclpy.signals import SignalHandlerOptions

#: Compatible with whatever a student's subscription asks for.
OFFER = QoSProfile(
    history=HistoryPolicy.KEEP_LAST,
    depth=1000,
    reliability=ReliabilityPolicy.RELIABLE,
    durability=DurabilityPolicy.TRANSIENT_LOCAL,
)

#: Loses nothing of what a student publishes, not even what is published before the two ends know one another.
ACCEPT = QoSProfile(
    history=HistoryPolicy.KEEP_LAST,
    depth=10_000,
    reliability=ReliabilityPolicy.RELIABLE,
    durability=DurabilityPolicy.VOLATILE,
)

#: Compatible with whatever a student's publisher offers.
ACCEPT_ANY = QoSProfile(
    history=HistoryPolicy.KEEP_LAST,
    depth=10_000,
    reliability=ReliabilityPolicy.BEST_EFFORT,
    durability=DurabilityPolicy.VOLATILE,
)


class Ros:
    """The rig's participant in one ROS domain. Use it as a context manager."""

    def __init__(self, domain: int | None = None) -> None:
        self.context = Context()
        rclpy.init(context=self.context, domain_id=domain, args=[], signal_handler_options=SignalHandlerOptions.NO)
        self.executor = SingleThreadedExecutor(context=self.context)
        self.names: list[str] = []
        self._nodes: list[Any] = []

    def node(self, name: str) -> Any:
        """A new node of the rig's, as light as a node can be."""
        node = Node(
            name,
            context=self.context,
            use_global_arguments=False,
            enable_rosout=False,
            start_parameter_services=False,
            parameter_overrides=[rclpy.Parameter("start_type_description_service", value=False)],
        )
        self.names.append(f"/{name}")
        self._nodes.append(node)
        return node

    def turn_until(self, done: Callable[[], bool], meanwhile: Callable[[], None], every_s: float = 0.02) -> None:
        """Handle what arrives until `done`; `meanwhile` is called at least every `every_s` and may raise."""
        due = time.monotonic() + every_s
        while not done():
            self.executor.spin_once(timeout_sec=every_s)
            if time.monotonic() >= due:
                meanwhile()
                due = time.monotonic() + every_s

    def turn(self) -> None:
        """Handle everything that has arrived already."""
        while self._pass():
            pass

    def _pass(self) -> bool:
        """Handle one message of each end point that has any; whether there were any."""
        some = False
        while True:
            try:
                handler, _, _ = self.executor.wait_for_ready_callbacks(timeout_sec=0)
            except TimeoutException:
                return some
            some = True
            handler()
            if handler.exception() is not None:
                raise handler.exception()

    def __enter__(self) -> Ros:
        return self

    def __exit__(self, *error: object) -> None:
        self.executor.shutdown(timeout_sec=0)
        for node in self._nodes:
            node.destroy_node()
        self.context.try_shutdown()
