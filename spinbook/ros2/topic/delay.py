"""`ros2 topic delay`."""

from __future__ import annotations

from typing import Any

import click

from spinbook.ros2.cli import CONTEXT, CommandError, discovery_options
from spinbook.ros2.opening import open_graph
from spinbook.ros2.topic.statistics import Delay

WINDOW = 10000


@click.command(context_settings=CONTEXT)
@click.argument("topic_name")
@click.option(
    "-w", "--window", type=click.IntRange(min=1), default=WINDOW, show_default=True, help="Messages to average over."
)
@discovery_options
def delay(topic_name: str, window: int, spin_time: float | None, use_sim_time: bool) -> None:
    """How old messages are on arrival: the clock here less `header.stamp`; Ctrl-C ends it.

    \b
      ros2 topic delay /joint_commands
      average delay: 0.001
              min: 0.000s max: 0.002s std dev: 0.00021s window: 10
    """
    with open_graph(spin_time=spin_time, use_sim_time=use_sim_time) as graph:
        from rclpy.qos import qos_profile_sensor_data
        from rclpy.time import Time

        from spinbook.ros2.graph import absolute
        from spinbook.ros2.message_fields import field_names, type_name
        from spinbook.ros2.topic.selection import wait_for_type

        name = absolute(topic_name)
        message = wait_for_type(graph, name)
        if "header" not in message.get_fields_and_field_types():
            raise CommandError(
                "msg does not have header",
                f"Fields of {type_name(message)}: {field_names(message)}. The delay is taken from header.stamp.",
            )
        delays = Delay(window)
        clock = graph.node.get_clock()

        def arrived(data: Any) -> None:
            delays.arrived(clock.now().nanoseconds, Time.from_msg(data.header.stamp).nanoseconds)

        def tell() -> None:
            report = delays.report()
            if report is not None:
                print(report, flush=True)

        graph.node.create_subscription(message, name, arrived, qos_profile_sensor_data)
        graph.node.create_timer(1, tell)
        while True:
            graph.spin_once()
