"""The tree of frames gives what matrices give, at every time, and says why where it gives nothing."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import tf2_geometry_msgs  # registers its types
from geometry_msgs.msg import PointStamped, PoseStamped, PoseWithCovarianceStamped, TransformStamped, Vector3Stamped
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray
from rclpy.duration import Duration
from rclpy.time import Time
from tf2_ros import (
    Buffer,
    ConnectivityException,
    ExtrapolationException,
    InvalidArgumentException,
    LookupException,
    TransformException,
    TypeException,
)

Numbers = tuple[float, ...]


def stamped(
    parent: str, child: str, at: float = 1.0, place: Numbers = (0.0, 0.0, 0.0), turn: Numbers = (0.0, 0.0, 0.0, 1.0)
) -> TransformStamped:
    message = TransformStamped(child_frame_id=child)
    message.header.frame_id, message.header.stamp = parent, Time(nanoseconds=round(at * 1e9)).to_msg()
    move, rotation = message.transform.translation, message.transform.rotation
    move.x, move.y, move.z = place
    rotation.x, rotation.y, rotation.z, rotation.w = turn
    return message


def seconds(value: float) -> Time:
    return Time(nanoseconds=round(value * 1e9))


def buffer_of(*transforms: TransformStamped, **options: Any) -> Buffer:
    buffer = Buffer(**options)
    for transform in transforms:
        assert buffer.set_transform(transform, "test")
    return buffer


def place_of(found: TransformStamped) -> Numbers:
    move = found.transform.translation
    return (move.x, move.y, move.z)


def matrix_of(message: TransformStamped) -> NDArray[np.float64]:
    """The 4 by 4 matrix, worked out from the axis and the angle by Rodrigues' formula, without quaternion products."""
    turn = message.transform.rotation
    axis, angle = np.array([turn.x, turn.y, turn.z]), 2 * np.arctan2(np.linalg.norm([turn.x, turn.y, turn.z]), turn.w)
    axis = axis / (np.linalg.norm(axis) or 1.0)
    cross = np.cross(np.eye(3), axis)
    matrix = np.eye(4)
    matrix[:3, :3] = np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross
    matrix[:3, 3] = place_of(message)
    return matrix


number = st.floats(-10, 10, allow_nan=False)
quaternion = st.tuples(number, number, number, number).filter(lambda q: np.linalg.norm(q) > 0.1)


@st.composite
def trees(draw: st.DrawFn) -> list[TransformStamped]:
    """A tree of up to a dozen frames: frame 0 is the root, each other one hangs below an earlier one."""
    count = draw(st.integers(1, 11))
    found = []
    for child in range(1, count + 1):
        turn = np.array(draw(quaternion))
        parent = draw(st.integers(0, child - 1))
        place = draw(st.tuples(number, number, number))
        found.append(stamped(f"f{parent}", f"f{child}", 1.0, place, tuple(turn / np.linalg.norm(turn))))
    return found


@settings(max_examples=60)
@given(tree=trees(), data=st.data())
def test_between_any_two_frames_of_a_tree_the_answer_is_that_of_matrices(
    tree: list[TransformStamped], data: st.DataObject
) -> None:
    in_root = {"f0": np.eye(4)}
    for message in tree:
        in_root[message.child_frame_id] = in_root[message.header.frame_id] @ matrix_of(message)
    target, source = (data.draw(st.sampled_from(sorted(in_root))) for _ in range(2))
    found = buffer_of(*tree).lookup_transform(target, source, Time())
    assert np.allclose(matrix_of(found), np.linalg.inv(in_root[target]) @ in_root[source], atol=1e-6)
    assert (found.header.frame_id, found.child_frame_id) == (target, source)


def test_between_two_times_a_frame_moves_straight_and_turns_steadily() -> None:
    quarter = (0.0, 0.0, np.sin(np.pi / 4), np.cos(np.pi / 4))
    buffer = buffer_of(stamped("w", "a", 1.0), stamped("w", "a", 3.0, (4.0, 2.0, 0.0), quarter))
    found = buffer.lookup_transform("w", "a", seconds(1.5))
    assert place_of(found) == pytest.approx((1.0, 0.5, 0.0))
    assert 2 * np.arctan2(found.transform.rotation.z, found.transform.rotation.w) == pytest.approx(np.pi / 8)


def test_a_turn_goes_the_shorter_way_round() -> None:
    buffer = buffer_of(stamped("w", "a", 1.0), stamped("w", "a", 2.0, turn=(0.0, 0.0, -0.1, -np.sqrt(0.99))))
    found = buffer.lookup_transform("w", "a", seconds(1.5))
    assert 2 * np.arctan2(abs(found.transform.rotation.z), abs(found.transform.rotation.w)) == pytest.approx(
        0.1, abs=1e-3
    )


