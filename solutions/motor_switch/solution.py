"""Switch the motors on and off when asked, but never on during an emergency stop."""

import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from std_msgs.msg import Bool
from std_srvs.srv import SetBool


class MotorSwitch(Node):
    """Knows whether the motors are on, and whether they may be."""

    def __init__(self):
        super().__init__('motor_switch')
        self.on = False
        self.emergency = False
        # TODO: create a publisher of Bool messages on '/motors_on', with a queue depth of 10.
        # TODO: subscribe to '/emergency_stop' (Bool) with self.on_emergency_stop.
        # TODO: create the service '/switch_motors' (SetBool) with self.on_request.
        # BEGIN SOLUTION
        self.publisher = self.create_publisher(Bool, '/motors_on', 10)
        self.create_subscription(Bool, '/emergency_stop', self.on_emergency_stop, 10)
        self.create_service(SetBool, '/switch_motors', self.on_request)
        # END SOLUTION
        self.get_logger().info('The motors are off')

    def on_request(self, request, response):
        """Called once for each request."""
        # TODO: switch the motors, unless the emergency stop forbids it.
        # TODO: fill in response.success and response.message.
        # BEGIN SOLUTION
        if request.data and self.emergency:
            response.success = False
            response.message = 'emergency stop'
            return response
        self.switch(request.data)
        response.success = True
        response.message = 'motors on' if self.on else 'motors off'
        # END SOLUTION
        return response

    def on_emergency_stop(self, message):
        """Called when somebody presses the emergency stop (True) or releases it (False)."""
        # TODO: remember it. When it is pressed, switch the motors off.
        # BEGIN SOLUTION
        self.emergency = message.data
        if self.emergency:
            self.switch(False)
        # END SOLUTION

    # BEGIN SOLUTION
    def switch(self, on):
        """Switch the motors, and publish the change if it is one."""
        if on != self.on:
            self.on = on
            self.publisher.publish(Bool(data=on))

    # END SOLUTION


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
