"""One callback checks everything; `ros2 param describe` shows the range all the same."""

import math

import rclpy
from rcl_interfaces.msg import FloatingPointRange, ParameterDescriptor, SetParametersResult
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from rclpy.parameter import Parameter
from sensor_msgs.msg import JointState


class JointFilter(Node):
    def __init__(self):
        super().__init__('joint_filter')
        self.joints = {}
        self.declare_parameter(
            'gain',
            0.5,
            ParameterDescriptor(
                description='gain', floating_point_range=[FloatingPointRange(from_value=0.0, to_value=1.0)]
            ),
        )
        self.gain = self.get_parameter('gain').value
        self.add_on_set_parameters_callback(self.on_set)
        self.pub = self.create_publisher(JointState, '/joint_filtered', 10)
        self.sub = self.create_subscription(JointState, '/joint_commands', self.on_joints, 10)

    def on_set(self, parameters):
        gain = self.gain
        for parameter in parameters:
            if parameter.name == 'gain':
                right_type = parameter.type_ == Parameter.Type.DOUBLE
                if not right_type or not math.isfinite(parameter.value) or not 0 < parameter.value <= 1:
                    return SetParametersResult(successful=False, reason='no gain')
                gain = parameter.value
        self.gain = gain
        return SetParametersResult(successful=True)

    def on_joints(self, msg):
        for name, x in zip(msg.name, msg.position):
            y = self.joints.setdefault(name, x)
            self.joints[name] = y + self.gain * (x - y)
        msg.position = [self.joints[name] for name in msg.name]
        msg.velocity = []
        msg.effort = []
        self.pub.publish(msg)


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
