"""Without a class: create_node, closures and a dictionary."""

import rclpy
from rclpy.executors import ExternalShutdownException
from std_msgs.msg import Bool
from std_srvs.srv import SetBool


def main():
    rclpy.init()
    node = rclpy.create_node('motor_switch')
    publisher = node.create_publisher(Bool, '/motors_on', 10)
    state = {'on': False, 'stopped': False}

    def change(on):
        if state['on'] is not on:
            state['on'] = on
            publisher.publish(Bool(data=on))

    def on_request(request, _):
        if request.data and state['stopped']:
            return SetBool.Response(success=False, message='emergency stop')
        change(request.data)
        return SetBool.Response(success=True, message=f'motors {"on" if request.data else "off"}')

    def on_stop(message):
        state['stopped'] = message.data
        if message.data:
            change(False)

    node.create_service(SetBool, '/switch_motors', on_request)
    node.create_subscription(Bool, '/emergency_stop', on_stop, 10)
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == '__main__':
    main()
