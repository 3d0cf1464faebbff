"""Without a main function, and with a queue for the names."""

from collections import deque
from math import isfinite

import rclpy
from humanoid_control_interfaces.srv import CalibrateJoint
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from sensor_msgs.msg import JointState
from std_msgs.msg import Int32, String


class Calibration(Node):
    def __init__(self):
        Node.__init__(self, 'calibration')
        self.queue = deque()
        self.open = set()
        self.cli = self.create_client(CalibrateJoint, '/calibrate_joint')
        self.pub1 = self.create_publisher(JointState, '/joint_offsets', 10)
        self.pub2 = self.create_publisher(Int32, '/calibrations_pending', 10)
        self.sub = self.create_subscription(String, '/calibrate', self.heard, 10)
        self.timer = self.create_timer(0.1, self.tick)

    def heard(self, msg):
        self.queue.append(msg.data)
        self.send()

    def send(self):
        while self.queue and self.cli.service_is_ready():
            joint = self.queue.popleft()
            future = self.cli.call_async(CalibrateJoint.Request(joint=joint))
            question = (future, self.get_clock().now().nanoseconds)
            self.open.add(question)
            future.add_done_callback(lambda _, question=question, joint=joint: self.answered(joint, question))

    def answered(self, joint, question):
        if question in self.open:
            self.open.remove(question)
            answer = question[0].result()
            if answer.success and isfinite(answer.offset):
                self.pub1.publish(JointState(name=[joint], position=[answer.offset]))

    def tick(self):
        self.send()
        for question in [q for q in self.open if self.get_clock().now().nanoseconds - q[1] >= 5e9]:
            self.open.remove(question)
        self.pub2.publish(Int32(data=len(self.queue) + len(self.open)))


rclpy.init()
node = Calibration()
try:
    rclpy.spin(node)
except (KeyboardInterrupt, ExternalShutdownException):
    pass
rclpy.try_shutdown()
