"""`ros2 topic hz`."""

from __future__ import annotations

from typing import Any

import click

from spinbook.ros2.cli import CONTEXT, discovery_options
from spinbook.ros2.opening import open_graph
from spinbook.ros2.topic.selection import Filter, filter_option
from spinbook.ros2.topic.statistics import Rate

WINDOW = 10000


@click.command(context_settings=CONTEXT)
@click.argument("topic_name")
@click.option(
    "-w", "--window", type=click.IntRange(min=1), default=WINDOW, show_default=True, help="Messages to average over."
)
@click.option("--wall-time", is_flag=True, help="Measure in wall time, even with --use-sim-time.")
@filter_option
@discovery_options
def hz(
    topic_name: str,
    window: int,
    wall_time: bool,
    filter_expression: Filter | None,
    spin_time: float | None,
    use_sim_time: bool,
) -> None:
    """How many messages per second arrive; Ctrl-C ends it.

    \b
      ros2 topic hz /joint_commands
      average rate: 10.001
              min: 0.099s max: 0.101s std dev: 0.00031s window: 11

    It is the rate of arrival here, which a busy machine or a best-effort QoS makes less than what is published.
    """
    with open_graph(spin_time=spin_time, use_sim_time=use_sim_time) as graph:
        from rclpy.clock import Clock, ClockType
        from rclpy.qos import qos_profile_sensor_data

        from spinbook.ros2.graph import absolute
        from spinbook.ros2.topic.selection import wait_for_type

        name = absolute(topic_name)
        message = wait_for_type(graph, name)
        rate = Rate(window)
        clock = Clock(clock_type=ClockType.SYSTEM_TIME) if wall_time else graph.node.get_clock()

        def arrived(data: Any) -> None:
            if filter_expression is not None and not filter_expression(data):
                return
            now = clock.now().nanoseconds
            if now:
                rate.arrived(now)
            elif rate.reset():
                print("time has reset, resetting counters", flush=True)

        # Messages are only opened for a filter.
        graph.node.create_subscription(message, name, arrived, qos_profile_sensor_data, raw=filter_expression is None)
        while True:
            graph.spin_once()
            report = rate.report()
            if report is not None:
                print(report, flush=True)
