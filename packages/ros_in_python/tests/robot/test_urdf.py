"""A URDF becomes links and joints, and joint positions become places; what is wrong in it is said."""

from __future__ import annotations

import math

import pytest

from ros_in_python.robot.kinematics import all_positions, link_motions
from ros_in_python.robot.urdf import InvalidUrdf, read

ARM = """\
<?xml version="1.0"?>
<robot name="arm">
  <link name="base"/><link name="upper"/><link name="lower"/><link name="tool"/><link name="finger"/>
  <joint name="shoulder" type="revolute">
    <parent link="base"/><child link="upper"/><origin xyz="0 0 1"/><axis xyz="0 0 2"/>
    <limit lower="-1" upper="1" effort="1" velocity="1"/>
  </joint>
  <joint name="elbow" type="continuous">
    <parent link="upper"/><child link="lower"/><origin xyz="1 0 0"/><axis xyz="0 0 1"/>
  </joint>
  <joint name="wrist" type="fixed">
    <parent link="lower"/><child link="tool"/><origin xyz="1 0 0" rpy="0 0 1.5707963267948966"/>
  </joint>
  <joint name="grip" type="prismatic">
    <parent link="tool"/><child link="finger"/><axis xyz="1 0 0"/>
    <limit lower="0.1" upper="0.3" effort="1" velocity="1"/>
    <mimic joint="shoulder" multiplier="0.5" offset="0.1"/>
  </joint>
</robot>
"""


def test_the_links_are_where_geometry_says() -> None:
    placed = link_motions(read(ARM), {"shoulder": math.pi / 2, "elbow": -math.pi / 2})
    assert placed["lower"].translation == pytest.approx((0.0, 1.0, 1.0), abs=1e-12)
    assert placed["tool"].translation == pytest.approx((1.0, 1.0, 1.0), abs=1e-12)
    # The tool is turned by a quarter, and the finger follows the shoulder: 0.5 * pi/2 + 0.1 along the tool's x.
    assert placed["finger"].translation == pytest.approx((1.0, 1.1 + math.pi / 4, 1.0), abs=1e-12)


def test_a_joint_that_mimics_follows_only_a_position_that_is_known() -> None:
    robot = read(ARM)
    assert all_positions(robot, {"shoulder": 0.4, "unknown": 1.0}) == {"shoulder": 0.4, "grip": pytest.approx(0.3)}
    assert all_positions(robot, {"elbow": 0.4}) == {"elbow": 0.4}


def test_a_joint_rests_at_zero_or_in_the_middle_of_limits_that_leave_zero_out() -> None:
    assert {joint.name: joint.rest for joint in read(ARM).joints if joint.moves} == {
        "shoulder": 0.0, "elbow": 0.0, "grip": pytest.approx(0.2),
    }  # fmt: skip


@pytest.mark.parametrize(
    ("old", "new", "text"),
    [
        ("</robot>", "", "not XML"),
        (ARM, "<model/>", "not <robot>"),
        (ARM, "<robot name='a'/>", "no <link>"),
        ('type="fixed"', 'type="fixd"', "wrist has the type 'fixd'"),
        ('<child link="tool"/>', '<child link="tol"/>', "names the link 'tol'"),
        ('<child link="tool"/>', "", "no <child>"),
        ('<child link="tool"/>', '<child link="upper"/>', "not one tree"),
        ('xyz="0 0 1"', 'xyz="0 0"', "not three numbers"),
        ('<mimic joint="shoulder"', '<mimic joint="sholder"', "mimics 'sholder'"),
        (
            '<link name="base"/>',
            '<xacro:property xmlns:xacro="http://www.ros.org/wiki/xacro" name="a"/><link name="base"/>',
            "xacro",
        ),
    ],
)
def test_what_is_wrong_is_named(old: str, new: str, text: str) -> None:
    with pytest.raises(InvalidUrdf, match=text):
        read(ARM.replace(old, new, 1))
