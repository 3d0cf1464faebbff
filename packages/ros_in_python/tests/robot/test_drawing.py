"""A URDF and joint positions become a picture: its shapes, what is red in it, its words, and data for the browser."""

from __future__ import annotations

import io
from pathlib import Path

import numpy as np
import pytest
from ament_index_python.packages import get_package_share_directory
from PIL import Image

from ros_in_python.robot.description import description_text
from ros_in_python.robot.drawing import RobotMotion, as_data, in_words, shapes_of
from ros_in_python.robot.kinematics import link_motions
from ros_in_python.robot.still import as_png
from ros_in_python.robot.urdf import InvalidUrdf, LinkShape, RobotDescription, read
from ros_in_python.ros2.executables import add_own_prefix

LEG = """\
<robot name="leg">
  <material name="steel"><color rgba="0.5 0.6 0.7 1"/></material>
  <link name="foot"><visual><geometry><mesh filename="package://leg/foot.stl"/></geometry></visual></link>
  <link name="thigh">
    <visual><geometry><box size="0.2 0.4 0.6"/></geometry><material name="steel"/></visual>
    <visual>
      <origin xyz="0 0 -1"/><geometry><cylinder radius="0.1" length="0.8"/></geometry>
      <material name=""><color rgba="1 0 0 1"/></material>
    </visual>
  </link>
  <link name="shin"/>
  <joint name="ankle" type="fixed"><parent link="shin"/><child link="foot"/><origin xyz="0 0 -2"/></joint>
  <joint name="left_knee" type="revolute">
    <parent link="thigh"/><child link="shin"/><origin xyz="0 0 -1"/><axis xyz="0 1 0"/>
    <limit lower="0" upper="2" effort="1" velocity="1"/>
  </joint>
</robot>
"""


@pytest.fixture(scope="module")
def humanoid() -> RobotDescription:
    return read(description_text("humanoid_description"))


def test_shapes_have_their_sizes_places_and_colours() -> None:
    mesh, box, cylinder = read(LEG).shapes

    assert (box.link, box.kind, box.half, box.colour) == ("thigh", "box", (0.1, 0.2, 0.3), (0.5, 0.6, 0.7))
    assert (cylinder.kind, cylinder.half, cylinder.origin.translation) == ("cylinder", (0.1, 0.1, 0.4), (0, 0, -1))
    assert cylinder.colour == (1, 0, 0)
    assert mesh == LinkShape("foot", "mesh", (0, 0, 0))


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [("0.2 0.4 0.6", "0.2", "not three numbers"), ("0.5 0.6 0.7 1", "grey", 'rgba="grey" is not four numbers')],
)
def test_a_shape_that_can_not_be_read_is_reported(old: str, new: str, words: str) -> None:
    with pytest.raises(InvalidUrdf, match=words):
        read(LEG.replace(old, new))


def test_the_picture_in_words_names_each_joint_its_position_and_what_is_not_drawn() -> None:
    assert in_words(read(LEG), {"left_knee": 1.2}) == "The robot leg: left knee 1.20 rad. Not drawn: 1 mesh."
    assert "left knee −0.50 rad (beyond its limits, 0.00 to 2.00)" in in_words(read(LEG), {"left_knee": -0.5})
    assert "no joint has moved" in in_words(read(LEG), {})


def test_a_robot_without_shapes_is_drawn_as_balls_and_bones() -> None:
    bare = read("<robot name='a'><link name='a'/><link name='b'/><joint name='j' type='fixed'><parent link='a'/>"
                "<child link='b'/><origin xyz='0 2 0'/></joint></robot>")  # fmt: skip

    first, second, bone = shapes_of(bare)
    assert (first.kind, second.link) == ("sphere", "b")
    assert bone.half[2] == 1
    assert bone.origin.moved((0, 0, 1)) == pytest.approx((0, 2, 0))


def test_data_for_the_browser_have_parents_before_children_and_the_motion() -> None:
    data = as_data(read(LEG), RobotMotion((0.0, 0.5), {"left_knee": (0.0, 1.23456)}))

    assert [(joint["name"], joint["parent"], joint["child"]) for joint in data["joints"]] == [
        ("left_knee", 0, 1), ("ankle", 1, 2),
    ]  # fmt: skip
    assert data["joints"][0]["limits"] == [0, 2]
    assert data["shapes"][0] == [0, "box", [0.1, 0.2, 0.3], [0, 0, 0, 0, 0, 0, 1], [0.5, 0.6, 0.7]]
    assert (data["times"], data["positions"]) == ([0, 0.5], {"left_knee": [0, 1.235]})


def test_the_humanoid_bends_its_elbow_forward_and_lifts_its_arms_to_the_sides(humanoid: RobotDescription) -> None:
    def hand(**positions: float) -> tuple[float, float, float]:
        return link_motions(humanoid, positions)["left_forearm"].moved((0, 0, -0.19))

    x, y, z = hand()
    assert hand(left_elbow=1.5)[0] > x + 0.15
    assert hand(left_shoulder_pitch=1.0)[0] > x + 0.3
    assert hand(left_shoulder_roll=0.7)[1] > y + 0.2
    assert z < link_motions(humanoid, {})["left_forearm"].translation[2]


def test_the_still_picture_shows_red_where_a_joint_is_beyond_its_limits(humanoid: RobotDescription) -> None:
    assert red_pixels(humanoid, {"left_elbow": 0.5}) == 0
    assert red_pixels(humanoid, {"left_elbow": -0.5}) > 20


def red_pixels(robot: RobotDescription, positions: dict[str, float]) -> int:
    picture = Image.open(io.BytesIO(as_png(robot, positions, scale=0.25)))
    assert picture.size == (105, 115)
    pixels = np.asarray(picture).reshape(-1, 4)
    return int(((pixels[:, 0] > 120) & (pixels[:, 1:3].max(axis=1) < 60)).sum())


def test_programs_find_the_humanoid_as_an_installed_package(monkeypatch: pytest.MonkeyPatch) -> None:
    environment: dict[str, str] = {}
    add_own_prefix(environment)
    monkeypatch.setenv("AMENT_PREFIX_PATH", environment["AMENT_PREFIX_PATH"])

    share = Path(get_package_share_directory("humanoid_description"))

    assert read((share / "urdf" / "humanoid.urdf").read_text(encoding="utf-8")).name == "humanoid"


@pytest.mark.parametrize(
    ("source", "words"), [("no_such_package", "no installed package"), ("std_msgs", "no .urdf file")]
)
def test_a_package_without_a_robot_is_reported(source: str, words: str) -> None:
    with pytest.raises(InvalidUrdf, match=words):
        description_text(source)
