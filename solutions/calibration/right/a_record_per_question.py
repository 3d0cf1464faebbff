"""With a small record for each question, and the answers found by polling their futures."""

import math
from dataclasses import dataclass

import rclpy
from humanoid_control_interfaces.srv import CalibrateJoint
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from rclpy.task import Future
from sensor_msgs.msg import JointState
from std_msgs.msg import Int32, String


@dataclass
class Question:
    joint: str
    future: Future = None
    since: int = 0


class Calibration(Node):
    def __init__(self):
        super().__init__('calibration')
        self.questions = []
        self.offsets = self.create_publisher(JointState, '/joint_offsets', 10)
        self.pending = self.create_publisher(Int32, '/calibrations_pending', 10)
        self.client = self.create_client(CalibrateJoint, '/calibrate_joint')
        self.create_subscription(String, '/calibrate', self.on_joint, 10)
        self.create_timer(0.1, self.on_timer)

    def on_joint(self, message):
        self.questions.append(Question(message.data))
        self.ask()

    def on_timer(self):
        self.ask()
        now = self.get_clock().now().nanoseconds
        self.questions = [q for q in self.questions if q.future is None or now - q.since < 5_000_000_000]
        self.pending.publish(Int32(data=len(self.questions)))

    def ask(self):
        if not self.client.service_is_ready():
            return
        for question in self.questions:
            if question.future is None:
                question.since = self.get_clock().now().nanoseconds
                question.future = self.client.call_async(CalibrateJoint.Request(joint=question.joint))
                question.future.add_done_callback(self.on_answer)

    def on_answer(self, future):
        for question in [q for q in self.questions if q.future is future]:
            self.questions.remove(question)
            answer = future.result()
            if answer.success and math.isfinite(answer.offset):
                self.offsets.publish(JointState(name=[question.joint], position=[answer.offset]))


def main():
    rclpy.init()
    node = Calibration()
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == '__main__':
    main()
