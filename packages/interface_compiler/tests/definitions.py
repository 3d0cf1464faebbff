"""Definitions for tests, made from plain text."""

from __future__ import annotations

from pathlib import Path

from interface_compiler.definition import Definition


def definition(path: str, text: str, package: str = "robot_interfaces") -> Definition:
    """Return a definition at `interfaces/PACKAGE/PATH`."""
    kind, _, name = path.partition("/")
    return Definition(package, kind, name.rpartition(".")[0], text, Path("interfaces", package, path))


LIMITS = """\
# The limits of one joint.
uint8 REVOLUTE=0
uint8 PRISMATIC=1
std_msgs/Header header
string<=32 name
uint8 kind 1
float64 lower -1.57
float64 upper 1.57
float64[3] axis [0.0, 0.0, 1.0]
float64[<=8] samples
geometry_msgs/Pose[] poses
wstring label "Gelenk ä"
"""
GET_LIMITS = "string[] names\n---\nJointLimits[] limits\nbool success\n"
MOVE_JOINT = """\
string name
float64 position
builtin_interfaces/Duration duration
---
bool reached
JointLimits limits
---
float64 position
"""


def robot() -> list[Definition]:
    """Return a package with a message, a service and an action, and every kind of field."""
    return [
        definition("msg/JointLimits.msg", LIMITS),
        definition("srv/GetLimits.srv", GET_LIMITS),
        definition("action/MoveJoint.action", MOVE_JOINT),
    ]
