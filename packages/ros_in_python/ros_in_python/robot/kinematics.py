"""Where a robot's links are when its joints have given positions."""

from __future__ import annotations

import math
from collections.abc import Mapping

from tf2_py.rigid_motion import RigidMotion

from ros_in_python.robot.urdf import Joint, RobotDescription


def all_positions(robot: RobotDescription, known: Mapping[str, float]) -> dict[str, float]:
    """Return the position (rad or m) of each moving joint that is given, and of each that mimics one of these."""
    positions = {joint.name: known[joint.name] for joint in robot.joints if joint.moves and joint.name in known}
    for joint in robot.joints:
        if joint.mimic and joint.mimic.joint in known:
            positions[joint.name] = joint.mimic.follow(known[joint.mimic.joint])
    return positions


def motion(joint: Joint, position: float) -> RigidMotion:
    """Return where the child link is in the parent link at a joint's position (rad or m)."""
    length = math.hypot(*joint.axis) or 1.0
    x, y, z = (component / length for component in joint.axis)
    if joint.kind == "prismatic":
        own = RigidMotion((x * position, y * position, z * position), (0.0, 0.0, 0.0, 1.0))
    elif joint.moves:
        sine = math.sin(position / 2)
        own = RigidMotion((0.0, 0.0, 0.0), (x * sine, y * sine, z * sine, math.cos(position / 2)))
    else:
        return joint.origin
    return own.then(joint.origin)


def link_motions(robot: RobotDescription, positions: Mapping[str, float]) -> dict[str, RigidMotion]:
    """Return where every link is in the root link; joints that are not given are at rest."""
    everywhere = all_positions(robot, {joint.name: joint.rest for joint in robot.joints} | dict(positions))
    below: dict[str, list[Joint]] = {}
    for joint in robot.joints:
        below.setdefault(joint.parent, []).append(joint)
    placed = {robot.root: RigidMotion((0.0, 0.0, 0.0), (0.0, 0.0, 0.0, 1.0))}
    waiting = [robot.root]
    while waiting:
        link = waiting.pop()
        for joint in below.get(link, []):
            placed[joint.child] = motion(joint, everywhere.get(joint.name, 0.0)).then(placed[link])
            waiting.append(joint.child)
    return placed
