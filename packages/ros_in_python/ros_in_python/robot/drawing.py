"""What a robot looks like and how its joints move, as data for the two painters: robot_view.js and still.py."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from tf2_py.rigid_motion import RigidMotion, Vector

from ros_in_python.robot.kinematics import all_positions, link_motions
from ros_in_python.robot.urdf import Joint, LinkShape, RobotDescription

#: The media type of this data.
KIND = "application/vnd.spinbook.robot+json"
#: The colour of shapes for which the URDF names none, and of the bones of a robot without shapes.
_SHELL: Vector = (0.93, 0.92, 0.89)
#: Half the thickness of such a bone, as a part of the longest one.
_BONE = 0.06


@dataclass(frozen=True)
class RobotMotion:
    """Positions (rad or m) of joints by name, one for each of `times` (s, from 0)."""

    times: tuple[float, ...] = ()
    positions: Mapping[str, tuple[float, ...]] | None = None

    @property
    def last(self) -> dict[str, float]:
        """Where the joints are in the end."""
        return {name: values[-1] for name, values in (self.positions or {}).items()}


def shapes_of(robot: RobotDescription) -> list[LinkShape]:
    """Return the shapes that can be drawn; for a robot without any, a ball for each link and a bone to the next."""
    drawn = [shape for shape in robot.shapes if max(shape.half) > 0]
    return drawn or [_ball(link, robot) for link in robot.links] + _bones(robot)


def _ball(link: str, robot: RobotDescription) -> LinkShape:
    radius = 1.6 * _thickness(robot)
    return LinkShape(link, "sphere", (radius, radius, radius))


def _bones(robot: RobotDescription) -> list[LinkShape]:
    """Return a cylinder from each link's origin to each of its joints."""
    half, bones = _thickness(robot), []
    for joint in robot.joints:
        x, y, z = joint.origin.translation
        if length := math.hypot(x, y, z):
            middle = RigidMotion((x / 2, y / 2, z / 2), _turn_to(x / length, y / length, z / length))
            bones.append(LinkShape(joint.parent, "cylinder", (half, half, length / 2), middle))
    return bones


def _thickness(robot: RobotDescription) -> float:
    lengths = [math.hypot(*joint.origin.translation) for joint in robot.joints]
    return _BONE * (max(lengths, default=0.0) or 1.0)


def _turn_to(x: float, y: float, z: float) -> tuple[float, float, float, float]:
    """Return the rotation that turns the z axis to this direction, a unit vector."""
    if z < -0.9999:
        return (1.0, 0.0, 0.0, 0.0)
    w = math.sqrt((1.0 + z) / 2)
    return (-y / (2 * w), x / (2 * w), 0.0, w)


def outside(robot: RobotDescription, positions: Mapping[str, float]) -> list[Joint]:
    """Return the joints that these positions take beyond their limits."""
    known = all_positions(robot, positions)
    return [j for j in robot.joints if j.is_limited and j.name in known and not j.lower <= known[j.name] <= j.upper]


def in_words(robot: RobotDescription, positions: Mapping[str, float]) -> str:
    """Return each joint's position, for readers who can't see the picture: `left elbow 1.20 rad`."""
    beyond = {joint.name for joint in outside(robot, positions)}
    known = all_positions(robot, positions)
    words = [_joint_words(j, known[j.name], j.name in beyond) for j in robot.joints if j.name in known]
    hidden = sum(shape.kind == "mesh" for shape in robot.shapes)
    meshes = f" Not drawn: {hidden} mesh{'es' if hidden > 1 else ''}." if hidden else ""
    return f"The robot {robot.name}: {', '.join(words) or 'no joint has moved'}.{meshes}"


def _joint_words(joint: Joint, position: float, beyond: bool) -> str:
    unit = "m" if joint.kind == "prismatic" else "rad"
    limits = f" (beyond its limits, {joint.lower:.2f} to {joint.upper:.2f})" if beyond else ""
    return f"{joint.name.replace('_', ' ')} {position:.2f} {unit}{limits}".replace("-", "−")


def as_data(robot: RobotDescription, motion: RobotMotion) -> dict[str, Any]:
    """Return what robot_view.js needs. Joints and shapes name links by number; the root is 0."""
    # Parents come before their children.
    number = {link: index for index, link in enumerate(link_motions(robot, {}))}
    return {
        "name": robot.name,
        "joints": [_joint(joint, number) for joint in sorted(robot.joints, key=lambda joint: number[joint.child])],
        "shapes": [_shape(shape, number) for shape in shapes_of(robot)],
        "times": _short(motion.times),
        # Nobody sees a thousandth of a radian.
        "positions": {name: _short(values, 3) for name, values in (motion.positions or {}).items()},
        "words": in_words(robot, motion.last),
    }


def _joint(joint: Joint, number: Mapping[str, int]) -> dict[str, Any]:
    about = {
        "name": joint.name,
        "kind": joint.kind,
        "parent": number[joint.parent],
        "child": number[joint.child],
        "origin": _short((*joint.origin.translation, *joint.origin.rotation)),
        "axis": _short(joint.axis),
        "rest": _short([joint.rest])[0],
    }
    about |= {"limits": _short([joint.lower, joint.upper])} if joint.is_limited else {}
    return about | ({"mimic": [joint.mimic.joint, joint.mimic.multiplier, joint.mimic.offset]} if joint.mimic else {})


def _shape(shape: LinkShape, number: Mapping[str, int]) -> list[Any]:
    where = _short((*shape.origin.translation, *shape.origin.rotation))
    return [number[shape.link], shape.kind, _short(shape.half), where, _short(shape.colour or _SHELL)]


def _short(values: Sequence[float], digits: int = 4) -> list[float]:
    return [int(value) if value == int(value) else value for value in (round(value, digits) for value in values)]
