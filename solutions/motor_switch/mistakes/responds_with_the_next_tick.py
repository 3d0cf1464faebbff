"""Responds with the next tick of a timer, up to half a second later.

Caught by:
- test_responds_at_once
"""

import rclpy
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from rclpy.task import Future
from std_msgs.msg import Bool
from std_srvs.srv import SetBool


class MotorSwitch(Node):

    def __init__(self):
        super().__init__('motor_switch')
        self.on = False
        self.emergency = False
        self.next_tick = Future()
        self.publisher = self.create_publisher(Bool, '/motors_on', 10)
        self.create_subscription(Bool, '/emergency_stop', self.on_emergency_stop, 10)
        self.create_service(SetBool, '/switch_motors', self.on_request, callback_group=ReentrantCallbackGroup())
        self.create_timer(0.5, self.tick)

    def tick(self):
        done, self.next_tick = self.next_tick, Future()
        done.set_result(None)

    async def on_request(self, request, response):
        if request.data and self.emergency:
            response.success = False
            response.message = 'emergency stop'
        else:
            self.switch(request.data)
            response.success = True
            response.message = 'motors on' if request.data else 'motors off'
        await self.next_tick
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
