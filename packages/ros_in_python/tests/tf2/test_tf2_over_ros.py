"""Broadcasters, listeners and buffers in real nodes."""

from __future__ import annotations

import threading
from collections.abc import Iterator

import pytest
import rclpy
from geometry_msgs.msg import TransformStamped
from rclpy.duration import Duration
from rclpy.executors import MultiThreadedExecutor, SingleThreadedExecutor
from rclpy.node import Node
from rclpy.time import Time
from test_frames import place_of, stamped
from tf2_ros import Buffer, StaticTransformBroadcaster, TransformBroadcaster, TransformException, TransformListener

#: Longer than anything here takes on a busy machine (s).
DEADLINE_S = 60.0


@pytest.fixture
def node(ros_domain: int) -> Iterator[Node]:
    rclpy.init()
    made = Node("frames")
    yield made
    made.destroy_node()
    rclpy.shutdown()


def spin_until(node: Node, buffer: Buffer, target: str, source: str) -> None:
    future = buffer.wait_for_transform_async(target, source, Time())
    rclpy.spin_until_future_complete(node, future, timeout_sec=DEADLINE_S)
    assert future.done()


def test_what_is_broadcast_can_be_looked_up(node: Node) -> None:
    buffer = Buffer()
    listener = TransformListener(buffer, node)
    broadcaster = TransformBroadcaster(node)
    node.create_timer(
        0.05, lambda: broadcaster.sendTransform([stamped("w", "a", place=(1.0, 0.0, 0.0)), stamped("a", "b")])
    )
    spin_until(node, buffer, "w", "b")
    assert place_of(buffer.lookup_transform("w", "b", Time())) == (1.0, 0.0, 0.0)
    listener.unregister()


def test_static_transforms_reach_a_listener_that_comes_later_with_all_that_were_sent(node: Node) -> None:
    broadcaster = StaticTransformBroadcaster(node)
    broadcaster.sendTransform(stamped("w", "camera", place=(9.0, 0.0, 0.0)))
    broadcaster.sendTransform(stamped("w", "lidar"))
    broadcaster.sendTransform(stamped("w", "camera", place=(0.0, 0.0, 1.0)))
    buffer = Buffer()
    listener = TransformListener(buffer, node)
    spin_until(node, buffer, "lidar", "camera")
    assert place_of(buffer.lookup_transform("w", "camera", Time())) == (0.0, 0.0, 1.0)
    listener.unregister()


def test_a_callback_may_wait_for_a_transform_where_another_thread_spins(node: Node) -> None:
    buffer = Buffer(node=node)
    listener = TransformListener(buffer, node)
    asked = threading.Event()
    answer: list[TransformStamped] = []

    def ask() -> None:
        timer.cancel()
        asked.set()
        answer.append(buffer.lookup_transform("w", "a", Time(), timeout=Duration(seconds=DEADLINE_S)))

    timer = node.create_timer(0.01, ask)
    broadcaster = TransformBroadcaster(node)
    other = Node("other")
    other.create_timer(0.05, lambda: broadcaster.sendTransform(stamped("w", "a")) if asked.is_set() else None)
    executor = MultiThreadedExecutor(num_threads=3)
    executor.add_node(node)
    executor.add_node(other)
    while not answer:
        executor.spin_once(timeout_sec=0.1)
    assert answer[0].child_frame_id == "a"
    executor.shutdown()
    other.destroy_node()
    listener.unregister()


def test_waiting_in_vain_ends_after_the_time_limit(node: Node) -> None:
    buffer = Buffer(node=node)
    with pytest.raises(TransformException, match="none yet"):
        buffer.lookup_transform("w", "a", Time(), timeout=Duration(seconds=0.1))


def test_a_listener_with_a_thread_of_its_own_needs_no_spinning(node: Node) -> None:
    StaticTransformBroadcaster(node).sendTransform(stamped("w", "a"))
    buffer = Buffer()
    listener = TransformListener(buffer, node, spin_thread=True)
    assert buffer.can_transform("w", "a", Time(), timeout=Duration(seconds=DEADLINE_S))
    listener.unregister()


def test_a_coroutine_waits_for_a_transform(node: Node) -> None:
    buffer = Buffer()
    answers = []

    async def look() -> None:
        answers.append(await buffer.lookup_transform_async("w", "a", Time()))

    executor = SingleThreadedExecutor()
    executor.add_node(node)
    task = executor.create_task(look)
    executor.spin_once(timeout_sec=0)
    buffer.set_transform(stamped("w", "a"), "test")
    executor.spin_until_future_complete(task, timeout_sec=DEADLINE_S)
    assert answers[0].child_frame_id == "a"
    executor.shutdown()


def test_a_buffer_with_a_node_tells_all_frames_by_a_service(node: Node) -> None:
    from tf2_msgs.srv import FrameGraph

    buffer = Buffer(node=node)
    buffer.set_transform(stamped("w", "a", 2.0), "somebody")
    client = node.create_client(FrameGraph, "tf2_frames")
    future = client.call_async(FrameGraph.Request())
    rclpy.spin_until_future_complete(node, future, timeout_sec=DEADLINE_S)
    text = future.result().frame_yaml
    assert "parent: 'w'" in text
    assert "broadcaster: 'somebody'" in text
