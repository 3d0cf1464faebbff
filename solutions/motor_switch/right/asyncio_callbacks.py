"""With callbacks that are coroutines."""

import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from std_msgs.msg import Bool
from std_srvs.srv import SetBool


class MotorSwitch(Node):
    def __init__(self):
        super().__init__('motor_switch')
        self.on, self.emergency = False, False
        self.pub = self.create_publisher(Bool, '/motors_on', 10)
        self.sub = self.create_subscription(Bool, '/emergency_stop', self.stop, 10)
        self.srv = self.create_service(SetBool, '/switch_motors', self.serve)

    async def serve(self, request, response):
        if self.emergency and request.data:
            response.success, response.message = False, 'emergency stop'
        else:
            await self.turn(request.data)
            response.success, response.message = True, 'motors on' if request.data else 'motors off'
        return response

    async def stop(self, message):
        self.emergency = message.data
        if self.emergency:
            await self.turn(False)

    async def turn(self, on):
        was, self.on = self.on, on
        if was != on:
            self.pub.publish(Bool(data=on))


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
