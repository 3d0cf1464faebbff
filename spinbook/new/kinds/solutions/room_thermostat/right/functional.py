"""Without a class; the ranges are in the parameters' descriptors, so that ROS refuses what is outside."""

import rclpy
from rcl_interfaces.msg import FloatingPointRange, ParameterDescriptor
from rclpy.executors import ExternalShutdownException
from std_msgs.msg import Bool, Float64


def between(lowest, highest):
    return ParameterDescriptor(floating_point_range=[FloatingPointRange(from_value=lowest, to_value=highest)])


def main():
    rclpy.init()
    node = rclpy.create_node("room_thermostat")
    target = node.declare_parameter("target", 20.0, between(5.0, 30.0))
    margin = node.declare_parameter("margin", 0.5, between(0.0, 5.0))
    publisher = node.create_publisher(Bool, "heater", 10)
    heating = False

    def on_temperature(message):
        nonlocal heating, target, margin
        target, margin = node.get_parameters(["target", "margin"])
        if heating:
            heating = not message.data >= target.value
        else:
            heating = message.data < target.value - margin.value
        publisher.publish(Bool(data=heating))

    node.create_subscription(Float64, "temperature", on_temperature, 10)
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == "__main__":
    main()
