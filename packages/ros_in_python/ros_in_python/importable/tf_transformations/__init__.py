"""tf_transformations without a ROS installation: rotations as quaternions (x, y, z, w), Euler angles and 4×4 matrices.

Angles are in rad. `axes` says how Euler angles follow one another: `s` (about fixed axes) or `r` (about those that turn
along), then the three axes. Quaternions: https://en.wikipedia.org/wiki/Quaternions_and_spatial_rotation
"""

from __future__ import annotations

import math
from functools import reduce
from typing import Any

import numpy as np
from tf2_py import rigid_motion


def identity_matrix() -> Any:
    """Return the matrix that moves nothing."""
    return np.identity(4)


def translation_matrix(direction: Any) -> Any:
    """Return the matrix that moves by a vector."""
    matrix = np.identity(4)
    matrix[:3, 3] = np.asarray(direction)[:3]
    return matrix


def translation_from_matrix(matrix: Any) -> Any:
    """Return the vector by which a matrix moves."""
    return np.array(matrix)[:3, 3].copy()


def concatenate_matrices(*matrices: Any) -> Any:
    """Return the product of matrices: the last one is applied first."""
    return reduce(np.dot, matrices, np.identity(4))


def inverse_matrix(matrix: Any) -> Any:
    """Return the inverse."""
    return np.linalg.inv(matrix)


def vector_norm(data: Any, axis: int | None = None) -> Any:
    """Return the length of a vector, or of those along an axis."""
    return np.linalg.norm(data, axis=axis)


def unit_vector(data: Any, axis: int | None = None) -> Any:
    """Return a vector of the same direction with length 1."""
    vector = np.asarray(data, dtype=float)
    return vector / np.linalg.norm(vector, axis=axis, keepdims=axis is not None)


def is_same_transform(matrix0: Any, matrix1: Any) -> bool:
    """Return whether two matrices do the same, up to a factor."""
    first, second = (np.asarray(matrix, dtype=float) / matrix[3][3] for matrix in (matrix0, matrix1))
    return bool(np.allclose(first, second))


# --- quaternions


def quaternion_about_axis(angle: float, axis: Any) -> Any:
    """Return the rotation about an axis."""
    vector = math.sin(angle / 2.0) * unit_vector(np.asarray(axis)[:3])
    return np.array([*vector, math.cos(angle / 2.0)])


def quaternion_multiply(quaternion1: Any, quaternion0: Any) -> Any:
    """Return the rotation that does the second one first."""
    return np.array(rigid_motion.multiply(quaternion1, quaternion0))


def quaternion_conjugate(quaternion: Any) -> Any:
    """Return the quaternion with its vector turned round."""
    return np.asarray(quaternion, dtype=float) * (-1.0, -1.0, -1.0, 1.0)


def quaternion_inverse(quaternion: Any) -> Any:
    """Return the rotation that undoes this one."""
    return quaternion_conjugate(quaternion) / np.dot(quaternion, quaternion)


def quaternion_matrix(quaternion: Any) -> Any:
    """Return a rotation as a 4×4 matrix."""
    matrix = np.identity(4)
    matrix[:3, :3] = rigid_motion.matrix(unit_vector(quaternion))
    return matrix


def quaternion_from_matrix(matrix: Any) -> Any:
    """Return the rotation of a 4×4 or 3×3 matrix, with w ≥ 0.

    It is the eigenvector of the largest eigenvalue: https://doi.org/10.2514/2.4654 (Bar-Itzhack, 2000).
    """
    m = np.asarray(matrix, dtype=float)[:3, :3]
    k = np.array(
        [
            [m[0, 0] - m[1, 1] - m[2, 2], m[1, 0] + m[0, 1], m[2, 0] + m[0, 2], m[2, 1] - m[1, 2]],
            [m[1, 0] + m[0, 1], m[1, 1] - m[0, 0] - m[2, 2], m[2, 1] + m[1, 2], m[0, 2] - m[2, 0]],
            [m[2, 0] + m[0, 2], m[2, 1] + m[1, 2], m[2, 2] - m[0, 0] - m[1, 1], m[1, 0] - m[0, 1]],
            [m[2, 1] - m[1, 2], m[0, 2] - m[2, 0], m[1, 0] - m[0, 1], m[0, 0] + m[1, 1] + m[2, 2]],
        ]
    )
    quaternion = np.linalg.eigh(k)[1][:, -1]
    return -quaternion if quaternion[3] < 0 else quaternion


