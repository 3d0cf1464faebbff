"""With numpy: positions and velocities as arrays."""

import numpy as np
import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from rclpy.time import Time
from sensor_msgs.msg import JointState


class JointVelocity(Node):
    def __init__(self):
        super().__init__('joint_velocity')
        self.publisher = self.create_publisher(JointState, '/joint_velocities', 10)
        self.create_subscription(JointState, '/joint_commands', self.on_joints, 10)
        self.time = None
        self.names = np.array([], dtype=str)
        self.positions = np.array([])

    def on_joints(self, message):
        count = min(len(message.name), len(message.position))
        names = np.array(message.name[:count], dtype=str)
        positions = np.array(message.position[:count], dtype=float)
        finite = np.isfinite(positions)
        names, positions = names[finite], positions[finite]
        time = Time.from_msg(message.header.stamp)

        if self.time is not None and time > self.time:
            dt = (time - self.time).nanoseconds / 1e9
            both, now, before = np.intersect1d(names, self.names, return_indices=True)
            order = np.argsort(now)
            velocities = (positions[now] - self.positions[before]) / dt
            if both.size:
                answer = JointState(header=message.header)
                answer.name = [str(name) for name in both[order]]
                answer.velocity = velocities[order].tolist()
                self.publisher.publish(answer)

        self.time, self.names, self.positions = time, names, positions


def main():
    rclpy.init()
    node = JointVelocity()
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == '__main__':
    main()
