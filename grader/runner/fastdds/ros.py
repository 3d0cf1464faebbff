"""The rig's own part of the ROS graph: one participant, and the nodes in it.

The grader's end has no executor. It publishes, calls services (see `call`) and takes what has come (see `recorder`) in
the order that it decides on itself; waiting by executor costs more than all else.
"""

from __future__ import annotations

from typing import Any

import rclpy
from rclpy.context import Context
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

    def __enter__(self) -> Ros:
        return self

    def __exit__(self, *error: object) -> None:
        for node in self._nodes:
            node.destroy_node()
        self.context.try_shutdown()
