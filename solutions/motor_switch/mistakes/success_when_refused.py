"""Reports success when it has refused.

Caught by:
- test_refuses_in_an_emergency
- test_pressed_while_off
- test_pressed_twice
"""

import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from std_msgs.msg import Bool
from std_srvs.srv import SetBool


class MotorSwitch(Node):

    def __init__(self):
        super().__init__('motor_switch')
        self.on = False
        self.emergency = False
        self.publisher = self.create_publisher(Bool, '/motors_on', 10)
        self.create_subscription(Bool, '/emergency_stop', self.on_emergency_stop, 10)
        self.create_service(SetBool, '/switch_motors', self.on_request)
        self.get_logger().info('The motors are off')

    def on_request(self, request, response):
        if request.data and self.emergency:
            response.success = True
            response.message = 'emergency stop'
            return response
        self.switch(request.data)
        response.success = True
        response.message = 'motors on' if self.on else 'motors off'
        return response

    def on_emergency_stop(self, message):
        self.emergency = message.data
        if self.emergency:
            self.switch(False)

    def switch(self, on):
        if on != self.on:
            self.on = on
            self.publisher.publish(Bool(data=on))



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
