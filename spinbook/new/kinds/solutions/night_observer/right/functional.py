"""Without a class: closures."""

import rclpy
from rclpy.action import ActionClient
from rclpy.executors import ExternalShutdownException
from std_msgs.msg import Empty, Float32
from turtlesim.action import RotateAbsolute

SUCCEEDED = 4


def main():
    rclpy.init()
    node = rclpy.create_node("night_observer")
    client = ActionClient(node, RotateAbsolute, "turn")
    photo = node.create_publisher(Float32, "photo", 10)
    missed = node.create_publisher(Float32, "missed", 10)
    waiting, current = [], {}

    def go_on():
        if waiting and not current and client.server_is_ready():
            star = current["star"] = waiting.pop(0)
            client.send_goal_async(RotateAbsolute.Goal(theta=star)).add_done_callback(on_response)

    def finish(publisher):
        publisher.publish(Float32(data=current["star"]))
        current.clear()
        go_on()

    def on_response(future):
        handle = future.result()
        if handle.accepted:
            current["handle"] = handle
            handle.get_result_async().add_done_callback(on_result)
        else:
            finish(missed)

    def on_result(future):
        finish(photo if future.result().status == SUCCEEDED else missed)

    def on_star(message):
        waiting.append(message.data)
        go_on()

    def on_clouds(_):
        if "handle" in current:
            current["handle"].cancel_goal_async()

    node.create_subscription(Float32, "star", on_star, 10)
    node.create_subscription(Empty, "clouds", on_clouds, 10)
    node.create_timer(0.5, go_on)
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == "__main__":
    main()
