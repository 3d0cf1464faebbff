"""Switches the heater off between target and margin, instead of leaving it as it was.

Caught by:
- test_switches_the_heater
"""

import rclpy
from rcl_interfaces.msg import SetParametersResult
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from std_msgs.msg import Bool, Float64

LOWEST, HIGHEST = 5.0, 30.0  # degrees Celsius, of the target
WIDEST = 5.0  # degrees Celsius, of the margin


class RoomThermostat(Node):
    """Receives temperatures and switches the heater."""

    def __init__(self):
        super().__init__("room_thermostat")
        self.publisher = self.create_publisher(Bool, "/heater", 10)
        self.create_subscription(Float64, "/temperature", self.on_temperature, 10)
        self.heating = False
        self.add_on_set_parameters_callback(self.on_set)
        self.declare_parameter("target", 20.0)
        self.declare_parameter("margin", 0.5)

    def on_set(self, parameters):
        """Called before parameters change. Returns whether they may."""
        for parameter in parameters:
            if parameter.name == "target" and not LOWEST <= parameter.value <= HIGHEST:
                return SetParametersResult(successful=False, reason="target must be from 5 to 30")
            if parameter.name == "margin" and not 0.0 <= parameter.value <= WIDEST:
                return SetParametersResult(successful=False, reason="margin must be from 0 to 5")
        return SetParametersResult(successful=True)

    def on_temperature(self, message):
        """Called once for each temperature."""
        target = self.get_parameter("target").value
        margin = self.get_parameter("margin").value
        self.heating = message.data < target - margin
        self.publisher.publish(Bool(data=self.heating))


def main():
    rclpy.init()
    node = RoomThermostat()
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == "__main__":
    main()
