"""With a MultiThreadedExecutor: each request waits in a callback of its own, while the timer continues."""

import math
import threading

import rclpy
from humanoid_control_interfaces.srv import CalibrateJoint
from rclpy.callback_groups import MutuallyExclusiveCallbackGroup, ReentrantCallbackGroup
from rclpy.duration import Duration
from rclpy.executors import ExternalShutdownException, MultiThreadedExecutor
from rclpy.node import Node
from sensor_msgs.msg import JointState
from std_msgs.msg import Int32, String


class Calibration(Node):
    def __init__(self):
        super().__init__('calibration')
        self.lock = threading.Lock()
        self.offsets = self.create_publisher(JointState, '/joint_offsets', 10)
        self.pending = self.create_publisher(Int32, '/calibrations_pending', 10)
        questions, answers, timers = (
            ReentrantCallbackGroup(),
            ReentrantCallbackGroup(),
            MutuallyExclusiveCallbackGroup(),
        )
        self.client = self.create_client(CalibrateJoint, '/calibrate_joint', callback_group=answers)
        self.create_subscription(String, '/calibrate', self.on_joint, 10, callback_group=questions)
        self.create_timer(0.1, self.tick, callback_group=timers)
        self.waiting = []
        self.deadlines = {}

    def on_joint(self, message):
        with self.lock:
            self.waiting.append(message.data)
        self.ask()

    def ask(self):
        if not self.client.service_is_ready():
            return
        with self.lock:
            joints, self.waiting = self.waiting, []
        for joint in joints:
            with self.lock:
                future = self.client.call_async(CalibrateJoint.Request(joint=joint))
                self.deadlines[future] = self.get_clock().now() + Duration(seconds=5)
            future.add_done_callback(lambda future, joint=joint: self.on_answer(joint, future))

    def on_answer(self, joint, future):
        with self.lock:
            if self.deadlines.pop(future, None) is None:
                return
        if future.result().success and math.isfinite(future.result().offset):
            self.offsets.publish(JointState(name=[joint], position=[future.result().offset]))

    def tick(self):
        self.ask()
        with self.lock:
            now = self.get_clock().now()
            self.deadlines = {future: end for future, end in self.deadlines.items() if now < end}
            count = len(self.waiting) + len(self.deadlines)
        self.pending.publish(Int32(data=count))


def main():
    rclpy.init()
    node = Calibration()
    try:
        rclpy.spin(node, MultiThreadedExecutor())
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == '__main__':
    main()
