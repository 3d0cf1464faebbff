"""Without a class: closures, and partial for the done-callback."""

from functools import partial

import rclpy
from rclpy.executors import ExternalShutdownException
from std_msgs.msg import Bool, Float64, String
from std_srvs.srv import SetBool


def main():
    rclpy.init()
    node = rclpy.create_node("fire_watch")
    client = node.create_client(SetBool, "sprinkler")
    siren = node.create_publisher(Bool, "siren", 10)
    report = node.create_publisher(String, "report", 10)
    state = {"fire": False, "asked": False}

    def on_response(wanted, future):
        answer = future.result()
        if not answer.success:
            report.publish(String(data="failed: " + answer.message))
        else:
            report.publish(String(data="sprinkler on" if wanted else "sprinkler off"))

    def ask():
        if state["fire"] == state["asked"] or not client.wait_for_service(timeout_sec=0.0):
            return
        state["asked"] = state["fire"]
        future = client.call_async(SetBool.Request(data=state["asked"]))
        future.add_done_callback(partial(on_response, state["asked"]))

    def on_smoke(message):
        state["fire"] = message.data > 0.3
        ask()

    def on_timer():
        siren.publish(Bool(data=state["fire"]))
        ask()

    node.create_subscription(Float64, "smoke", on_smoke, 10)
    node.create_timer(0.2, on_timer)
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == "__main__":
    main()
