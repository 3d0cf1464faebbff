"""Messages of several topics come together by their time stamps."""

from __future__ import annotations

from functools import partial
from typing import Any

import pytest
import rclpy
from message_filters import ApproximateTimeSynchronizer, Cache, SimpleFilter, Subscriber, TimeSynchronizer
from rclpy.node import Node
from rclpy.qos import QoSProfile
from rclpy.time import Time
from sensor_msgs.msg import Imu
from std_msgs.msg import Float64


def at(seconds: float) -> Imu:
    message = Imu()
    message.header.stamp = Time(nanoseconds=round(seconds * 1e9)).to_msg()
    return message


def seconds_of(message: Imu) -> float:
    return Time.from_msg(message.header.stamp).nanoseconds / 1e9


class Pairs:
    """Two filters in a synchronizer, and the times of the sets that came out."""

    def __init__(self, kind: type[TimeSynchronizer], *arguments: Any) -> None:
        self.left, self.right = SimpleFilter(), SimpleFilter()
        self.out: list[tuple[float, float]] = []
        kind([self.left, self.right], *arguments).registerCallback(
            lambda one, other: self.out.append((seconds_of(one), seconds_of(other)))
        )


def test_only_messages_of_exactly_one_time_come_together() -> None:
    pairs = Pairs(TimeSynchronizer, 10)
    for seconds in (1.0, 2.0, 3.0):
        pairs.left.signalMessage(at(seconds))
    pairs.right.signalMessage(at(2.0))
    pairs.right.signalMessage(at(2.5))
    pairs.right.signalMessage(at(1.0))
    assert pairs.out == [(2.0, 2.0), (1.0, 1.0)]


def test_of_each_topic_only_the_newest_stamps_are_kept() -> None:
    pairs = Pairs(TimeSynchronizer, 2)
    for seconds in (1.0, 2.0, 3.0):
        pairs.left.signalMessage(at(seconds))
    for seconds in (1.0, 2.0):
        pairs.right.signalMessage(at(seconds))
    assert pairs.out == [(2.0, 2.0)]


def test_nearly_the_same_time_is_enough_and_the_nearest_is_taken() -> None:
    pairs = Pairs(ApproximateTimeSynchronizer, 10, 0.1)
    for seconds in (1.0, 1.06, 2.0):
        pairs.left.signalMessage(at(seconds))
    pairs.right.signalMessage(at(1.05))
    pairs.right.signalMessage(at(1.5))
    pairs.right.signalMessage(at(2.1))
    assert pairs.out == [(1.06, 1.05), (2.0, 2.1)]


def test_without_a_header_the_time_of_arrival_counts_only_if_that_is_allowed() -> None:
    for allowed in (False, True):
        out: list[Any] = []
        source = SimpleFilter()
        ApproximateTimeSynchronizer([source], 5, 1.0, allow_headerless=allowed).registerCallback(out.append)
        if allowed:
            source.signalMessage(Float64(data=1.0))
            assert out == [Float64(data=1.0)]
        else:
            with pytest.raises(TypeError, match="Float64 has no header"):
                source.signalMessage(Float64())


def test_a_cache_answers_by_time() -> None:
    source = SimpleFilter()
    cache = Cache(source, 3)
    for seconds in (1.0, 3.0, 2.0, 4.0):
        source.signalMessage(at(seconds))

    def time(value: float) -> Time:
        return Time(nanoseconds=round(value * 1e9))

    assert [seconds_of(one) for one in cache.getInterval(time(2.0), time(3.5))] == [2.0, 3.0]
    assert seconds_of(cache.getElemAfterTime(time(2.5))) == 3.0
    assert seconds_of(cache.getElemBeforeTime(time(2.5))) == 2.0
    assert cache.getElemBeforeTime(time(1.5)) is None
    assert (cache.getOldestTime(), cache.getLastestTime()) == (time(2.0), time(4.0))
    assert seconds_of(cache.getLast()) == 4.0


def test_topics_of_real_nodes_come_together(ros_domain: int) -> None:
    rclpy.init()
    out: list[float] = []
    node = Node("both")
    subscribers = [Subscriber(node, Imu, "left"), Subscriber(node, Imu, "right", qos_profile=QoSProfile(depth=5))]
    TimeSynchronizer(subscribers, 10).registerCallback(lambda one, other: out.append(seconds_of(one)))
    left, right = node.create_publisher(Imu, "left", 10), node.create_publisher(Imu, "right", 10)
    for publisher in (left, right):
        node.create_timer(0.02, partial(publisher.publish, at(1.0)))
    while not out:
        rclpy.spin_once(node)
    assert out[0] == 1.0
    node.destroy_node()
    rclpy.shutdown()
