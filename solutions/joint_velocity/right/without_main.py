"""Without a main function, and with the node's end in a context of its own."""

import math

import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from sensor_msgs.msg import JointState


class JointVelocity(Node):
    before = None

    def __init__(self):
        Node.__init__(self, 'joint_velocity')
        self.pub = self.create_publisher(JointState, 'joint_velocities', 10)
        self.sub = self.create_subscription(JointState, 'joint_commands', self.callback, 10)

    def callback(self, msg):
        before, self.before = self.before, msg
        if before is None:
            return
        t1 = msg.header.stamp.sec + msg.header.stamp.nanosec / 1e9
        t0 = before.header.stamp.sec + before.header.stamp.nanosec / 1e9
        if t1 <= t0:
            return
        out = JointState()
        out.header.stamp = msg.header.stamp
        out.header.frame_id = msg.header.frame_id
        for i in range(min(len(msg.name), len(msg.position))):
            if not math.isfinite(msg.position[i]):
                continue
            for k in range(min(len(before.name), len(before.position))):
                if before.name[k] == msg.name[i] and math.isfinite(before.position[k]):
                    out.name.append(msg.name[i])
                    out.position.append(msg.position[i])
                    out.velocity.append((msg.position[i] - before.position[k]) / (t1 - t0))
        if len(out.name) > 0:
            self.pub.publish(out)


rclpy.init()
node = JointVelocity()
try:
    rclpy.spin(node)
except (KeyboardInterrupt, ExternalShutdownException):
    pass
rclpy.try_shutdown()
