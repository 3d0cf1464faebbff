"""A robot with a bit of everything, for the command lines of commands.txt."""

from __future__ import annotations

import contextlib
import math
from typing import Any

import rclpy
from example_interfaces.action import Fibonacci
from example_interfaces.srv import AddTwoInts
from geometry_msgs.msg import Twist
from nav_msgs.msg import Odometry
from rcl_interfaces.msg import ParameterDescriptor, SetParametersResult
from rclpy.action import ActionServer
from rclpy.executors import ExternalShutdownException, MultiThreadedExecutor
from rclpy.lifecycle import LifecycleNode
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile, qos_profile_sensor_data
from sensor_msgs.msg import Image, JointState, LaserScan
from std_msgs.msg import Float64, Float64MultiArray, Int32, String
from std_srvs.srv import SetBool, Trigger

LATCHED = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)


class Zoo(Node):
    """`/robot/zoo`: topics, services, an action and parameters."""

    def __init__(self) -> None:
        super().__init__("zoo", namespace="/robot")
        self._count = 0
        sensor = qos_profile_sensor_data
        self._chatter = self.create_publisher(String, "chatter", 10)
        self._scan = self.create_publisher(LaserScan, "scan", sensor)
        self._states = self.create_publisher(JointState, "joint_states", 10)
        self._odometry = self.create_publisher(Odometry, "odom", 10)
        self._image = self.create_publisher(Image, "image", sensor)
        self._nan = self.create_publisher(Float64, "nan", 10)
        self._unicode = self.create_publisher(String, "unicode", 10)
        self._array = self.create_publisher(Float64MultiArray, "array", 10)
        self._hidden = self.create_publisher(Int32, "_hidden_topic", 10)
        self.create_publisher(String, "quiet", 10)
        self.create_publisher(String, "robot_description", LATCHED).publish(String(data="<robot name='zoo'/>"))
        self.create_subscription(Twist, "cmd_vel", lambda message: None, 10)
        self.create_subscription(String, "/heard", lambda message: None, 10)
        self.create_service(AddTwoInts, "add_two_ints", self._add)
        self.create_service(SetBool, "set_bool", lambda request, response: response)
        self.create_service(Trigger, "/trigger", lambda request, response: response)
        ActionServer(self, Fibonacci, "fibonacci", self._fibonacci)
        self.create_timer(0.1, self._tick)
        self._declare()

    def _declare(self) -> None:
        for name, value in {"name": "zoo", "gain": 1.5, "count": 3, "flag": True, "list_d": [1.0, 2.0]}.items():
            self.declare_parameter(name, value)
        self.declare_parameter("fixed", 7, ParameterDescriptor(read_only=True, description="never changes"))
        self.declare_parameter("dyn", 1, ParameterDescriptor(dynamic_typing=True))
        self.declare_parameter("arm.left.kp", 1.0)
        self.declare_parameter("arm.right.kp", 2.0)
        self.add_on_set_parameters_callback(self._checked)

    def _checked(self, parameters: Any) -> SetParametersResult:
        too_much = any(parameter.name == "gain" and parameter.value > 10 for parameter in parameters)
        return SetParametersResult(successful=not too_much, reason="gain is at most 10" if too_much else "")

    def _add(self, request: Any, response: Any) -> Any:
        response.sum = request.a + request.b
        return response

    def _fibonacci(self, goal: Any) -> Fibonacci.Result:
        numbers = [0, 1]
        for _ in range(1, goal.request.order):
            numbers.append((numbers[-1] + numbers[-2]) % 2**31)
            goal.publish_feedback(Fibonacci.Feedback(sequence=numbers))
        goal.succeed()
        return Fibonacci.Result(sequence=numbers)

    def _tick(self) -> None:
        self._count += 1
        stamp = self.get_clock().now().to_msg()
        self._chatter.publish(String(data="hello"))
        scan = LaserScan(ranges=[1.0, 2.0, math.inf, 4.0])
        scan.header.stamp, scan.header.frame_id = stamp, "laser"
        self._scan.publish(scan)
        self._states.publish(JointState(name=["a", "b"], position=[0.5, -0.5]))
        self._odometry.publish(Odometry(child_frame_id="base"))
        self._image.publish(Image(height=2, width=2, encoding="mono8", step=2, data=[1, 2, 3, 4]))
        self._nan.publish(Float64(data=math.nan))
        self._unicode.publish(String(data="Zoë, „ja“"))
        self._array.publish(Float64MultiArray(data=[float(number) for number in range(200)]))
        self._hidden.publish(Int32(data=1))


def main() -> None:
    """Run it, until Ctrl-C."""
    rclpy.init()
    executor = MultiThreadedExecutor(4)
    for node in (Zoo(), Node("plain"), LifecycleNode("life")):
        executor.add_node(node)
    print("ready", flush=True)
    with contextlib.suppress(KeyboardInterrupt, ExternalShutdownException):
        executor.spin()


if __name__ == "__main__":
    main()
