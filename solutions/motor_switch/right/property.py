"""The motors as a property, whose setter publishes."""

import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from std_msgs.msg import Bool
from std_srvs.srv import SetBool


class MotorSwitch(Node):
    def __init__(self):
        super().__init__('motor_switch')
        self._motors = self.pressed = False
        self.publisher = self.create_publisher(Bool, 'motors_on', 10)
        self.create_service(SetBool, 'switch_motors', self.on_request)
        self.create_subscription(Bool, 'emergency_stop', self.on_stop, 10)

    @property
    def motors(self):
        return self._motors

    @motors.setter
    def motors(self, on):
        if on == self._motors:
            return
        self._motors = on
        self.publisher.publish(Bool(data=on))

    def on_request(self, request, response):
        allowed = not (request.data and self.pressed)
        if allowed:
            self.motors = request.data
        response.success = allowed
        response.message = ('motors on' if self.motors else 'motors off') if allowed else 'emergency stop'
        return response

    def on_stop(self, msg):
        self.pressed = msg.data
        self.motors = self.motors and not msg.data


def main():
    rclpy.init()
    node = MotorSwitch()
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == '__main__':
    main()
