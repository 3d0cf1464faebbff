"""rosidl_runtime_py: messages as text and dictionaries, filled from values, and types by their names."""

from __future__ import annotations

from pathlib import Path

import pytest
import rosidl_runtime_py
from geometry_msgs.msg import PoseStamped
from rosidl_runtime_py import message_to_csv, message_to_ordereddict, message_to_yaml, set_message_fields
from rosidl_runtime_py.utilities import get_action, get_interface, get_message, get_service
from sensor_msgs.msg import JointState
from std_msgs.msg import Header
from std_srvs.srv import Trigger


def test_a_message_becomes_text_and_a_dictionary() -> None:
    state = JointState(header=Header(frame_id="arm"), name=["elbow"], position=[0.5, 1.0])
    fields = message_to_ordereddict(state)
    assert list(fields) == ["header", "name", "position", "velocity", "effort"]
    assert fields["header"] == {"stamp": {"sec": 0, "nanosec": 0}, "frame_id": "arm"}
    assert fields["position"] == [0.5, 1.0]
    assert "frame_id: arm\nname:\n- elbow\nposition:\n- 0.5\n" in message_to_yaml(state)
    assert message_to_csv(state) == "0,0,arm,elbow,0.5,1.0,,"
    assert message_to_ordereddict(state, truncate_length=1)["position"] == [0.5, "..."]
    assert "position: '<sequence type: double, length: 2>'" in message_to_yaml(state, no_arr=True)


def test_a_message_is_filled_and_mistakes_are_of_their_kind() -> None:
    pose = PoseStamped()
    (stamp,) = set_message_fields(pose, {"header": "auto", "pose": {"position": {"x": 1}}}, expand_header_auto=True)
    stamp(type(pose.header.stamp)(sec=3))
    assert (pose.header.stamp.sec, pose.pose.position.x) == (3, 1.0)
    with pytest.raises(AttributeError, match="'height'"):
        set_message_fields(pose, {"height": 1})
    with pytest.raises(ValueError, match="x"):
        set_message_fields(pose, {"pose": {"position": {"x": "far"}}})
    with pytest.raises(TypeError, match="dictionary"):
        set_message_fields(pose, [1])  # type: ignore[arg-type]


def test_types_are_had_by_their_names() -> None:
    assert get_message("sensor_msgs/msg/JointState") is get_message("sensor_msgs/JointState") is JointState
    assert get_service("std_srvs/srv/Trigger") is get_interface("std_srvs/srv/Trigger") is Trigger
    assert get_action("test_msgs/action/Fibonacci").Goal
    with pytest.raises(ValueError, match="full name of a service"):
        get_service("std_msgs/msg/String")
    assert "msg/JointState" in rosidl_runtime_py.get_message_interfaces(["sensor_msgs"])["sensor_msgs"]
    assert Path(rosidl_runtime_py.get_interface_path("std_srvs/srv/Trigger")).name == "Trigger.srv"
    with pytest.raises(LookupError):
        rosidl_runtime_py.get_interfaces(["no_msgs"])