def test_time_zero_is_the_newest_time_that_all_frames_between_have() -> None:
    buffer = buffer_of(stamped("w", "a", 1.0), stamped("w", "a", 3.0, (2.0, 0.0, 0.0)), stamped("a", "b", 2.0))
    buffer.set_transform(stamped("a", "b", 1.0), "late")
    found = buffer.lookup_transform("w", "b", Time())
    assert (Time.from_msg(found.header.stamp).nanoseconds, place_of(found)) == (2_000_000_000, (1.0, 0.0, 0.0))


def test_a_static_frame_holds_at_every_time_and_gives_time_zero() -> None:
    buffer = Buffer()
    assert buffer.set_transform_static(stamped("w", "camera", 5.0, (0.0, 0.0, 2.0)), "test")
    for time in (Time(), seconds(0.1), seconds(1e6)):
        assert place_of(buffer.lookup_transform("w", "camera", time)) == (0.0, 0.0, 2.0)
    assert Time.from_msg(buffer.lookup_transform("w", "camera", Time()).header.stamp).nanoseconds == 0


def test_static_and_moving_frames_join_at_the_moving_ones_time() -> None:
    buffer = buffer_of(stamped("w", "base", 1.0), stamped("w", "base", 2.0, (1.0, 0.0, 0.0)))
    buffer.set_transform_static(stamped("base", "camera", 0.0, (0.0, 1.0, 0.0)), "test")
    assert place_of(buffer.lookup_transform("w", "camera", seconds(1.5))) == (0.5, 1.0, 0.0)


def test_the_way_ends_where_both_meet_so_a_frame_above_may_be_unknown_then() -> None:
    buffer = buffer_of(stamped("map", "odom", 1.0), stamped("odom", "base", 5.0), stamped("base", "arm", 5.0))
    assert buffer.lookup_transform("base", "arm", seconds(5.0))
    assert buffer.lookup_transform("odom", "arm", seconds(5.0))
    with pytest.raises(ExtrapolationException):
        buffer.lookup_transform("map", "arm", seconds(5.0))


def test_a_frame_that_stood_still_is_looked_up_at_two_times() -> None:
    buffer = buffer_of(stamped("w", "car", 1.0), stamped("w", "car", 2.0, (3.0, 0.0, 0.0)))
    found = buffer.lookup_transform_full("car", seconds(2.0), "car", seconds(1.0), "w")
    assert place_of(found) == (-3.0, 0.0, 0.0)


@pytest.mark.parametrize(
    ("frames", "time", "kind", "text"),
    [
        (("w", "moon"), 0.0, LookupException, '"moon" given to lookup_transform does not exist.*known frames: a, b, t'),
        (("w", "u"), 0.0, ConnectivityException, "not connected"),
        (("w", "a"), 0.5, ExtrapolationException, "into the past.*the oldest is 1.000000 s"),
        (("w", "a"), 9.0, ExtrapolationException, "into the future.*the newest is 3.000000 s"),
        (("a", "b"), 2.0, ExtrapolationException, "only 1.000000 s is known"),
        (("", "a"), 0.0, InvalidArgumentException, "it is empty"),
        (("w", "/a"), 0.0, InvalidArgumentException, "begins with a slash"),
    ],
)  # fmt: skip
def test_each_reason_has_its_exception_and_says_what_is_known(
    frames: tuple[str, str], time: float, kind: type[TransformException], text: str
) -> None:
    buffer = buffer_of(
        stamped("w", "a", 1.0), stamped("w", "a", 3.0), stamped("a", "b", 1.0), stamped("t", "u", 1.0)
    )  # fmt: skip
    with pytest.raises(kind, match=text):
        buffer.lookup_transform(*frames, seconds(time))
    can, why = buffer.can_transform(*frames, seconds(time), return_debug_tuple=True)
    assert not can
    assert why


def test_a_loop_of_frames_is_named() -> None:
    buffer = buffer_of(stamped("a", "b"), stamped("b", "c"), stamped("c", "a"), stamped("t", "u"))
    with pytest.raises(LookupException, match="form a loop: a -> c -> b -> a"):
        buffer.lookup_transform("t", "a", seconds(1.0))


