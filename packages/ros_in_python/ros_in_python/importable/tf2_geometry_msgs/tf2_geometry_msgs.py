"""Points, vectors, poses and wrenches under a transform."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from geometry_msgs.msg import (
    Point,
    PointStamped,
    Pose,
    PoseStamped,
    PoseWithCovarianceStamped,
    Quaternion,
    TransformStamped,
    Vector3,
    Vector3Stamped,
    WrenchStamped,
)
from tf2_py.rigid_motion import RigidMotion, matrix, rotate
from tf2_ros import ConvertRegistration, TransformRegistration


def to_msg_msg(msg: Any) -> Any:
    """Return a message as it is: the conversion of a type that is a message already."""
    return msg


def from_msg_msg(msg: Any) -> Any:
    """Return a message as it is."""
    return msg


def do_transform_point(point: PointStamped, transform: TransformStamped) -> PointStamped:
    """Return a point in the transform's frame: turned and moved."""
    x, y, z = _motion(transform).moved(_numbers(point.point))
    return PointStamped(header=transform.header, point=Point(x=x, y=y, z=z))


def do_transform_vector3(vector3: Vector3Stamped, transform: TransformStamped) -> Vector3Stamped:
    """Return a vector in the transform's frame: turned, not moved, because it has no place."""
    return Vector3Stamped(header=transform.header, vector=_turned(vector3.vector, _motion(transform)))


def do_transform_pose(pose: Pose, transform: TransformStamped) -> Pose:
    """Return a pose in the transform's frame."""
    turn = pose.orientation
    inner = RigidMotion(_numbers(pose.position), (turn.x, turn.y, turn.z, turn.w))
    (x, y, z), (i, j, k, w) = inner.then(_motion(transform))
    return Pose(position=Point(x=x, y=y, z=z), orientation=Quaternion(x=i, y=j, z=k, w=w))


def do_transform_pose_stamped(pose: PoseStamped, transform: TransformStamped) -> PoseStamped:
    """Return a pose with a header in the transform's frame."""
    return PoseStamped(header=transform.header, pose=do_transform_pose(pose.pose, transform))


def do_transform_pose_with_covariance_stamped(
    pose: PoseWithCovarianceStamped, transform: TransformStamped
) -> PoseWithCovarianceStamped:
    """Return a pose with its covariance in the transform's frame."""
    message = PoseWithCovarianceStamped(header=transform.header)
    message.pose.pose = do_transform_pose(pose.pose.pose, transform)
    message.pose.covariance = transform_covariance(pose.pose.covariance, transform)
    return message


def do_transform_wrench(wrench: WrenchStamped, transform: TransformStamped) -> WrenchStamped:
    """Return a force (N) and a torque (N m), turned into the transform's frame."""
    message, motion = WrenchStamped(header=transform.header), _motion(transform)
    message.wrench.force = _turned(wrench.wrench.force, motion)
    message.wrench.torque = _turned(wrench.wrench.torque, motion)
    return message


def transform_covariance(cov_in: Sequence[float], transform: TransformStamped) -> Any:
    """Return a covariance of position and rotation (36 numbers, row by row) in the transform's frame: R C R^T."""
    rows = np.array(matrix(_motion(transform).rotation))
    both = np.kron(np.eye(2), rows)
    return (both @ np.asarray(cov_in, dtype=float).reshape(6, 6) @ both.T).reshape(36)


def _motion(transform: TransformStamped) -> RigidMotion:
    turn = transform.transform.rotation
    return RigidMotion(_numbers(transform.transform.translation), (turn.x, turn.y, turn.z, turn.w))


def _numbers(vector: Any) -> tuple[float, float, float]:
    return (vector.x, vector.y, vector.z)


def _turned(vector: Any, motion: RigidMotion) -> Vector3:
    x, y, z = rotate(motion.rotation, _numbers(vector))
    return Vector3(x=x, y=y, z=z)


_FUNCTIONS = {
    PointStamped: do_transform_point,
    Vector3Stamped: do_transform_vector3,
    PoseStamped: do_transform_pose_stamped,
    PoseWithCovarianceStamped: do_transform_pose_with_covariance_stamped,
    WrenchStamped: do_transform_wrench,
}
for _type, _function in _FUNCTIONS.items():
    TransformRegistration().add(_type, _function)
    ConvertRegistration().add_to_msg(_type, to_msg_msg)
    ConvertRegistration().add_from_msg(_type, from_msg_msg)
