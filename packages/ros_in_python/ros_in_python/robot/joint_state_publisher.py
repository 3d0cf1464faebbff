"""joint_state_publisher: sends the positions of a robot's joints, at rest or as other nodes give them.

    ros2 run joint_state_publisher joint_state_publisher robot.urdf

Topics and parameters are those of ROS 2 Jazzy: https://docs.ros.org/en/jazzy/p/joint_state_publisher/
"""

from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from rclpy.node import Node
from rclpy.parameter import Parameter
from rclpy.qos import DurabilityPolicy, QoSProfile
from rclpy.utilities import remove_ros_args
from sensor_msgs.msg import JointState
from std_msgs.msg import String

from ros_in_python.robot.urdf import InvalidUrdf, Joint, read
from ros_in_python.spinning import spin_until_stopped


class JointStatePublisher(Node):
    """Publishes /joint_states at `rate` (10 Hz), once it has a URDF: from a file, or from /robot_description."""

    def __init__(self, description: str = "") -> None:
        super().__init__("joint_state_publisher")
        self._log = Node.get_logger(self)
        self.declare_parameter("rate", 10)
        self.declare_parameter("source_list", Parameter.Type.STRING_ARRAY)
        self._joints: list[Joint] = []
        self._positions: dict[str, float] = {}
        if description:
            self._use(description)
        else:
            latched = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
            self.create_subscription(String, "robot_description", self._on_description, latched)
            self._log.info("Waiting for robot_description to be published on the robot_description topic...")
        for topic in self.get_parameter_or("source_list", Parameter("source_list", value=[])).value or []:
            self.create_subscription(JointState, topic, self._on_source, 10)
        self._publisher = self.create_publisher(JointState, "joint_states", 5)
        self.create_timer(1.0 / self.get_parameter("rate").value, self._publish)

    def _on_description(self, message: Any) -> None:
        try:
            self._use(message.data)
        except InvalidUrdf as error:
            self._log.error(str(error))

    def _use(self, text: str) -> None:
        self._joints = [joint for joint in read(text).joints if joint.moves]
        self._positions = {joint.name: joint.rest for joint in self._joints if joint.mimic is None}

    def _on_source(self, state: Any) -> None:
        known = zip(state.name, state.position, strict=False)
        self._positions.update({name: value for name, value in known if name in self._positions})

    def _publish(self) -> None:
        if not self._joints:
            return
        message = JointState()
        message.header.stamp = self.get_clock().now().to_msg()
        message.name = [joint.name for joint in self._joints]
        message.position = [self._position(joint) for joint in self._joints]
        self._publisher.publish(message)

    def _position(self, joint: Joint) -> float:
        if joint.mimic is None:
            return self._positions[joint.name]
        return joint.mimic.follow(self._positions.get(joint.mimic.joint, 0.0))


def main(words: Sequence[str]) -> int:
    """Run the node; a word is the name of a URDF file. Return the exit code."""
    files = remove_ros_args(list(words))
    try:
        description = Path(files[0]).read_text(encoding="utf-8") if files else ""
        return spin_until_stopped(lambda: JointStatePublisher(description))
    except InvalidUrdf as error:
        print(f"joint_state_publisher: {files[0]}: {error}", file=sys.stderr)
    except OSError as error:
        print(f"joint_state_publisher: {error.filename}: {error.strerror}", file=sys.stderr)
    return 1


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
