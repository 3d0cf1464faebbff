"""`ros2 topic hz`, `bw` and `delay`: the formulas, and the commands on a real topic."""

from __future__ import annotations

import re

import pytest
from ros2_terminal import Robot, Terminal

from ros_in_python.ros2.topic.measuring import Bandwidth, Delay, Rate

MS = 1_000_000


def test_the_rate_is_of_the_window_with_the_population_deviation() -> None:
    rate = Rate(4)
    reports = []
    time = 0
    for interval in (100, 100, 500, 100, 300, 300, 300, 100):
        time += interval * MS
        rate.arrived(time)
        reports.append(rate.report())
    # The first interval begins the awaited second; 100, 500, 100, 300 ms are the window at its end.
    printed = [report for report in reports if report]
    assert printed == ["average rate: 3.333\n\tmin: 0.100s max: 0.500s std dev: 0.14142s window: 4"]


def test_no_rate_is_reported_more_than_once_a_second() -> None:
    rate = Rate(10000)
    printed = 0
    for number in range(1, 401):
        rate.arrived(number * 10 * MS)
        printed += rate.report() is not None
    assert printed == 3


def test_a_clock_that_goes_back_begins_anew() -> None:
    rate = Rate(10)
    for time in (100, 200, 50, 60):
        rate.arrived(time * MS)
    assert rate.reset()
    assert rate.report() is None


def test_the_delay_is_the_clock_less_the_stamp() -> None:
    delay = Delay(100)
    delay.arrived(1000 * MS, 900 * MS)
    assert delay.report() is None
    delay.arrived(2000 * MS, 1998 * MS)
    delay.arrived(3000 * MS, 2996 * MS)
    assert delay.report() == "average delay: 0.003\n\tmin: 0.002s max: 0.004s std dev: 0.00100s window: 2"
    assert delay.report() == "no new messages"


@pytest.mark.parametrize(
    ("size", "text"),
    [
        (10, "20 B/s from 4 messages\n\tMessage size mean: 10 B min: 10 B max: 10 B"),
        (1000, "2.00 KB/s from 4 messages\n\tMessage size mean: 1.00 KB min: 1.00 KB max: 1.00 KB"),
        (2_000_000, "4.00 MB/s from 4 messages\n\tMessage size mean: 2.00 MB min: 2.00 MB max: 2.00 MB"),
    ],
)
def test_bandwidth_is_reported_in_one_unit(size: int, text: str) -> None:
    bandwidth = Bandwidth(4)
    for time in range(10):
        bandwidth.arrived(float(time), size)
    assert bandwidth.report(8.0) == text


def test_bandwidth_needs_two_messages() -> None:
    bandwidth = Bandwidth(100)
    bandwidth.arrived(0.0, 5)
    assert bandwidth.report(1.0) is None


def test_hz(standing: Robot, terminal: Terminal) -> None:
    standing("publisher", "counter", "latched")
    hz = terminal.start("topic", "hz", "/joint_commands")
    average, spread = hz.lines(2)
    assert re.fullmatch(r"average rate: \d+\.\d{3}", average)
    assert re.fullmatch(r"\tmin: \d\.\d{3}s max: \d\.\d{3}s std dev: \d\.\d{5}s window: \d+", spread)
    answer = hz.stop()
    assert answer.err == ""


def test_hz_waits_for_a_topic_with_a_warning(robot: Robot, terminal: Terminal) -> None:
    hz = terminal.start("topic", "hz", "-w", "5", "/count")
    assert hz.lines(1) == ["WARNING: topic [/count] does not appear to be published yet"]
    robot("counter")
    assert hz.lines(2)[1].endswith("window: 5")


def test_bw(standing: Robot, terminal: Terminal) -> None:
    standing("publisher", "counter", "latched")
    bw = terminal.start("topic", "bw", "/joint_commands")
    subscribed, rate, sizes = bw.lines(3)
    assert subscribed == "Subscribed to [/joint_commands]"
    assert re.fullmatch(r"\d+\.\d\d KB/s from \d+ messages", rate)
    assert sizes == "\tMessage size mean: 0.09 KB min: 0.09 KB max: 0.09 KB"


def test_delay(standing: Robot, terminal: Terminal) -> None:
    standing("publisher", "counter", "latched")
    delay = terminal.start("topic", "delay", "/joint_commands")
    average, spread = delay.lines(2)
    assert re.fullmatch(r"average delay: \d+\.\d{3}", average)
    assert spread.startswith("\tmin: ")


def test_delay_needs_a_header(standing: Robot, terminal: Terminal) -> None:
    standing("publisher", "counter", "latched")
    answer = terminal.ros2("topic", "delay", "/count")
    assert (answer.code, answer.err.splitlines()[0]) == (1, "msg does not have header")
