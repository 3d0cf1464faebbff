"""Have joints calibrated by a service, and never wait for it."""

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
    """Asks for the calibration of each joint that it receives, and continues while it waits for the answers."""

    def __init__(self):
        super().__init__('calibration')
        # TODO: create the publishers of '/joint_offsets' (JointState) and '/calibrations_pending' (Int32).
        # TODO: create the client of '/calibrate_joint' (CalibrateJoint).
        # TODO: subscribe to '/calibrate' (String) with self.on_joint, and create a timer that calls self.tick at 10 Hz.
        # TODO: remember which joints wait to be asked for, and which questions wait for an answer.
        # BEGIN SOLUTION
        self.offsets = self.create_publisher(JointState, '/joint_offsets', 10)
        self.pending = self.create_publisher(Int32, '/calibrations_pending', 10)
        self.client = self.create_client(CalibrateJoint, '/calibrate_joint')
        self.create_subscription(String, '/calibrate', self.on_joint, 10)
        self.create_timer(0.1, self.tick)
        self.to_ask = []  # joint names
        self.asked = {}  # future -> when it was asked
        # END SOLUTION
        self.get_logger().info('Ready to calibrate')

    def on_joint(self, message):
        """Called once for each joint that is to be calibrated."""
        # TODO: ask the service, if it is there. Don't wait for its answer.
        # BEGIN SOLUTION
        self.to_ask.append(message.data)
        self.ask()
        # END SOLUTION

    def tick(self):
        """Called ten times per second."""
        # TODO: ask for the joints that wait, give up those that have waited too long, and publish how many are pending.
        # BEGIN SOLUTION
        self.ask()
        now = self.get_clock().now()
        self.asked = {future: since for future, since in self.asked.items() if now - since < LONGEST_WAIT}
        self.pending.publish(Int32(data=len(self.to_ask) + len(self.asked)))
        # END SOLUTION

    # BEGIN SOLUTION
    def ask(self):
        """Ask for every joint that waits, if the service is there."""
        while self.to_ask and self.client.service_is_ready():
            joint = self.to_ask.pop(0)
            future = self.client.call_async(CalibrateJoint.Request(joint=joint))
            self.asked[future] = self.get_clock().now()
            future.add_done_callback(lambda future, joint=joint: self.on_answer(joint, future))

    def on_answer(self, joint, future):
        """Called once for each answer."""
        if self.asked.pop(future, None) is None:
            return
        answer = future.result()
        if answer.success and math.isfinite(answer.offset):
            self.offsets.publish(JointState(name=[joint], position=[answer.offset]))
        else:
            self.get_logger().warning(f'{joint} is not calibrated: {answer.message}')

    # END SOLUTION


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
