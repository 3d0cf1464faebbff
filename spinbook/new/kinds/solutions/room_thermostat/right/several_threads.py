"""Several threads: parameters may change while a temperature is handled."""

import threading

import rclpy
from rcl_interfaces.msg import SetParametersResult
from rclpy.executors import ExternalShutdownException, MultiThreadedExecutor
from rclpy.node import Node
from std_msgs.msg import Bool, Float64


class RoomThermostat(Node):
    def __init__(self):
        super().__init__("room_thermostat")
        self.lock = threading.Lock()
        self.heating = False
        self.add_on_set_parameters_callback(self.on_set)
        self.declare_parameter("target", 20.0)
        self.declare_parameter("margin", 0.5)
        self.publisher = self.create_publisher(Bool, "/heater", 10)
        self.create_subscription(Float64, "/temperature", self.on_temperature, 10)

    def on_set(self, parameters):
        for parameter in parameters:
            if parameter.name == "target" and not 5.0 <= parameter.value <= 30.0:
                return SetParametersResult(successful=False, reason="5 to 30")
            if parameter.name == "margin" and not 0.0 <= parameter.value <= 5.0:
                return SetParametersResult(successful=False, reason="0 to 5")
        return SetParametersResult(successful=True)

    def on_temperature(self, message):
        target = self.get_parameter("target").get_parameter_value().double_value
        margin = self.get_parameter("margin").get_parameter_value().double_value
        with self.lock:
            if message.data >= target or message.data < target - margin:
                self.heating = message.data < target
            self.publisher.publish(Bool(data=self.heating))


def main():
    rclpy.init()
    node = RoomThermostat()
    executor = MultiThreadedExecutor(num_threads=3)
    executor.add_node(node)
    try:
        executor.spin()
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        rclpy.try_shutdown()


if __name__ == "__main__":
    main()
