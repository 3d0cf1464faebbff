"""Single-threaded: execute is a coroutine that awaits a future, and a timer moves the joint."""

import rclpy
from humanoid_control_interfaces.action import MoveJoint
from rclpy.action import ActionServer, CancelResponse, GoalResponse
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from rclpy.task import Future


class JointMover(Node):
    def __init__(self):
        super().__init__('joint_mover')
        self.position = 0.0
        self.goal_handle = self.done = self.timer = None
        self.server = ActionServer(
            self,
            MoveJoint,
            '/move_joint',
            self.execute,
            goal_callback=self.on_goal,
            cancel_callback=lambda goal_handle: CancelResponse.ACCEPT,
        )

    def on_goal(self, goal):
        if goal.position < 0.0 or goal.position > 2.356 or goal.position != goal.position:
            return GoalResponse.REJECT
        return GoalResponse.ACCEPT

    async def execute(self, goal_handle):
        if self.done is not None and not self.done.done():
            self.done.set_result('abort')
        if self.timer is not None:
            self.destroy_timer(self.timer)
            self.timer = None
        if goal_handle.request.position == self.position:
            goal_handle.succeed()
            return MoveJoint.Result(position=self.position)
        done = self.done = Future(executor=self.executor)
        self.goal_handle = goal_handle
        self.timer = self.create_timer(0.1, self.step)
        getattr(goal_handle, await done)()
        if self.done is done and self.timer is not None:
            self.destroy_timer(self.timer)
            self.timer = None
        return MoveJoint.Result(position=self.position)

    def step(self):
        if self.done.done():
            return
        if self.goal_handle.is_cancel_requested:
            self.done.set_result('canceled')
            return
        way = self.goal_handle.request.position - self.position
        self.position += max(-0.05, min(way, 0.05))
        if abs(way) <= 0.05:
            self.position = self.goal_handle.request.position
        self.goal_handle.publish_feedback(MoveJoint.Feedback(position=self.position))
        if self.position == self.goal_handle.request.position:
            self.done.set_result('succeed')


def main():
    rclpy.init()
    node = JointMover()
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == '__main__':
    main()
