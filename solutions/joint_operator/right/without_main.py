"""Without a main function, and with a timer at 20 Hz that looks after everything."""

import rclpy
from humanoid_control_interfaces.action import MoveJoint
from rclpy.action import ActionClient
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from std_msgs.msg import Float64, String


class JointOperator(Node):
    def __init__(self):
        Node.__init__(self, 'joint_operator')
        self.out = self.create_publisher(String, 'outcomes', 10)
        self.prog = self.create_publisher(Float64, 'progress', 10)
        self.client = ActionClient(self, MoveJoint, 'move_joint')
        self.todo = []
        self.goal_handle = None
        self.started = None
        self.sub = self.create_subscription(Float64, 'targets', self.target, 10)
        self.timer = self.create_timer(0.05, self.look)

    def target(self, msg):
        self.todo.append(msg.data)
        self.look()

    def look(self):
        if self.started is None:
            self.send()
        elif self.goal_handle and self.deadline and self.get_clock().now().nanoseconds >= self.deadline:
            self.goal_handle.cancel_goal_async()
            self.deadline = None

    def send(self):
        if len(self.todo) == 0 or not self.client.server_is_ready():
            return
        self.started = self.client.send_goal_async(MoveJoint.Goal(position=self.todo.pop(0)), self.feedback)
        self.started.add_done_callback(self.answered)

    def feedback(self, msg):
        self.prog.publish(Float64(data=msg.feedback.position))

    def answered(self, future):
        self.goal_handle = future.result()
        if self.goal_handle.accepted:
            self.deadline = self.get_clock().now().nanoseconds + 5_000_000_000
            self.goal_handle.get_result_async().add_done_callback(self.ended)
        else:
            self.say('rejected')

    def ended(self, future):
        words = ('', '', '', '', 'succeeded', 'canceled', 'aborted')
        self.say(words[future.result().status])

    def say(self, word):
        self.out.publish(String(data=word))
        self.goal_handle = self.started = None
        self.send()


rclpy.init()
node = JointOperator()
try:
    rclpy.spin(node)
except (KeyboardInterrupt, ExternalShutdownException):
    pass
rclpy.try_shutdown()
