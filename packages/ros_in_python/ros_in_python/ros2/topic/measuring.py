"""`ros2 topic hz`, `bw` and `delay`: how often, how much, how late."""

from __future__ import annotations

import time
from collections import deque
from collections.abc import Callable
from statistics import fmean, pstdev
from typing import TYPE_CHECKING, Any, NoReturn

import click

from ros_in_python.ros2.cli import CommandError, F
from ros_in_python.ros2.names import absolute
from ros_in_python.ros2.opening import with_graph
from ros_in_python.ros2.topic.selection import Filter, filter_option, wait_for_type

if TYPE_CHECKING:
    from ros_in_python.ros2.graph import GraphView


class _LastValues:
    """The values (ns) of the last `window` messages: none of the first, and none from before the clock went back."""

    def __init__(self, window: int) -> None:
        self._values: deque[int] = deque(maxlen=window)
        self._latest: int | None = None
        self._reported: int | None = None

    def _take(self, now: int, value: int) -> None:
        if self._latest is None or now < self._latest:
            self._values.clear()
        else:
            self._values.append(value)
        self._latest = now

    def _spread(self) -> str:
        """Return the line about the values; the standard deviation is divided by n, not by n - 1."""
        least, most, deviation = (1e-9 * of(self._values) for of in (min, max, pstdev))
        return f"min: {least:.3f}s max: {most:.3f}s std dev: {deviation:.5f}s window: {len(self._values)}"


class Rate(_LastValues):
    """The rate of arrivals over the last `window` intervals. Times are in ns."""

    def arrived(self, now: int) -> None:
        """Count a message that arrived at `now`; start over if the clock went back."""
        self._take(now, now - (self._latest or 0))

    def reset(self) -> bool:
        """Forget the intervals, as when a simulation starts over; return whether there were any."""
        had = bool(self._values)
        self._values.clear()
        return had

    def report(self) -> str | None:
        """Return the two lines to print, at most once per second of arrivals; None if none are due."""
        if not self._values or self._latest is None:
            return None
        if self._reported is None or self._latest < self._reported:
            self._reported = self._latest
        if self._latest < self._reported + 1_000_000_000:
            return None
        self._reported = self._latest
        mean = fmean(self._values)
        return f"average rate: {1e9 / mean if mean > 0 else 0:.3f}\n\t{self._spread()}"


class Delay(_LastValues):
    """The age of messages on arrival over the last `window`. Times are in ns."""

    def arrived(self, now: int, stamp: int) -> None:
        """Count a message with the header stamp `stamp` that arrived at `now`; like the real command, not the first."""
        self._take(now, now - stamp)

    def report(self) -> str | None:
        """Return the lines to print this second; None before the first message."""
        if not self._values:
            return None
        if self._latest == self._reported:
            return "no new messages"
        self._reported = self._latest
        return f"average delay: {fmean(self._values) * 1e-9:.3f}\n\t{self._spread()}"


class Bandwidth:
    """Bytes a second over the last `window` messages. Times are in s."""

    def __init__(self, window: int) -> None:
        self._sizes: deque[int] = deque(maxlen=window)
        self._times: deque[float] = deque(maxlen=window)

    def arrived(self, now: float, size: int) -> None:
        """Count a message of `size` bytes that arrived at `now`."""
        self._times.append(now)
        self._sizes.append(size)

    def report(self, now: float) -> str | None:
        """Return the two lines to print at `now`; None before there are two messages."""
        if len(self._times) < 2 or now <= self._times[0]:
            return None
        total, count = sum(self._sizes), len(self._sizes)
        rate = total / (now - self._times[0])
        unit = _unit(rate)
        mean, least, greatest = (unit(value) for value in (total / count, min(self._sizes), max(self._sizes)))
        return f"{unit(rate)}/s from {count} messages\n\tMessage size mean: {mean} min: {least} max: {greatest}"


def _unit(rate: float) -> Callable[[float], str]:
    """Return the unit for a rate in bytes per second; the whole report uses it."""
    if rate < 1000:
        return lambda size: f"{size:.0f} B"
    if rate < 1_000_000:
        return lambda size: f"{size / 1000:.2f} KB"
    return lambda size: f"{size / 1_000_000:.2f} MB"


#: How many messages are averaged over, and how many for the bandwidth.
WINDOW = 10000
BANDWIDTH_WINDOW = 100


def _window_option(messages: int) -> Callable[[F], F]:
    """Make the option `--window`, with this default number of messages."""
    return click.option(
        "-w",
        "--window",
        type=click.IntRange(min=1),
        default=messages,
        show_default=True,
        help="Messages to average over.",
    )


@click.command()
@click.argument("topic_name")
@_window_option(WINDOW)
@click.option("--wall-time", is_flag=True, help="Measure in wall time, even with --use-sim-time.")
@filter_option
@with_graph
def hz(graph: GraphView, topic_name: str, window: int, wall_time: bool, filter_expression: Filter | None) -> None:
    """How many messages per second arrive; Ctrl-C ends it.

    \b
      ros2 topic hz /joint_commands
      average rate: 10.001
              min: 0.099s max: 0.101s std dev: 0.00031s window: 11

    It is the rate of arrival here, which a busy machine or a best-effort QoS makes less than what is published.
    """
    from rclpy.clock import Clock, ClockType
    from rclpy.qos import qos_profile_sensor_data

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


@click.command()
@click.argument("topic_name")
@_window_option(BANDWIDTH_WINDOW)
@with_graph
def bw(graph: GraphView, topic_name: str, window: int) -> None:
    """How many bytes per second a topic carries; Ctrl-C ends it.

    \b
      ros2 topic bw /joint_commands
      Subscribed to [/joint_commands]
      3.04 KB/s from 10 messages
              Message size mean: 0.30 KB min: 0.30 KB max: 0.30 KB
    """
    from rclpy.qos import qos_profile_sensor_data

    name = absolute(topic_name)
    message = wait_for_type(graph, name)
    bandwidth = Bandwidth(window)
    simulated = graph.node.get_parameter("use_sim_time").value

    def now() -> float:
        seconds: float = graph.node.get_clock().now().nanoseconds * 1e-9
        return seconds if simulated else time.monotonic()

    def arrived(data: bytes) -> None:
        bandwidth.arrived(now(), len(data))

    graph.node.create_subscription(message, name, arrived, qos_profile_sensor_data, raw=True)
    print(f"Subscribed to [{name}]", flush=True)
    _report_each_second(graph, lambda: bandwidth.report(now()))


@click.command()
@click.argument("topic_name")
@_window_option(WINDOW)
@with_graph
def delay(graph: GraphView, topic_name: str, window: int) -> None:
    """How old messages are on arrival: the clock here less `header.stamp`; Ctrl-C ends it.

    \b
      ros2 topic delay /joint_commands
      average delay: 0.001
              min: 0.000s max: 0.002s std dev: 0.00021s window: 10
    """
    from rclpy.qos import qos_profile_sensor_data
    from rclpy.time import Time

    from ros_in_python.ros2.messages import field_names, type_name

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

    graph.node.create_subscription(message, name, arrived, qos_profile_sensor_data)
    _report_each_second(graph, delays.report)


def _report_each_second(graph: GraphView, report: Callable[[], str | None]) -> NoReturn:
    def print_report() -> None:
        if (lines := report()) is not None:
            print(lines, flush=True)

    graph.node.create_timer(1, print_report)
    while True:
        graph.spin_once()
