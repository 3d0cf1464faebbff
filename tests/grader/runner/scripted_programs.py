"""Programs of every kind, as students write them, and the exercise that declares their interface."""

from __future__ import annotations

from pathlib import Path

from grader.exercise import Exercise
from grader.exercise.exercise import ServiceOrAction, Topic
from grader.scenario import Scenario
from grader.scenario.resolver import resolved

FLOAT, STRING = "std_msgs/msg/Float64", "std_msgs/msg/String"
SET_BOOL, FIBONACCI = "std_srvs/srv/SetBool", "test_msgs/action/Fibonacci"

EXERCISE = Exercise(
    name="any_kind",
    folder=Path("/nowhere/exercises/any_kind"),
    title="Any kind",
    points=10.0,
    file_name="node.py",
    class_name="",
    node_name="student",
    task="",
    topics=(
        Topic("/in", FLOAT, "subscribe"),
        Topic("/out", FLOAT, "publish"),
        Topic("/text", STRING, "publish"),
        Topic("/turtle1/cmd_vel", "geometry_msgs/msg/Twist", "publish"),
    ),
    solution_folder=None,
    endpoints=(
        ServiceOrAction("/switch", SET_BOOL, "service"),
        ServiceOrAction("/lamp", SET_BOOL, "client"),
        ServiceOrAction("/count", FIBONACCI, "action"),
        ServiceOrAction("/climb", FIBONACCI, "action_client"),
    ),
)


def ready(scenario: Scenario, exercise: Exercise = EXERCISE) -> Scenario:
    """Return the scenario as `declared` gives it."""
    return resolved(exercise, scenario)


_HEAD = """
import math
import threading

import rclpy
from action_msgs.msg import GoalStatus
from geometry_msgs.msg import Twist
from rcl_interfaces.msg import SetParametersResult
from rclpy.action import ActionClient, ActionServer, CancelResponse, GoalResponse
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.executors import ExternalShutdownException, MultiThreadedExecutor, SingleThreadedExecutor
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile
from std_msgs.msg import Float64, String
from std_srvs.srv import SetBool
from test_msgs.action import Fibonacci
from turtlesim.msg import Pose


class Student(Node):
    def __init__(self):
        super().__init__('student')
"""

_TAIL = """

def main():
    rclpy.init()
    executor = {executor}
    executor.add_node(Student())
    try:
        executor.spin()
    except (KeyboardInterrupt, ExternalShutdownException):
        rclpy.try_shutdown()


if __name__ == '__main__':
    main()
"""


def program(body: str, threads: int = 1) -> str:
    """Return a whole program around the body of a class's constructor and its methods, indented by four spaces."""
    executor = "SingleThreadedExecutor()" if threads == 1 else f"MultiThreadedExecutor({threads})"
    return _HEAD + body + _TAIL.format(executor=executor)


PUBLISHER = """
        self.out = self.create_publisher(Float64, '/out', 10)
        self.count = 0
        self.create_timer(0.1, self.tick)

    def tick(self):
        self.count += 1
        self.out.publish(Float64(data=float(self.count)))
"""

FILTER_WITH_GAIN = """
        self.declare_parameter('gain', 1.0)
        self.add_on_set_parameters_callback(self.checked)
        self.out = self.create_publisher(Float64, 'out', 10)
        self.create_subscription(Float64, 'in', self.heard, 10)

    def checked(self, parameters):
        good = all(one.value > 0 for one in parameters if one.name == 'gain')
        return SetParametersResult(successful=good, reason='' if good else 'gain must be positive')

    def heard(self, message):
        self.out.publish(Float64(data=self.get_parameter('gain').value * message.data))
"""

LATCHED_PUBLISHER = """
        qos = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
        self.text = self.create_publisher(String, '/text', qos)
        self.text.publish(String(data='the map'))
"""

LATCHED_SUBSCRIBER = """
        qos = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
        self.out = self.create_publisher(Float64, '/out', 10)
        self.create_subscription(Float64, '/in', self.out.publish, qos)
"""

SERVICE_SERVER = """
        self.on = False
        self.create_service(SetBool, '/switch', self.switch)

    def switch(self, request, response):
        response.success = request.data != self.on
        response.message = f'{self.on} to {request.data}'
        self.on = request.data
        return response
"""

SERVICE_CLIENT = """
        self.out = self.create_publisher(Float64, '/out', 10)
        self.client = self.create_client(SetBool, '/lamp')
        self.create_timer(0.5, self.ask)
        self.create_timer(0.1, lambda: self.out.publish(Float64(data=-1.0)))

    def ask(self):
        if self.client.service_is_ready():
            self.client.call_async(SetBool.Request(data=True)).add_done_callback(self.done)

    def done(self, future):
        self.out.publish(Float64(data=float(future.result().success)))
"""

BLOCKING_CLIENT = SERVICE_CLIENT.replace(
    "self.client.call_async(SetBool.Request(data=True)).add_done_callback(self.done)",
    "self.client.call(SetBool.Request(data=True))",
)

ACTION_SERVER = """
        group = ReentrantCallbackGroup()
        self.server = ActionServer(self, Fibonacci, '/count', self.execute, callback_group=group,
                                   goal_callback=self.wanted, cancel_callback=lambda goal: CancelResponse.ACCEPT)

    def wanted(self, request):
        return GoalResponse.ACCEPT if request.order > 0 else GoalResponse.REJECT

    def execute(self, goal):
        rate = self.create_rate(2.0)
        feedback = Fibonacci.Feedback()
        for number in range(goal.request.order):
            if goal.is_cancel_requested:
                goal.canceled()
                return Fibonacci.Result(sequence=feedback.sequence)
            feedback.sequence = [*feedback.sequence, number]
            goal.publish_feedback(feedback)
            rate.sleep()
        goal.succeed()
        return Fibonacci.Result(sequence=feedback.sequence)
"""

ACTION_CLIENT = """
        self.text = self.create_publisher(String, '/text', 10)
        self.client = ActionClient(self, Fibonacci, '/climb')
        self.create_timer(0.5, self.start)
        self.goal = None
        self.begun = False

    def say(self, text):
        self.text.publish(String(data=text))

    def start(self):
        if not self.begun and self.client.server_is_ready():
            self.begun = True
            sent = self.client.send_goal_async(Fibonacci.Goal(order=3), self.fed)
            sent.add_done_callback(self.answered)

    def fed(self, message):
        self.say(f'feedback {list(message.feedback.sequence)}')
        if len(message.feedback.sequence) == 2:
            self.goal.cancel_goal_async()

    def answered(self, future):
        self.goal = future.result()
        self.say(f'accepted {self.goal.accepted}')
        if self.goal.accepted:
            self.goal.get_result_async().add_done_callback(self.ended)

    def ended(self, future):
        self.say(f'status {future.result().status} {list(future.result().result.sequence)}')
"""

GO_TO_GOAL = """
        self.drive = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)
        self.create_subscription(Pose, '/turtle1/pose', self.moved, 10)

    def moved(self, pose):
        away = math.hypot(9.0 - pose.x, 8.0 - pose.y)
        turn = math.remainder(math.atan2(8.0 - pose.y, 9.0 - pose.x) - pose.theta, 2 * math.pi)
        command = Twist()
        if away > 0.05:
            command.linear.x = min(2.0, away) * max(0.0, math.cos(turn))
            command.angular.z = 4.0 * turn
        self.drive.publish(command)
"""
