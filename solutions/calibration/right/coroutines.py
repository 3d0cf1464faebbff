"""With a coroutine that awaits the answer, in a callback group of its own."""

import math

import rclpy
from humanoid_control_interfaces.srv import CalibrateJoint
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from sensor_msgs.msg import JointState
from std_msgs.msg import Int32, String


class Calibration(Node):
    def __init__(self):
        super().__init__('calibration')
        group = ReentrantCallbackGroup()
        self.offsets = self.create_publisher(JointState, '/joint_offsets', 10)
        self.count = self.create_publisher(Int32, '/calibrations_pending', 10)
        self.client = self.create_client(CalibrateJoint, '/calibrate_joint', callback_group=group)
        self.create_subscription(String, '/calibrate', self.on_joint, 10, callback_group=group)
        self.create_timer(0.1, self.tick)
        self.waiting, self.asked = [], {}

    def on_joint(self, message):
        self.waiting.append(message.data)
        self.ask()

    def ask(self):
        while self.waiting and self.client.service_is_ready():
            joint = self.waiting.pop(0)
            future = self.client.call_async(CalibrateJoint.Request(joint=joint))
            self.asked[future] = self.get_clock().now().nanoseconds
            self.executor.create_task(self.finish(joint, future))

    async def finish(self, joint, future):
        answer = await future
        if self.asked.pop(future, None) is not None and answer.success and math.isfinite(answer.offset):
            self.offsets.publish(JointState(name=[joint], position=[answer.offset]))

    def tick(self):
        self.ask()
        now = self.get_clock().now().nanoseconds
        for future in [future for future, since in self.asked.items() if now - since >= 5 * 10**9]:
            del self.asked[future]
        self.count.publish(Int32(data=len(self.waiting) + len(self.asked)))


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
