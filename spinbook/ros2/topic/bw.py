"""`ros2 topic bw`."""

from __future__ import annotations

import time

import click

from spinbook.ros2.cli import CONTEXT, discovery_options
from spinbook.ros2.opening import open_graph
from spinbook.ros2.topic.statistics import Bandwidth

WINDOW = 100


@click.command(context_settings=CONTEXT)
@click.argument("topic_name")
@click.option(
    "-w", "--window", type=click.IntRange(min=1), default=WINDOW, show_default=True, help="Messages to average over."
)
@discovery_options
def bw(topic_name: str, window: int, spin_time: float | None, use_sim_time: bool) -> None:
    """How many bytes per second a topic carries; Ctrl-C ends it.

    \b
      ros2 topic bw /joint_commands
      Subscribed to [/joint_commands]
      3.04 KB/s from 10 messages
              Message size mean: 0.30 KB min: 0.30 KB max: 0.30 KB
    """
    with open_graph(spin_time=spin_time, use_sim_time=use_sim_time) as graph:
        from rclpy.qos import qos_profile_sensor_data

        from spinbook.ros2.graph import absolute
        from spinbook.ros2.topic.selection import wait_for_type

        name = absolute(topic_name)
        message = wait_for_type(graph, name)
        bandwidth = Bandwidth(window)

        def now() -> float:
            seconds: float = graph.node.get_clock().now().nanoseconds * 1e-9
            return seconds if use_sim_time else time.monotonic()

        def arrived(data: bytes) -> None:
            bandwidth.arrived(now(), len(data))

        def tell() -> None:
            report = bandwidth.report(now())
            if report is not None:
                print(report, flush=True)

        graph.node.create_subscription(message, name, arrived, qos_profile_sensor_data, raw=True)
        print(f"Subscribed to [{name}]", flush=True)
        graph.node.create_timer(1, tell)
        while True:
            graph.spin_once()
