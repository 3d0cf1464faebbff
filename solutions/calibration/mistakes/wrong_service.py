"""Calls a service with another name.

Caught by:
- test_asks
"""

import math

import rclpy
from humanoid_control_interfaces.srv import CalibrateJoint
from rclpy.duration import Duration
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from sensor_msgs.msg import JointState
from std_msgs.msg import Int32, String

LONGEST_WAIT = Duration(seconds=5.0)


class Calibration(Node):

    def __init__(self):
        super().__init__('calibration')
        self.offsets = self.create_publisher(JointState, '/joint_offsets', 10)
        self.pending = self.create_publisher(Int32, '/calibrations_pending', 10)
        self.client = self.create_client(CalibrateJoint, '/calibrate')
        self.create_subscription(String, '/calibrate', self.on_joint, 10)
        self.create_timer(0.1, self.tick)
        self.to_ask = []  # joint names
        self.asked = {}  # future -> when it was asked
        self.get_logger().info('Ready to calibrate')

    def on_joint(self, message):
        self.to_ask.append(message.data)
        self.ask()

    def tick(self):
        self.ask()
        now = self.get_clock().now()
        self.asked = {future: since for future, since in self.asked.items() if now - since < LONGEST_WAIT}
        self.pending.publish(Int32(data=len(self.to_ask) + len(self.asked)))

    def ask(self):
        while self.to_ask and self.client.service_is_ready():
            joint = self.to_ask.pop(0)
            future = self.client.call_async(CalibrateJoint.Request(joint=joint))
            self.asked[future] = self.get_clock().now()
            future.add_done_callback(lambda future, joint=joint: self.on_answer(joint, future))

    def on_answer(self, joint, future):
        if self.asked.pop(future, None) is None:
            return
        answer = future.result()
        if answer.success and math.isfinite(answer.offset):
            self.offsets.publish(JointState(name=[joint], position=[answer.offset]))
        else:
            self.get_logger().warning(f'{joint} is not calibrated: {answer.message}')



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
