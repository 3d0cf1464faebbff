"""With numpy, and the joints' smooth positions looked up by name."""

import numpy as np
import rclpy
from rcl_interfaces.msg import FloatingPointRange, ParameterDescriptor, SetParametersResult
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from sensor_msgs.msg import JointState


class JointFilter(Node):
    def __init__(self):
        super().__init__('joint_filter')
        limits = FloatingPointRange(from_value=0.0, to_value=1.0)
        self.declare_parameter(
            'gain', value=0.5, descriptor=ParameterDescriptor(description='filter gain', floating_point_range=[limits])
        )
        self.add_on_set_parameters_callback(self.validate)
        self.known = {}
        self.publisher = self.create_publisher(JointState, '/joint_filtered', 10)
        self.create_subscription(JointState, '/joint_commands', self.on_joints, 10)

    def validate(self, parameters):
        good = all(0 < p.value <= 1 for p in parameters if p.name == 'gain')
        return SetParametersResult(successful=good, reason='' if good else 'out of range')

    def on_joints(self, message):
        now = np.array(message.position)
        before = np.array([self.known.get(name, place) for name, place in zip(message.name, message.position)])
        smooth = before + self.get_parameter('gain').value * (now - before)
        self.known.update(zip(message.name, smooth))
        self.publisher.publish(JointState(header=message.header, name=message.name, position=smooth.tolist()))


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
