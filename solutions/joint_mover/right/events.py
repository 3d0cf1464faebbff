"""An event for each goal says that a newer one has come; four threads."""

import threading

import rclpy
from humanoid_control_interfaces.action import MoveJoint
from rclpy.action import ActionServer, CancelResponse, GoalResponse
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.duration import Duration
from rclpy.executors import ExternalShutdownException, MultiThreadedExecutor
from rclpy.node import Node

LIMITS = (0.0, 2.356)


class JointMover(Node):
    def __init__(self):
        super().__init__('joint_mover')
        self.position = 0.0
        self.lock = threading.Lock()
        self.replaced = threading.Event()
        group = ReentrantCallbackGroup()
        self.server = ActionServer(
            self,
            MoveJoint,
            '/move_joint',
            self.execute,
            goal_callback=self.goal,
            cancel_callback=self.cancel,
            callback_group=group,
        )

    def goal(self, goal):
        low, high = LIMITS
        if not (low <= goal.position <= high):
            self.get_logger().warning(f'{goal.position} rad is out of reach')
            return GoalResponse.REJECT
        return GoalResponse.ACCEPT

    def cancel(self, _):
        return CancelResponse.ACCEPT

    def execute(self, handle):
        replaced = threading.Event()
        with self.lock:
            self.replaced.set()
            self.replaced = replaced
        while self.position != handle.request.position:
            self.get_clock().sleep_for(Duration(seconds=0.1))
            with self.lock:
                if handle.is_cancel_requested:
                    handle.canceled()
                    return MoveJoint.Result(position=self.position)
                if replaced.is_set():
                    handle.abort()
                    return MoveJoint.Result(position=self.position)
                self.step(handle)
        handle.succeed()
        return MoveJoint.Result(position=self.position)

    def step(self, handle):
        left = handle.request.position - self.position
        if abs(left) <= 0.05:
            self.position = handle.request.position
        elif left > 0:
            self.position = self.position + 0.05
        else:
            self.position = self.position - 0.05
        handle.publish_feedback(MoveJoint.Feedback(position=self.position))


def main():
    rclpy.init()
    node = JointMover()
    executor = MultiThreadedExecutor(num_threads=4)
    executor.add_node(node)
    try:
        executor.spin()
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        executor.shutdown()
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == '__main__':
    main()
