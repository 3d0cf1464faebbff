"""With a MultiThreadedExecutor, and a lock around the state."""

import threading

import rclpy
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.executors import ExternalShutdownException, MultiThreadedExecutor
from rclpy.node import Node
from std_msgs.msg import Bool
from std_srvs.srv import SetBool


class MotorSwitch(Node):
    def __init__(self):
        super().__init__('motor_switch')
        self.lock = threading.Lock()
        self.on = False
        self.emergency = False
        group = ReentrantCallbackGroup()
        self.publisher = self.create_publisher(Bool, '/motors_on', 10)
        self.create_subscription(Bool, '/emergency_stop', self.on_emergency, 10, callback_group=group)
        self.create_service(SetBool, '/switch_motors', self.on_request, callback_group=group)

    def on_request(self, request, response):
        with self.lock:
            if request.data and self.emergency:
                response.message = 'emergency stop'
            else:
                self.set(request.data)
                response.success = True
                response.message = ['motors off', 'motors on'][self.on]
        return response

    def on_emergency(self, message):
        with self.lock:
            self.emergency = message.data
            if message.data:
                self.set(False)

    def set(self, on):
        if (on and not self.on) or (self.on and not on):
            self.on = on
            self.publisher.publish(Bool(data=on))


def main():
    rclpy.init()
    node = MotorSwitch()
    try:
        rclpy.spin(node, MultiThreadedExecutor())
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == '__main__':
    main()
