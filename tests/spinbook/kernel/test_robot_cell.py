"""`%robot` shows what was recorded: each joint at the same times, and as a page that a notebook or the site shows."""

from __future__ import annotations

import ast
import base64
import io
import json
import re
from typing import Any

import pytest
from PIL import Image
from tree import ROOT

from ros_in_python.robot.description import description_text
from ros_in_python.robot.drawing import KIND, as_data
from ros_in_python.robot.urdf import read
from spinbook.kernel.robot_cell import motion_of
from spinbook.kernel.robot_recorder import RobotRecording
from spinbook.site.robots import robot_html, robot_still


def recorded(*samples: tuple[str, str, float, float]) -> RobotRecording:
    recording = RobotRecording()
    for topic, joint, time, position in samples:
        recording.note("sample", topic, "position", "rad", joint, time, position)
    return recording


def test_every_joint_gets_a_position_at_the_same_times() -> None:
    motion = motion_of(
        recorded(*(("/joint_commands", "a", 100 + t / 10, t) for t in range(6)), ("/joint_commands", "b", 100.2, 7.0))
    )

    assert motion.times == pytest.approx((0, 0.1, 0.2, 0.3, 0.4, 0.5))
    assert motion.positions
    assert motion.positions["a"] == pytest.approx((0, 1, 2, 3, 4, 5))
    assert motion.positions["b"] == pytest.approx((7,) * 6)
    assert motion.last == {"a": pytest.approx(5), "b": 7}


def test_what_joints_do_counts_more_than_what_they_are_told() -> None:
    motion = motion_of(recorded(("/joint_commands", "a", 1.0, 1.0), ("/joint_states", "a", 1.0, 2.0)))

    assert motion.last == {"a": 2.0}
    assert motion_of(RobotRecording()).last == {}


def test_the_newest_description_is_shown() -> None:
    recording = RobotRecording()
    recording.note("description", "<robot/>")
    recording.note("description", "<robot name='b'/>")

    assert recording.description == "<robot name='b'/>"


def test_the_humanoid_has_the_joints_of_the_chapter_with_their_limits() -> None:
    chapter = (ROOT / "chapters" / "03-nodes-and-topics.md").read_text(encoding="utf-8")
    match = re.search(r"^LIMITS = ({.*?^})", chapter, re.MULTILINE | re.DOTALL)
    assert match is not None
    limits = ast.literal_eval(re.sub("#.*", "", match.group(1)))

    humanoid = {
        joint.name: (joint.lower, joint.upper) for joint in read(description_text("humanoid_description")).joints
    }

    assert len(limits) == 6
    assert limits.items() <= humanoid.items()


def test_a_page_gets_the_still_picture_its_words_and_the_motion() -> None:
    robot = read("<robot name='&lt;/script&gt;'><link name='a'/></robot>")
    picture = io.BytesIO()
    Image.new("RGBA", (4, 4)).save(picture, "PNG")
    data = as_data(robot, motion_of(RobotRecording()))
    output: dict[str, Any] = {"data": {"image/png": base64.b64encode(picture.getvalue()).decode(), KIND: data}}

    page = robot_html(output, "../")

    path, still = robot_still(output)
    assert still[8:12] == b"WEBP"
    assert f'src="../{path}" alt="The robot &lt;/script&gt;: no joint has moved."' in page
    assert page.count("</script") == 1
    moves = json.loads(page.partition('json">')[2].partition("</script>")[0])
    assert moves == {name: value for name, value in data.items() if name != "words"}, "which stand in `alt`"
