"""robot_state_publisher: sends a robot's frames, from its URDF and its joints' positions.

    ros2 run robot_state_publisher robot_state_publisher --ros-args -p robot_description:="$(cat robot.urdf)"

Topics and parameters are those of ROS 2 Jazzy: https://docs.ros.org/en/jazzy/p/robot_state_publisher/
"""

from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from geometry_msgs.msg import TransformStamped
from rcl_interfaces.msg import SetParametersResult
from rclpy.node import Node
from rclpy.parameter import Parameter
from rclpy.qos import DurabilityPolicy, QoSProfile, qos_profile_sensor_data
from rclpy.time import Time
from rclpy.utilities import remove_ros_args
from sensor_msgs.msg import JointState
from std_msgs.msg import String
from tf2_py.rigid_motion import RigidMotion

from ros_in_python.robot.kinematics import all_positions, motion
from ros_in_python.robot.urdf import InvalidUrdf, RobotDescription, read
from ros_in_python.spinning import spin_until_stopped

#: How often a joint's frame is sent at most, unless `publish_frequency` says otherwise (Hz).
RATE = 20.0


class RobotStatePublisher(Node):
    """Publishes /robot_description, fixed joints on /tf_static, and moving ones on /tf when /joint_states comes."""

    def __init__(self, description: str = "") -> None:
        from tf2_ros import StaticTransformBroadcaster, TransformBroadcaster

        super().__init__("robot_state_publisher")
        self._log = Node.get_logger(self)
        urdf = self.declare_parameter("robot_description", description).value or description
        self.declare_parameter("publish_frequency", RATE)
        self.declare_parameter("ignore_timestamp", False)
        self.declare_parameter("frame_prefix", "")
        self._moving, self._fixed = TransformBroadcaster(self), StaticTransformBroadcaster(self)
        latched = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
        self._description = self.create_publisher(String, "robot_description", latched)
        self._sent: dict[str, int] = {}
        self._newest_state = 0
        self._use(urdf)
        self.create_subscription(JointState, "joint_states", self._on_joint_states, qos_profile_sensor_data)
        self.add_on_set_parameters_callback(self._on_parameters)
        self._log.info("Robot initialized")

    def _use(self, text: str) -> None:
        self._robot: RobotDescription = read(text)
        self._joints = {joint.name: joint for joint in self._robot.joints}
        self._description.publish(String(data=text))
        now = self.get_clock().now()
        self._fixed.sendTransform(
            [self._transform(joint.name, joint.origin, now) for joint in self._robot.joints if not joint.moves]
        )

    def _on_parameters(self, changes: Sequence[Parameter]) -> SetParametersResult:
        for change in changes:
            if change.name == "robot_description":
                try:
                    self._use(change.value)
                except InvalidUrdf as error:
                    return SetParametersResult(successful=False, reason=str(error))
        return SetParametersResult(successful=True)

    def _on_joint_states(self, state: Any) -> None:
        if len(state.position) != len(state.name):
            if state.position:
                count = f"{len(state.name)} names and {len(state.position)} positions"
                self._log.error(f"Robot state publisher ignored an invalid JointState: {count}")
            return
        time = Time.from_msg(state.header.stamp)
        at = time.nanoseconds
        if at < self._newest_state:
            self._sent.clear()  # time went back: a bag was started again
        self._newest_state = at
        if not self._is_due(state.name, at):
            return
        self._sent.update(dict.fromkeys(state.name, at))
        positions = all_positions(self._robot, dict(zip(state.name, state.position, strict=True)))
        self._moving.sendTransform(
            [self._transform(name, motion(self._joints[name], value), time) for name, value in positions.items()]
        )

    def _is_due(self, names: Sequence[str], at: int) -> bool:
        if self.get_parameter("ignore_timestamp").value:
            return True
        period = 1e9 / self.get_parameter("publish_frequency").value
        return min((self._sent.get(name, 0) for name in names), default=at) + period <= at or not self._sent

    def _transform(self, joint: str, where: RigidMotion, time: Time) -> TransformStamped:
        prefix = self.get_parameter("frame_prefix").value
        message = TransformStamped(child_frame_id=prefix + self._joints[joint].child)
        message.header.frame_id, message.header.stamp = prefix + self._joints[joint].parent, time.to_msg()
        move, turn = message.transform.translation, message.transform.rotation
        move.x, move.y, move.z = where.translation
        turn.x, turn.y, turn.z, turn.w = where.rotation
        return message


def main(words: Sequence[str]) -> int:
    """Run the node; a word is the name of a URDF file. Return the exit code."""
    files = remove_ros_args(list(words))
    try:
        description = Path(files[0]).read_text(encoding="utf-8") if files else ""
        return spin_until_stopped(lambda: RobotStatePublisher(description))
    except InvalidUrdf as error:
        fix = 'Give one: --ros-args -p robot_description:="$(cat robot.urdf)", or a file\'s name.'
        print(f"robot_state_publisher: {error}. {fix}", file=sys.stderr)
    except OSError as error:
        print(f"robot_state_publisher: {error.filename}: {error.strerror}", file=sys.stderr)
    return 1


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
