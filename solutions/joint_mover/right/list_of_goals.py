"""Goals are numbered when they are accepted; only the newest moves the joint."""

import math

import rclpy
from humanoid_control_interfaces.action import MoveJoint
from rclpy.action import ActionServer, CancelResponse, GoalResponse
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.duration import Duration
from rclpy.executors import ExternalShutdownException, MultiThreadedExecutor
from rclpy.node import Node


class JointMover(Node):
    def __init__(self):
        super().__init__('joint_mover')
        self.goals = []
        self.position = 0.0
        self.server = ActionServer(
            self,
            MoveJoint,
            '/move_joint',
            execute_callback=self.execute,
            callback_group=ReentrantCallbackGroup(),
            goal_callback=self.check,
            handle_accepted_callback=self.accepted,
            cancel_callback=self.cancel,
        )

    def check(self, request):
        possible = math.isfinite(request.position) and 0 <= request.position <= 2.356
        return GoalResponse.ACCEPT if possible else GoalResponse.REJECT

    def accepted(self, goal_handle):
        self.goals.append(goal_handle)
        goal_handle.execute()

    def cancel(self, goal_handle):
        self.get_logger().info('A goal is canceled')
        return CancelResponse.ACCEPT

    def execute(self, goal_handle):
        ended = self.move(goal_handle)
        ended()
        return MoveJoint.Result(position=self.position)

    def move(self, goal_handle):
        target = goal_handle.request.position
        for place in self.places(target):
            self.get_clock().sleep_for(Duration(nanoseconds=100_000_000))
            if goal_handle.is_cancel_requested:
                return goal_handle.canceled
            if self.goals[-1] is not goal_handle:
                return goal_handle.abort
            self.position = place
            feedback = MoveJoint.Feedback()
            feedback.position = place
            goal_handle.publish_feedback(feedback)
        return goal_handle.succeed

    def places(self, target):
        steps = math.ceil(abs(target - self.position) / 0.05 - 1e-9)
        start = self.position
        return [start + math.copysign(0.05 * n, target - start) for n in range(1, steps)] + [target] * bool(steps)


def main():
    rclpy.init()
    node = JointMover()
    try:
        rclpy.spin(node, MultiThreadedExecutor())
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == '__main__':
    main()
