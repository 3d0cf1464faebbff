"""Without a reentrant group: a MultiThreadedExecutor runs execute beside other callbacks anyway. Waits with a Rate."""

import rclpy
from humanoid_control_interfaces.action import MoveJoint
from rclpy.action import ActionServer, CancelResponse, GoalResponse
from rclpy.executors import ExternalShutdownException, MultiThreadedExecutor
from rclpy.node import Node


class JointMover(Node):
    def __init__(self):
        super().__init__('joint_mover')
        self.at = 0.0
        self.newest = None
        self.server = ActionServer(
            self, MoveJoint, 'move_joint', self.execute, goal_callback=self.on_goal, cancel_callback=self.on_cancel
        )

    def on_goal(self, goal):
        return GoalResponse.ACCEPT if 0.0 <= goal.position <= 2.356 else GoalResponse.REJECT

    def on_cancel(self, goal_handle):
        return CancelResponse.ACCEPT

    def execute(self, goal_handle):
        self.newest = goal_handle.goal_id
        goal = goal_handle.request.position
        clock = self.get_clock()
        until = clock.now().nanoseconds
        while abs(goal - self.at) > 1e-9:
            until += 100_000_000
            clock.sleep_until(rclpy.time.Time(nanoseconds=until, clock_type=clock.clock_type))
            if goal_handle.is_cancel_requested:
                goal_handle.canceled()
                break
            if self.newest != goal_handle.goal_id:
                goal_handle.abort()
                break
            if abs(goal - self.at) <= 0.05:
                self.at = goal
            else:
                self.at += 0.05 if goal > self.at else -0.05
            goal_handle.publish_feedback(MoveJoint.Feedback(position=self.at))
        else:
            goal_handle.succeed()
        result = MoveJoint.Result()
        result.position = self.at
        return result


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
