"""Without a class: closures and a dictionary."""

import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.qos import QoSDurabilityPolicy, QoSHistoryPolicy, QoSProfile, QoSReliabilityPolicy
from std_msgs.msg import Int32, String

LATCHED = QoSProfile(
    history=QoSHistoryPolicy.KEEP_LAST,
    depth=1,
    reliability=QoSReliabilityPolicy.RELIABLE,
    durability=QoSDurabilityPolicy.TRANSIENT_LOCAL,
)


def main():
    rclpy.init()
    node = rclpy.create_node("departure_board")
    board = node.create_publisher(String, "board", LATCHED)
    known = {"delay": 0}

    def show():
        if "destination" in known:
            text = known["destination"]
            if known["delay"] > 0:
                text += f", {known['delay']} min late"
            board.publish(String(data=text))

    def on_destination(message):
        known["destination"] = message.data
        show()

    def on_delay(message):
        if message.data != known["delay"]:
            known["delay"] = message.data
            show()

    node.create_subscription(String, "destination", on_destination, LATCHED)
    node.create_subscription(Int32, "delay", on_delay, 10)
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == "__main__":
    main()
