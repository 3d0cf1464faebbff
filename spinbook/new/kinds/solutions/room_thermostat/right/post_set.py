"""A switch of its own, whose numbers a post-set callback renews once they have changed."""

import rclpy
from rcl_interfaces.msg import SetParametersResult
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from std_msgs.msg import Bool, Float64


class Switch:
    def __init__(self, target, margin):
        self.target, self.margin, self.on = target, margin, False

    def heard(self, temperature):
        if temperature >= self.target:
            self.on = False
        if temperature < self.target - self.margin:
            self.on = True
        return self.on


class RoomThermostat(Node):
    ALLOWED = {
        "target": lambda value: 5 <= value <= 30,
        "margin": lambda value: 0 <= value <= 5,
    }

    def __init__(self):
        super().__init__("room_thermostat")
        self.add_on_set_parameters_callback(self.judge)
        target, margin = (p.value for p in self.declare_parameters("", [("target", 20.0), ("margin", 0.5)]))
        self.switch = Switch(target, margin)
        self.add_post_set_parameters_callback(self.renew)
        self.publisher = self.create_publisher(Bool, "/heater", 10)
        self.create_subscription(
            Float64, "/temperature", lambda m: self.publisher.publish(Bool(data=self.switch.heard(m.data))), 10
        )

    def judge(self, parameters):
        wrong = [p.name for p in parameters if p.name in self.ALLOWED and not self.ALLOWED[p.name](p.value)]
        return SetParametersResult(successful=not wrong, reason=f"not allowed: {', '.join(wrong)}" if wrong else "")

    def renew(self, parameters):
        for parameter in parameters:
            if parameter.name in self.ALLOWED:
                setattr(self.switch, parameter.name, parameter.value)


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
