"""`ros2 topic hz`, `bw` and `delay`: how often, how much, how late."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any

import click

from spinbook.ros2.cli import CONTEXT, CommandError, F, discovery_options
from spinbook.ros2.opening import open_graph
from spinbook.ros2.topic.selection import Filter, filter_option
from spinbook.ros2.topic.statistics import Bandwidth, Delay, Rate

#: So many messages are averaged over, and so many for the bandwidth.
WINDOW = 10000
BANDWIDTH_WINDOW = 100


def _window_option(messages: int) -> Callable[[F], F]:
    """The option `--window`; by default so many messages."""
    return click.option(
        "-w",
        "--window",
        type=click.IntRange(min=1),
        default=messages,
        show_default=True,
        help="Messages to average over.",
    )


@click.command(context_settings=CONTEXT)
@click.argument("topic_name")
@_window_option(WINDOW)
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


@click.command(context_settings=CONTEXT)
@click.argument("topic_name")
@click.option(
    "-w",
    "--window",
    type=click.IntRange(min=1),
    default=BANDWIDTH_WINDOW,
    show_default=True,
    help="Messages to average over.",
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


@click.command(context_settings=CONTEXT)
@click.argument("topic_name")
@_window_option(WINDOW)
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
