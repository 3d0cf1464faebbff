"""Counts ticks of its timer to know how long a question has waited."""

import math
from functools import partial

import rclpy
from humanoid_control_interfaces.srv import CalibrateJoint
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from sensor_msgs.msg import JointState
from std_msgs.msg import Int32, String


class Calibration(Node):
    def __init__(self):
        super().__init__('calibration')
        self.later = []
        self.waits = {}  # number of the question -> ticks
        self.numbers = 0
        self.publish_offset = self.create_publisher(JointState, 'joint_offsets', 10).publish
        self.publish_count = self.create_publisher(Int32, 'calibrations_pending', 10).publish
        self.client = self.create_client(CalibrateJoint, 'calibrate_joint')
        self.create_subscription(String, 'calibrate', self.on_joint, 10)
        self.create_timer(1 / 10, self.tick)

    def on_joint(self, message):
        if self.client.service_is_ready():
            self.ask(message.data)
        else:
            self.later.append(message.data)

    def ask(self, joint):
        self.numbers += 1
        self.waits[self.numbers] = 0
        request = CalibrateJoint.Request()
        request.joint = joint
        self.client.call_async(request).add_done_callback(partial(self.on_answer, joint, self.numbers))

    def on_answer(self, joint, number, future):
        if number not in self.waits:
            return
        self.waits.pop(number)
        answer = future.result()
        if not answer.success or math.isnan(answer.offset) or math.isinf(answer.offset):
            self.get_logger().error(answer.message)
            return
        message = JointState()
        message.header.stamp = self.get_clock().now().to_msg()
        message.name.append(joint)
        message.position.append(answer.offset)
        self.publish_offset(message)

    def tick(self):
        for number in list(self.waits):
            self.waits[number] += 1
            if self.waits[number] > 50:
                del self.waits[number]
        if self.client.service_is_ready():
            for joint in self.later:
                self.ask(joint)
            self.later.clear()
        self.publish_count(Int32(data=len(self.later) + len(self.waits)))


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
