"""The rules in a class that knows nothing about ROS."""

import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from std_msgs.msg import Bool
from std_srvs.srv import SetBool


class Motors:
    def __init__(self, changed):
        self.changed = changed
        self.on = False
        self.blocked = False

    def ask(self, on):
        if on and self.blocked:
            return False, 'emergency stop'
        self.set(on)
        return True, f'motors {"on" if on else "off"}'

    def block(self, blocked):
        self.blocked = blocked
        self.set(self.on and not blocked)

    def set(self, on):
        if self.on != on:
            self.on = on
            self.changed(on)


class MotorSwitch(Node):
    def __init__(self):
        super().__init__('motor_switch')
        publisher = self.create_publisher(Bool, '/motors_on', 10)
        self.motors = Motors(lambda on: publisher.publish(Bool(data=on)))
        self.create_subscription(Bool, '/emergency_stop', lambda message: self.motors.block(message.data), 10)
        self.create_service(SetBool, '/switch_motors', self.serve)

    def serve(self, request, response):
        response.success, response.message = self.motors.ask(request.data)
        return response


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
