"""Smooth the joints' positions, by as much as the parameter `gain` says."""

import rclpy
from rcl_interfaces.msg import FloatingPointRange, ParameterDescriptor, SetParametersResult
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from sensor_msgs.msg import JointState


class JointFilter(Node):
    """A low-pass filter for each joint."""

    def __init__(self):
        super().__init__('joint_filter')
        self.smooth = {}  # joint name -> rad
        # TODO: declare the parameter 'gain' with its default, a description and its range.
        # TODO: refuse what the range can't: a gain of exactly 0.0.
        # TODO: create the publisher of '/joint_filtered' and the subscription of '/joint_commands', both JointState.
        # BEGIN SOLUTION
        description = ParameterDescriptor(
            description='How much of each new position is taken: 1.0 is all of it.',
            floating_point_range=[FloatingPointRange(from_value=0.0, to_value=1.0)],
        )
        self.declare_parameter('gain', 0.5, description)
        self.add_on_set_parameters_callback(self.on_set)
        self.publisher = self.create_publisher(JointState, '/joint_filtered', 10)
        self.create_subscription(JointState, '/joint_commands', self.on_joints, 10)
        # END SOLUTION
        self.get_logger().info('Ready to filter')

    def on_joints(self, message):
        """Called once for each message on /joint_commands."""
        # TODO: for each joint, move the smooth position towards the new one, by the fraction that the gain gives.
        # BEGIN SOLUTION
        gain = self.get_parameter('gain').value
        answer = JointState(header=message.header, name=message.name)
        for name, position in zip(message.name, message.position):
            before = self.smooth.get(name, position)
            self.smooth[name] = before + gain * (position - before)
            answer.position.append(self.smooth[name])
        self.publisher.publish(answer)
        # END SOLUTION

    # BEGIN SOLUTION
    def on_set(self, parameters):
        """Called before parameters change. Returns whether they may."""
        for parameter in parameters:
            if parameter.name == 'gain' and not 0.0 < parameter.value <= 1.0:
                return SetParametersResult(successful=False, reason='gain must be more than 0.0 and at most 1.0')
        return SetParametersResult(successful=True)

    # END SOLUTION


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
