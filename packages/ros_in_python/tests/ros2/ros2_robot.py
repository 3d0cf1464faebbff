"""Nodes for the tests to look at. Started with the names of the parts wanted; prints `ready` when they are there."""

from __future__ import annotations

import contextlib
import sys
import time
from typing import Any

import rclpy
from action_msgs.msg import GoalStatus
from rcl_interfaces.msg import FloatingPointRange, ParameterDescriptor
from rclpy.action import ActionServer, CancelResponse
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.executors import ExternalShutdownException, MultiThreadedExecutor
from rclpy.lifecycle import LifecycleNode, TransitionCallbackReturn
from rclpy.node import Node
from rclpy.qos import (
    DurabilityPolicy,
    QoSProfile,
    ReliabilityPolicy,
    qos_profile_action_status_default,
    qos_profile_system_default,
)
from rclpy.service_introspection import ServiceIntrospectionState
from rclpy.utilities import remove_ros_args
from sensor_msgs.msg import JointState
from std_msgs.msg import Int32, String
from std_srvs.srv import SetBool
from test_msgs.action import Fibonacci


def publisher() -> Node:
    """Run `/joint_commands` at 20 Hz, and parameters."""
    node = Node("joint_publisher")
    limits = ParameterDescriptor(
        description="messages a second", floating_point_range=[FloatingPointRange(from_value=-100.0, to_value=100.0)]
    )
    node.declare_parameter("rate", 50.0, limits)
    node.declare_parameter("gains.left", [0.5, 0.25])
    topic = node.create_publisher(JointState, "/joint_commands", 10)

    def publish() -> None:
        message = JointState(name=["a", "b"], position=[0.25, 0.5], velocity=[0.0, 0.0])
        message.header.stamp = node.get_clock().now().to_msg()
        topic.publish(message)

    node.create_timer(0.05, publish)
    return node


def latched() -> Node:
    """Publish one message on `/robot_name`, before anything subscribes: transient local."""
    node = Node("namer")
    qos = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL, reliability=ReliabilityPolicy.RELIABLE)
    node.create_publisher(String, "/robot_name", qos).publish(String(data="Ada"))
    return node


def counter() -> Node:
    """Run `/count` best effort, `/_hidden`, and a subscription to `/cmd`."""
    node = Node("counter")
    topic = node.create_publisher(Int32, "/count", QoSProfile(depth=10, reliability=ReliabilityPolicy.BEST_EFFORT))
    hidden = node.create_publisher(Int32, "/_hidden", 10)
    count = 0

    def obey(message: Any) -> None:
        print(message.data, flush=True)

    def publish() -> None:
        nonlocal count
        count += 1
        topic.publish(Int32(data=count))
        hidden.publish(Int32(data=count))

    node.create_subscription(String, "/cmd", obey, 10)
    node.create_timer(0.05, publish)
    return node


def service() -> Node:
    """Run `/stand_up`."""
    node = Node("stander")

    def stand_up(request: Any, response: Any) -> Any:
        response.success, response.message = request.data, "up" if request.data else "down"
        return response

    node.create_service(SetBool, "/stand_up", stand_up)
    return node


def introspected() -> Node:
    """Run `/lie_down`, which publishes its calls, and call it twenty times a second."""
    node = Node("watched")
    server = node.create_service(SetBool, "/lie_down", lambda request, response: response)
    server.configure_introspection(node.get_clock(), qos_profile_system_default, ServiceIntrospectionState.CONTENTS)
    client = node.create_client(SetBool, "/lie_down")
    node.create_timer(0.05, lambda: client.call_async(SetBool.Request(data=True)))
    return node


def lifecycle() -> Node:
    """Run `/camera`, whose activation fails."""

    class Camera(LifecycleNode):
        def on_configure(self, state: Any) -> TransitionCallbackReturn:
            return TransitionCallbackReturn.SUCCESS

        def on_activate(self, state: Any) -> TransitionCallbackReturn:
            return TransitionCallbackReturn.FAILURE

    return Camera("camera")


def action() -> Node:
    """Run `/fibonacci`, one number every 50 ms."""
    node = Node("fibonacci_server")

    def execute(goal: Any) -> Any:
        numbers = [0, 1]
        for _ in range(1, goal.request.order):
            if goal.is_cancel_requested:
                goal.canceled()
                return Fibonacci.Result()
            numbers.append(numbers[-1] + numbers[-2] if len(numbers) < 30 else 0)
            goal.publish_feedback(Fibonacci.Feedback(sequence=numbers))
            time.sleep(0.05)
        goal.succeed()
        return Fibonacci.Result(sequence=numbers)

    ActionServer(
        node,
        Fibonacci,
        "fibonacci",
        execute,
        cancel_callback=lambda goal: CancelResponse.ACCEPT,
        callback_group=ReentrantCallbackGroup(),
    )
    return node


def hasty_action() -> Node:
    """Run `/fibonacci` from an action's bare services and topics: it sends feedback before it accepts the goal, and
    much at once with the result."""
    node = Node("fibonacci_server")
    services, prefix = Fibonacci.Impl, "/fibonacci/_action"
    feedback = node.create_publisher(services.FeedbackMessage, f"{prefix}/feedback", 10)
    node.create_publisher(services.GoalStatusMessage, f"{prefix}/status", qos_profile_action_status_default)

    def tell(goal_id: Any, number: int) -> None:
        feedback.publish(services.FeedbackMessage(goal_id=goal_id, feedback=Fibonacci.Feedback(sequence=[number])))

    def accept(request: Any, response: Any) -> Any:
        tell(request.goal_id, 1)
        time.sleep(0.3)  # the client handles this before it knows that the goal was accepted
        response.accepted = True
        return response

    def finish(request: Any, response: Any) -> Any:
        for number in (2, 3, 4, 5):
            tell(request.goal_id, number)
        response.status, response.result.sequence = GoalStatus.STATUS_SUCCEEDED, [5]
        return response

    node.create_service(services.SendGoalService, f"{prefix}/send_goal", accept)
    node.create_service(services.GetResultService, f"{prefix}/get_result", finish)
    node.create_service(services.CancelGoalService, f"{prefix}/cancel_goal", lambda request, response: response)
    return node


def main() -> None:
    rclpy.init()
    executor = MultiThreadedExecutor(2)
    nodes = [globals()[part]() for part in remove_ros_args(sys.argv)[1:]]
    for node in nodes:
        executor.add_node(node)
    print("ready", flush=True)
    with contextlib.suppress(KeyboardInterrupt, ExternalShutdownException):
        executor.spin()


main()
