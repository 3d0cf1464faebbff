"""Keeps the gain in a variable, which the post-set callback renews."""

import rclpy
from rcl_interfaces.msg import FloatingPointRange, ParameterDescriptor, SetParametersResult
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from sensor_msgs.msg import JointState


class JointFilter(Node):
    def __init__(self):
        super().__init__('joint_filter')
        descriptor = ParameterDescriptor()
        descriptor.description = 'Part of the way to each new position'
        descriptor.floating_point_range.append(FloatingPointRange(from_value=0.0, to_value=1.0, step=0.0))
        self.gain = self.declare_parameter('gain', 0.5, descriptor).value
        self.add_on_set_parameters_callback(self.check)
        self.add_post_set_parameters_callback(self.renew)
        self.state = {}
        self.pub = self.create_publisher(JointState, 'joint_filtered', 10)
        self.sub = self.create_subscription(JointState, 'joint_commands', self.callback, 10)

    def check(self, params):
        for param in params:
            if param.name == 'gain' and (param.value <= 0.0 or param.value > 1.0 or param.value != param.value):
                return SetParametersResult(successful=False, reason=f'gain {param.value} is not in (0, 1]')
        return SetParametersResult(successful=True)

    def renew(self, params):
        for param in params:
            if param.name == 'gain':
                self.gain = param.value

    def callback(self, msg):
        out = JointState()
        out.header = msg.header
        for i in range(len(msg.name)):
            name = msg.name[i]
            if name not in self.state:
                self.state[name] = msg.position[i]
            self.state[name] += self.gain * (msg.position[i] - self.state[name])
            out.name.append(name)
            out.position.append(self.state[name])
        self.pub.publish(out)


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
