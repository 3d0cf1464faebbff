"""Ready-made worlds: a turtle in its square, and a chain of joints."""

from __future__ import annotations

import math
from typing import Any

from grader.recording.events import Fields

#: The width and height of turtlesim's square (units), and how long a turtle follows a command (s).
SIDE, COMMAND_HOLDS = 11.088889, 1.0

TWIST, POSE, JOINT_STATE = "geometry_msgs/msg/Twist", "turtlesim/msg/Pose", "sensor_msgs/msg/JointState"


class Turtle:
    """A turtle of turtlesim: reads `NAME/cmd_vel`, publishes `NAME/pose`.

    The arithmetic is turtlesim's: the new heading before the new position, commands that hold for one second, walls
    that clamp. It computes a step at once; if exact ticks matter, choose turtlesim's period of 16 ms for the world.
    Units are turtlesim's, headings are in rad.
    """

    def __init__(
        self, x: float = SIDE / 2, y: float = SIDE / 2, theta: float = 0.0, name: str = "turtle1", pose: str = POSE
    ) -> None:
        """Begin here. `pose` is the type of the pose; geometry_msgs/msg/Pose2D does without velocities."""
        self.reads, self.publishes = {f"/{name}/cmd_vel": TWIST}, {f"/{name}/pose": pose}
        self.x, self.y, self.theta = x, y, theta
        self._forward = self._left = self._turn = 0.0
        self._age = math.inf
        self._velocities = pose == POSE

    def hear(self, topic: str, message: Any) -> None:
        """Take a command. As in turtlesim, an infinite turn leaves no heading: nan."""
        self._forward, self._left, self._age = message.linear.x, message.linear.y, 0.0
        self._turn = message.angular.z if math.isfinite(message.angular.z) else math.nan

    def step(self, seconds: float) -> None:
        """Move on."""
        self._age += seconds
        if self._age > COMMAND_HOLDS:
            self._forward = self._left = self._turn = 0.0
        self.theta = math.remainder(self.theta + self._turn * seconds, 2 * math.pi)
        forward, left = self._forward * seconds, self._left * seconds
        self.x += math.cos(self.theta) * forward - math.sin(self.theta) * left
        self.y += math.sin(self.theta) * forward + math.cos(self.theta) * left
        self.x, self.y = min(max(self.x, 0.0), SIDE), min(max(self.y, 0.0), SIDE)

    def state(self) -> dict[str, Fields]:
        """Return the pose."""
        fields: Fields = {"x": self.x, "y": self.y, "theta": self.theta}
        if self._velocities:
            fields |= {"linear_velocity": self._forward, "angular_velocity": self._turn}
        return dict.fromkeys(self.publishes, fields)


class JointChain:
    """Joints that go to commanded positions at limited speeds: reads and publishes JointState messages.

    Positions are in rad, speeds in rad/s. A command may name some of the joints; names that are not in the chain, and
    positions that are not finite, are ignored. A command with velocities and without positions moves at these.
    """

    def __init__(
        self,
        joints: dict[str, float],
        commands: str = "/joint_commands",
        states: str = "/joint_states",
        fastest: float = 2.0,
    ) -> None:
        """Begin with these positions."""
        self.reads, self.publishes = {commands: JOINT_STATE}, {states: JOINT_STATE}
        self._positions = dict(joints)
        self._velocities = dict.fromkeys(joints, 0.0)
        self._targets: dict[str, float] = {}
        self._wanted: dict[str, float] = {}
        self._fastest = fastest
        self._states = states

    def hear(self, topic: str, message: Any) -> None:
        """Take a command."""
        for index, name in enumerate(message.name):
            if name not in self._positions:
                continue
            if index < len(message.position) and math.isfinite(message.position[index]):
                self._targets[name] = message.position[index]
                self._wanted.pop(name, None)
            elif index < len(message.velocity) and math.isfinite(message.velocity[index]):
                self._wanted[name] = message.velocity[index]
                self._targets.pop(name, None)

    def step(self, seconds: float) -> None:
        """Move on."""
        for name, position in self._positions.items():
            commanded = self._wanted.get(name, 0.0)
            if name in self._targets:
                commanded = (self._targets[name] - position) / seconds
            velocity = min(max(commanded, -self._fastest), self._fastest)
            self._positions[name], self._velocities[name] = position + velocity * seconds, velocity

    def state(self) -> dict[str, Fields]:
        """Return positions and velocities, without a stamp."""
        return {
            self._states: {
                "name": list(self._positions),
                "position": list(self._positions.values()),
                "velocity": list(self._velocities.values()),
            }
        }