def test_what_is_older_than_ten_seconds_is_forgotten_and_may_not_come_any_more() -> None:
    buffer = buffer_of(stamped("w", "a", 1.0), stamped("w", "a", 10.9))
    assert buffer.can_transform("w", "a", seconds(1.0))
    assert buffer.set_transform(stamped("w", "a", 11.5), "test")
    assert not buffer.can_transform("w", "a", seconds(1.0))
    assert not buffer.set_transform(stamped("w", "a", 1.0), "test")


def test_the_cache_time_is_the_callers() -> None:
    buffer = buffer_of(stamped("w", "a", 1.0), stamped("w", "a", 4.5), cache_time=Duration(seconds=3))
    assert not buffer.can_transform("w", "a", seconds(2.0))


@pytest.mark.parametrize(
    "wrong",
    [
        stamped("a", "a"),
        stamped("", "a"),
        stamped("w", ""),
        stamped("w", "a", turn=(0.0, 0.0, 0.0, 0.0)),
        stamped("w", "a", turn=(0.0, 0.0, 0.0, 1.01)),
        stamped("w", "a", place=(float("nan"), 0.0, 0.0)),
    ],
)
def test_a_transform_that_can_not_be_is_not_taken(wrong: TransformStamped) -> None:
    assert not Buffer().set_transform(wrong, "test")


def test_the_second_of_two_authorities_at_one_time_is_not_taken() -> None:
    buffer = buffer_of(stamped("w", "a", 1.0, (1.0, 0.0, 0.0)))
    assert not buffer.set_transform(stamped("w", "a", 1.0, (9.0, 0.0, 0.0)), "another")
    assert place_of(buffer.lookup_transform("w", "a", Time())) == (1.0, 0.0, 0.0)


def test_a_frame_that_gets_a_new_parent_hangs_below_the_one_of_the_time() -> None:
    buffer = buffer_of(stamped("hand", "cup", 1.0), stamped("table", "cup", 2.0), stamped("w", "hand", 1.0))
    buffer.set_transform(stamped("w", "hand", 2.0), "test")
    assert buffer.can_transform("hand", "cup", seconds(1.0))
    assert buffer.can_transform("table", "cup", seconds(2.0))
    assert not buffer.can_transform("hand", "cup", seconds(2.0))


def test_clearing_forgets_what_moves_and_keeps_what_is_static() -> None:
    buffer = buffer_of(stamped("w", "a"))
    buffer.set_transform_static(stamped("w", "camera"), "test")
    buffer.clear()
    assert not buffer.can_transform("w", "a", Time())
    assert buffer.can_transform("w", "camera", Time())


def test_points_move_and_turn_vectors_only_turn_and_the_covariance_turns_too() -> None:
    quarter = (0.0, 0.0, np.sin(np.pi / 4), np.cos(np.pi / 4))
    buffer = buffer_of(stamped("w", "a", 1.0, (1.0, 2.0, 3.0), quarter))
    point, vector, pose = PointStamped(), Vector3Stamped(), PoseWithCovarianceStamped()
    for message in (point, vector, pose):
        message.header.frame_id, message.header.stamp = "a", seconds(1.0).to_msg()
    point.point.x = vector.vector.x = pose.pose.pose.position.x = 1.0
    pose.pose.covariance[0], pose.pose.covariance[7] = 4.0, 9.0
    moved, turned, posed = (buffer.transform(message, "w") for message in (point, vector, pose))
    assert (moved.point.x, moved.point.y, moved.point.z) == pytest.approx((1.0, 3.0, 3.0))
    assert (turned.vector.x, turned.vector.y, turned.vector.z) == pytest.approx((0.0, 1.0, 0.0))
    assert posed.pose.covariance[[0, 7]] == pytest.approx([9.0, 4.0])
    assert moved.header.frame_id == "w"


def test_a_type_that_nobody_registered_says_what_to_import() -> None:
    buffer = buffer_of(stamped("w", "a"))
    with pytest.raises(TypeException, match="TransformStamped can't be transformed: import the package"):
        buffer.transform(stamped("a", "b"), "w")


def test_a_pose_is_the_same_by_the_function_and_by_the_buffer() -> None:
    turn = (0.5, 0.5, 0.5, 0.5)
    transform = stamped("w", "a", 1.0, (1.0, 2.0, 3.0), turn)
    pose = PoseStamped()
    pose.header.frame_id, pose.header.stamp = "a", seconds(1.0).to_msg()
    pose.pose.position.x = 2.0
    by_function = tf2_geometry_msgs.do_transform_pose_stamped(pose, transform)
    assert buffer_of(transform).transform(pose, "w") == by_function
    assert tf2_geometry_msgs.do_transform_pose(pose.pose, transform) == by_function.pose
