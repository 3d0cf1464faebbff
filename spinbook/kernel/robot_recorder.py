"""Records how a robot moves and prints it, one JSON array per line, in its own process next to the kernel.

    python -m spinbook.kernel.robot_recorder

Lines are those of `%plot` for the positions on /joint_states and /joint_commands, and ["description", URDF] for each
message on /robot_description.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from rclpy.context import Context
from rclpy.qos import DurabilityPolicy, QoSProfile
from std_msgs.msg import String

from spinbook.kernel.plot.recorder import PlotRecorder, record_until_stopped
from spinbook.kernel.plot.recording import PlotRecording
from spinbook.kernel.recorder_lines import write_line

#: Where positions of joints come from. What joints do counts more than what they are told to do.
TOPICS = ("/joint_states", "/joint_commands")
#: How long to wait for the first position (s): a robot may stand still.
APPEAR_S = 3.0
_NO_DESCRIPTION = (
    "No /robot_description has arrived. Start a node that publishes it, transient local, or name a package or a file: "
    "%robot humanoid_description"
)


class RobotRecorder(PlotRecorder):
    """Subscribes to positions of joints and to the robot's description, which may have been published before."""

    def __init__(self, write: Callable[..., None] = write_line, context: Context | None = None) -> None:
        super().__init__([f"{topic}/position" for topic in TOPICS], write, context)
        latched = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
        self.create_subscription(String, "/robot_description", self._on_description, latched)

    def _on_description(self, message: Any) -> None:
        self._write("description", message.data)


@dataclass
class RobotRecording(PlotRecording):
    """The robot's URDF, "" until one has arrived, and its joints' positions."""

    description: str = ""

    def note(self, kind: str, *values: Any) -> None:
        """Add one line of the recorder: its kind and values."""
        if kind == "description":
            self.description = values[0]
        else:
            super().note(kind, *values)

    @property
    def problem(self) -> str:
        """Why there is no robot to show; "" if there is one."""
        return self.error or ("" if self.description else _NO_DESCRIPTION)

    def positions(self) -> dict[str, tuple[list[float], list[float]]]:
        """Return each joint's times and positions, from the first of `TOPICS` on which any have arrived."""
        by_topic: dict[str, dict[str, tuple[list[float], list[float]]]] = {topic: {} for topic in TOPICS}
        for curve in self.curves.values():
            by_topic[curve.quantity.topic][curve.quantity.label] = (curve.times, curve.values)
        return next(filter(None, by_topic.values()), {})


if __name__ == "__main__":
    record_until_stopped(RobotRecorder)
