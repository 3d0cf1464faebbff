"""A name that is almost a topic's is probably a typo; the exercise's own names are not."""

from __future__ import annotations

import pytest

from grader.checking.judge import with_spelling
from grader.checking.message import Message
from grader.checking.verdict import Finding, Verdict
from grader.recording import SentMessage

TOPICS, NODES = ("/joint_commands", "/joint_velocities"), ("/joint_velocity", "/joint/velocities")


def hinted(text: str) -> str:
    """Return what a student reads instead of this finding."""
    finding = with_spelling(Verdict("test_a", "a", "failed", 1.0, finding=Finding(text)), TOPICS, NODES).finding
    assert finding
    return finding.text


def test_a_slip_is_reported() -> None:
    text = "Nothing came on /joint_velocitys."
    assert hinted(text) == f"{text} Is /joint_velocitys a misspelling of /joint_velocities?"


@pytest.mark.parametrize(
    "text", ["Expected /joint_velocity, got /joint_velocity, /log.", "Got /joint/velocities.", "Nothing came on /scan."]
)
def test_the_exercises_own_names_and_quite_other_ones_are_no_slips(text: str) -> None:
    assert hinted(text) == text


def test_a_name_in_another_namespace_is_reported() -> None:
    text = "It publishes on: /joint_velocity/joint_velocities."
    assert hinted(text) == f"{text} /joint_velocity/joint_velocities is not /joint_velocities: the whole name counts."


def test_the_topic_of_a_lifecycle_node_is_explained() -> None:
    text = "Your node publishes on other topics, too. Expected none, got /joint_velocity/transition_event."
    assert hinted(text).startswith(f"{text} A lifecycle node has this topic.")


def test_a_field_that_the_scenario_does_not_give_has_its_default() -> None:
    scan = SentMessage(0, "/scan", "sensor_msgs/msg/LaserScan", {"range_min": 1.0, "header": {"frame_id": "laser"}})
    for message in (scan, Message(scan)):
        assert (message.range_min, message.range_max, message.ranges) == (1.0, 0.0, [])
        assert (message.header.frame_id, message.header.stamp.sec) == ("laser", 0)
        with pytest.raises(AttributeError, match=r"no field 'range_mim'. Did you mean range_min?"):
            _ = message.range_mim
        with pytest.raises(AttributeError, match=r"no field 'frame'. Did you mean frame_id?"):
            _ = message.header.frame
