"""Without a class: create_node and closures."""

import rclpy
from rcl_interfaces.msg import FloatingPointRange, ParameterDescriptor, SetParametersResult
from rclpy.executors import ExternalShutdownException
from sensor_msgs.msg import JointState


def may_be_set(parameters):
    if any(p.name == 'gain' and not p.value > 0 for p in parameters):
        return SetParametersResult(successful=False, reason='the gain must be positive')
    return SetParametersResult(successful=True)


def main():
    rclpy.init()
    node = rclpy.create_node('joint_filter')
    bounds = FloatingPointRange(from_value=0.0, to_value=1.0)
    node.declare_parameter('gain', 0.5, ParameterDescriptor(description='the gain', floating_point_range=[bounds]))
    node.add_on_set_parameters_callback(may_be_set)
    publisher = node.create_publisher(JointState, '/joint_filtered', 10)
    smooth = {}

    def on_joints(message):
        gain = node.get_parameter('gain').get_parameter_value().double_value
        for name, position in zip(message.name, message.position):
            smooth[name] = gain * position + (1 - gain) * smooth.get(name, position)
        names = list(message.name)
        publisher.publish(JointState(header=message.header, name=names, position=[smooth[n] for n in names]))

    node.create_subscription(JointState, '/joint_commands', on_joints, 10)
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == '__main__':
    main()