def quaternion_slerp(quat0: Any, quat1: Any, fraction: float, spin: int = 0, shortestpath: bool = True) -> Any:
    """Return the rotation between two; `spin` adds whole turns. https://en.wikipedia.org/wiki/Slerp"""
    first, second = unit_vector(quat0), unit_vector(quat1)
    cosine = float(np.dot(first, second))
    if shortestpath and cosine < 0.0:
        cosine, second = -cosine, -second
    angle = math.acos(max(-1.0, min(1.0, cosine))) + spin * math.pi
    if abs(math.sin(angle)) < 1e-12:
        return first
    return (math.sin((1.0 - fraction) * angle) * first + math.sin(fraction * angle) * second) / math.sin(angle)


def random_quaternion(rand: Any = None) -> Any:
    """Return a random rotation, all being as likely."""
    return unit_vector(np.random.default_rng().normal(size=4))


# --- Euler angles


def rotation_matrix(angle: float, direction: Any, point: Any = None) -> Any:
    """Return the rotation about an axis through a point."""
    matrix = quaternion_matrix(quaternion_about_axis(angle, direction))
    if point is not None:
        at = np.asarray(point, dtype=float)[:3]
        matrix[:3, 3] = at - matrix[:3, :3] @ at
    return matrix


def quaternion_from_euler(ai: float, aj: float, ak: float, axes: str = "sxyz") -> Any:
    """Return three rotations, one after the other."""
    is_fixed, vectors = _axes(axes)
    turns = [quaternion_about_axis(angle, vector) for angle, vector in zip((ai, aj, ak), vectors, strict=True)]
    return reduce(quaternion_multiply, reversed(turns) if is_fixed else turns)


def euler_matrix(ai: float, aj: float, ak: float, axes: str = "sxyz") -> Any:
    """Return three rotations as a 4×4 matrix."""
    return quaternion_matrix(quaternion_from_euler(ai, aj, ak, axes))


def euler_from_quaternion(quaternion: Any, axes: str = "sxyz") -> tuple[float, float, float]:
    """Return the three angles of a rotation."""
    return euler_from_matrix(quaternion_matrix(quaternion), axes)


def euler_from_matrix(matrix: Any, axes: str = "sxyz") -> tuple[float, float, float]:
    """Return the three angles of a matrix's rotation. Where two axes coincide, one angle is 0."""
    is_fixed, vectors = _axes(axes)
    rotation = np.asarray(matrix, dtype=float)[:3, :3]
    # About fixed axes is the same as about turning ones in the reverse order.
    first, second, third = (int(np.argmax(vector)) for vector in (vectors[::-1] if is_fixed else vectors))
    angles = _turning_angles(rotation, first, second, third)
    return angles[::-1] if is_fixed else angles


def _axes(axes: str) -> tuple[bool, list[Any]]:
    kind, names = axes[:1], axes[1:]
    repeats = len(names) == 3 and (names[0] == names[1] or names[1] == names[2])
    if kind not in ("s", "r") or len(names) != 3 or not set(names) <= set("xyz") or repeats:
        raise ValueError(f"axes {axes!r}: expected s or r and three axes such as 'sxyz', no two equal ones in a row")
    return kind == "s", [np.identity(3)["xyz".index(name)] for name in names]


def _turning_angles(matrix: Any, i: int, j: int, k: int) -> tuple[float, float, float]:
    """Return the angles about axis i, then the turned axis j, then the turned axis k. The middle one is read off where
    the other two don't matter, the first from what is left, and the last after undoing both.
    """
    sign = 1.0 if (j - i) % 3 == 1 else -1.0
    if i == k:
        other = 3 - i - j
        middle = math.atan2(math.hypot(matrix[j, i], matrix[other, i]), matrix[i, i])
        first = math.atan2(matrix[j, i], -sign * matrix[other, i]) if math.sin(middle) > 1e-9 else None
    else:
        cosine = math.hypot(matrix[i, i], matrix[i, j])
        middle = math.atan2(sign * matrix[i, k], cosine)
        first = math.atan2(-sign * matrix[j, k], matrix[k, k]) if cosine > 1e-9 else None
    if first is None:  # both outer axes are one, and only their sum is known
        first = 0.0
    rest = _about(j, -middle) @ _about(i, -first) @ matrix
    return first, middle, _angle_about(rest, k)


def _about(axis: int, angle: float) -> Any:
    return quaternion_matrix(quaternion_about_axis(angle, np.identity(3)[axis]))[:3, :3]


def _angle_about(matrix: Any, axis: int) -> float:
    """Return the angle of a rotation about one of the axes."""
    after, last = (axis + 1) % 3, (axis + 2) % 3
    return math.atan2(matrix[last, after], matrix[after, after])
