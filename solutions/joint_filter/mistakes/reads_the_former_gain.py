"""Reads the gain in the on-set callback, where it still has its old value.

Caught by:
- test_gain_that_changes
"""

import rclpy
from rcl_interfaces.msg import FloatingPointRange, ParameterDescriptor, SetParametersResult
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from sensor_msgs.msg import JointState


class JointFilter(Node):

    def __init__(self):
        super().__init__('joint_filter')
        self.smooth = {}  # joint name -> rad
        description = ParameterDescriptor(
            description='How much of each new position is taken: 1.0 is all of it.',
            floating_point_range=[FloatingPointRange(from_value=0.0, to_value=1.0)],
        )
        self.declare_parameter('gain', 0.5, description)
        self.add_on_set_parameters_callback(self.on_set)
        self.gain = self.get_parameter('gain').value
        self.publisher = self.create_publisher(JointState, '/joint_filtered', 10)
        self.create_subscription(JointState, '/joint_commands', self.on_joints, 10)
        self.get_logger().info('Ready to filter')

    def on_joints(self, message):
        gain = self.gain
        answer = JointState(header=message.header, name=message.name)
        for name, position in zip(message.name, message.position):
            before = self.smooth.get(name, position)
            self.smooth[name] = before + gain * (position - before)
            answer.position.append(self.smooth[name])
        self.publisher.publish(answer)

    def on_set(self, parameters):
        for parameter in parameters:
            if parameter.name == 'gain' and not 0.0 < parameter.value <= 1.0:
                return SetParametersResult(successful=False, reason='gain must be more than 0.0 and at most 1.0')
        self.gain = self.get_parameter('gain').value
        return SetParametersResult(successful=True)



def main():
    rclpy.init()
    node = JointFilter()
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == '__main__':
    main()
