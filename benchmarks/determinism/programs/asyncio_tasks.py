"""An asyncio loop turns the node each 10 ms, and a task publishes each 33 ms."""

import asyncio

import rclpy
from rclpy.node import Node
from sensor_msgs.msg import JointState


class Relay(Node):
    """Publishes each message's joints again, with their positions as velocities."""

    def __init__(self):
        super().__init__('joint_velocity')
        self.publisher = self.create_publisher(JointState, '/joint_velocities', 10)
        self.create_subscription(JointState, '/joint_commands', self.on_joints, 10)

    def answer(self, message, name=''):
        names = [name + joint for joint in message.name]
        self.publisher.publish(JointState(header=message.header, name=names, velocity=message.position))

    def on_joints(self, message):
        self.answer(message)


rclpy.init()
node = Relay()
last = JointState()


async def turn():
    while rclpy.ok():
        rclpy.spin_once(node, timeout_sec=0)
        await asyncio.sleep(0.01)


async def talk():
    while rclpy.ok():
        node.answer(last)
        await asyncio.sleep(0.033)


async def main():
    await asyncio.gather(turn(), talk())


asyncio.run(main())
