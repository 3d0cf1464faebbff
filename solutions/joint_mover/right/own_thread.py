"""The executor has a thread of its own, and the joint is a class that knows no ROS."""

import threading

import rclpy
from humanoid_control_interfaces.action import MoveJoint
from rclpy.action import ActionServer, CancelResponse, GoalResponse
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.duration import Duration
from rclpy.executors import ExternalShutdownException, MultiThreadedExecutor
from rclpy.node import Node


class Joint:
    def __init__(self):
        self.position = 0.0

    def can_reach(self, position):
        return 0.0 <= position <= 2.356

    def step_towards(self, position):
        low, high = self.position - 0.05, self.position + 0.05
        self.position = min(max(position, low), high)


class JointMover(Node):
    def __init__(self):
        super().__init__('joint_mover')
        self.joint = Joint()
        self.number = 0
        self.server = ActionServer(
            self,
            MoveJoint,
            '/move_joint',
            self.execute,
            goal_callback=lambda goal: GoalResponse(1 + self.joint.can_reach(goal.position)),
            cancel_callback=lambda handle: CancelResponse.ACCEPT,
            callback_group=ReentrantCallbackGroup(),
        )

    def execute(self, handle):
        self.number += 1
        mine, target = self.number, handle.request.position
        while self.joint.position != target and not handle.is_cancel_requested and mine == self.number:
            self.get_clock().sleep_for(Duration(seconds=0.1))
            if not handle.is_cancel_requested and mine == self.number:
                self.joint.step_towards(target)
                handle.publish_feedback(MoveJoint.Feedback(position=self.joint.position))
        if handle.is_cancel_requested:
            handle.canceled()
        elif mine != self.number:
            handle.abort()
        else:
            handle.succeed()
        return MoveJoint.Result(position=self.joint.position)


def spin(executor):
    try:
        executor.spin()
    except ExternalShutdownException:
        pass


def main():
    rclpy.init()
    node = JointMover()
    executor = MultiThreadedExecutor()
    executor.add_node(node)
    thread = threading.Thread(target=spin, args=(executor,))
    thread.start()
    try:
        while thread.is_alive():
            thread.join(0.5)
    except KeyboardInterrupt:
        pass
    executor.shutdown()
    rclpy.try_shutdown()
    thread.join()


if __name__ == '__main__':
    main()
