"""Nested messages are equal if each field is; the path shows where they differ."""

from __future__ import annotations

from typing import Any

import pytest
from geometry_msgs.msg import Point, PoseStamped, Quaternion
from trajectory_msgs.msg import JointTrajectory, JointTrajectoryPoint

from grader.checking.comparator import difference
from grader.runner.message import to_fields


def pose(x: float = 0.0, w: float = 1.0, frame: str = "map") -> dict[str, Any]:
    message = PoseStamped()
    message.header.frame_id = frame
    message.pose.position = Point(x=x)
    message.pose.orientation = Quaternion(w=w)
    return to_fields(message)


def trajectory(*positions: tuple[float, ...]) -> dict[str, Any]:
    return to_fields(JointTrajectory(points=[JointTrajectoryPoint(positions=list(row)) for row in positions]))


@pytest.mark.parametrize(
    ("got", "expected", "path"),
    [
        (pose(), pose(), None),
        (pose(x=1e-9), pose(), None),
        (pose(x=0.5), pose(), "pose.position.x"),
        (pose(w=-1.0), pose(), "pose.orientation.w"),
        (pose(frame="odom", x=0.5), pose(), "header.frame_id"),
        (trajectory((1.0, 2.0), (3.0,)), trajectory((1.0, 2.0), (3.0,)), None),
        (trajectory((1.0, 2.0), (4.0,)), trajectory((1.0, 2.0), (3.0,)), "points[1].positions[0]"),
        (trajectory((1.0, 2.0), ()), trajectory((1.0, 2.0), (3.0,)), "points[1].positions"),
        (trajectory((1.0,)), trajectory((1.0,), (3.0,)), "points"),
    ],
)
def test_where_two_messages_differ(got: dict[str, Any], expected: dict[str, Any], path: str | None) -> None:
    found = difference(got, expected)
    assert (found.path if found else None) == path


def test_a_message_of_another_type_differs_as_a_whole() -> None:
    found = difference({"x": 1.0}, {"y": 1.0})
    assert found
    assert (found.path, found.got, found.expected) == ("", {"x": 1.0}, {"y": 1.0})
