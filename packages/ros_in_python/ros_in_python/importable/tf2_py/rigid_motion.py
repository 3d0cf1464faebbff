"""A rotation and a translation, as plain numbers: fast enough for thousands of lookups a second.

Quaternions are (x, y, z, w), as in geometry_msgs. Formulas: J. Diebel, "Representing Attitude: Euler Angles, Unit
Quaternions, and Rotation Vectors", 2006, sections 5.4 and 6.
"""

from __future__ import annotations

import math
from typing import NamedTuple, TypeAlias

Vector: TypeAlias = tuple[float, float, float]
Quaternion: TypeAlias = tuple[float, float, float, float]

#: Beyond this cosine, two rotations are so close that a straight line between them is exact enough.
_NEARLY_EQUAL = 0.9995


class RigidMotion(NamedTuple):
    """Where a frame is in another: its origin (m) and its rotation."""

    translation: Vector
    rotation: Quaternion

    def then(self, outer: RigidMotion) -> RigidMotion:
        """Return this motion seen from one frame further out, in which `outer` is where our frame is."""
        return RigidMotion(outer.moved(self.translation), multiply(outer.rotation, self.rotation))

    def moved(self, point: Vector) -> Vector:
        """Return where a point of the inner frame is in the outer one."""
        x, y, z = rotate(self.rotation, point)
        a, b, c = self.translation
        return (x + a, y + b, z + c)

    def inverse(self) -> RigidMotion:
        """Return where the outer frame is in the inner one."""
        back = conjugate(self.rotation)
        x, y, z = rotate(back, self.translation)
        return RigidMotion((-x, -y, -z), back)


IDENTITY = RigidMotion((0.0, 0.0, 0.0), (0.0, 0.0, 0.0, 1.0))


def multiply(first: Quaternion, second: Quaternion) -> Quaternion:
    """Return the rotation `second`, followed by `first`."""
    ax, ay, az, aw = first
    bx, by, bz, bw = second
    return (
        aw * bx + ax * bw + ay * bz - az * by,
        aw * by - ax * bz + ay * bw + az * bx,
        aw * bz + ax * by - ay * bx + az * bw,
        aw * bw - ax * bx - ay * by - az * bz,
    )


def conjugate(rotation: Quaternion) -> Quaternion:
    """Return the opposite rotation of a unit quaternion."""
    x, y, z, w = rotation
    return (-x, -y, -z, w)


def rotate(rotation: Quaternion, vector: Vector) -> Vector:
    """Return a vector after a rotation."""
    x, y, z, w = rotation
    a, b, c = vector
    # The cross product of the rotation's axis and the vector, twice: half the work of two quaternion products.
    p, q, r = 2.0 * (y * c - z * b), 2.0 * (z * a - x * c), 2.0 * (x * b - y * a)
    return (a + w * p + y * r - z * q, b + w * q + z * p - x * r, c + w * r + x * q - y * p)


def normalized(rotation: Quaternion) -> Quaternion:
    """Return a quaternion of length 1."""
    x, y, z, w = rotation
    length = math.sqrt(x * x + y * y + z * z + w * w)
    return (x / length, y / length, z / length, w / length)


def between(first: RigidMotion, second: RigidMotion, ratio: float) -> RigidMotion:
    """Return the motion at `ratio` (0 to 1) of the way, at a constant speed, turning the shorter way round."""
    (ax, ay, az), (bx, by, bz) = first.translation, second.translation
    translation = (ax + ratio * (bx - ax), ay + ratio * (by - ay), az + ratio * (bz - az))
    return RigidMotion(translation, _turned(first.rotation, second.rotation, ratio))


def _turned(first: Quaternion, second: Quaternion, ratio: float) -> Quaternion:
    ax, ay, az, aw = first
    bx, by, bz, bw = second
    cosine = ax * bx + ay * by + az * bz + aw * bw
    one, other = 1.0 - ratio, ratio
    if abs(cosine) <= _NEARLY_EQUAL:
        angle = math.acos(abs(cosine))
        one, other = math.sin(one * angle) / math.sin(angle), math.sin(other * angle) / math.sin(angle)
    if cosine < 0.0:
        other = -other
    return normalized((one * ax + other * bx, one * ay + other * by, one * az + other * bz, one * aw + other * bw))


def from_euler(roll: float, pitch: float, yaw: float) -> Quaternion:
    """Return the rotation by these angles (rad) about the fixed axes x, y and z, in this order."""
    sr, cr = math.sin(roll / 2), math.cos(roll / 2)
    sp, cp = math.sin(pitch / 2), math.cos(pitch / 2)
    sy, cy = math.sin(yaw / 2), math.cos(yaw / 2)
    return (
        sr * cp * cy - cr * sp * sy,
        cr * sp * cy + sr * cp * sy,
        cr * cp * sy - sr * sp * cy,
        cr * cp * cy + sr * sp * sy,
    )


def to_euler(rotation: Quaternion) -> Vector:
    """Return roll, pitch and yaw (rad) of a rotation: the inverse of `from_euler`."""
    x, y, z, w = rotation
    roll = math.atan2(2 * (w * x + y * z), 1 - 2 * (x * x + y * y))
    pitch = math.asin(max(-1.0, min(1.0, 2 * (w * y - z * x))))
    yaw = math.atan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z))
    return (roll, pitch, yaw)


def matrix(rotation: Quaternion) -> tuple[Vector, Vector, Vector]:
    """Return a rotation as the rows of a 3 by 3 matrix."""
    columns = [rotate(rotation, axis) for axis in ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))]
    first, second, third = zip(*columns, strict=True)
    return (first, second, third)
