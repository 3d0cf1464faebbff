"""With a MultiThreadedExecutor and a lock."""

import threading

import rclpy
from rcl_interfaces.msg import FloatingPointRange, ParameterDescriptor, SetParametersResult
from rclpy.executors import ExternalShutdownException, MultiThreadedExecutor
from rclpy.node import Node
from sensor_msgs.msg import JointState


class JointFilter(Node):
    def __init__(self):
        super().__init__('joint_filter')
        self.lock = threading.Lock()
        self.last = {}
        self.declare_parameters(
            '',
            [
                (
                    'gain',
                    0.5,
                    ParameterDescriptor(
                        description='Gain of the low-pass filter',
                        floating_point_range=[FloatingPointRange(from_value=0.0, to_value=1.0)],
                    ),
                )
            ],
        )
        self.add_on_set_parameters_callback(self.on_set)
        self.publisher = self.create_publisher(JointState, '/joint_filtered', 10)
        self.create_subscription(JointState, '/joint_commands', self.on_joints, 10)

    def on_set(self, parameters):
        for parameter in parameters:
            if parameter.name == 'gain' and parameter.value == 0.0:
                return SetParametersResult(successful=False, reason='a gain of zero would never move')
        return SetParametersResult(successful=True)

    def on_joints(self, message):
        with self.lock:
            gain = self.get_parameter('gain').value
            answer = JointState(header=message.header)
            for name, position in zip(message.name, message.position):
                if name in self.last:
                    position = gain * position + (1.0 - gain) * self.last[name]
                self.last[name] = position
                answer.name.append(name)
                answer.position.append(position)
        self.publisher.publish(answer)


def main():
    rclpy.init()
    node = JointFilter()
    try:
        rclpy.spin(node, MultiThreadedExecutor())
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == '__main__':
    main()
