"""`ros2 bag` records topics, with a course's own types too, says what is in a bag, and plays it again."""

from __future__ import annotations

from pathlib import Path

import pytest
from ros2_terminal import Robot, Terminal


def test_what_was_recorded_is_reported_and_played_again(
    robot: Robot, terminal: Terminal, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    publisher = robot("publisher")
    recording = terminal.start("bag", "record", "-o", "swing", "/joint_commands")
    assert recording.lines(2) == ["Recording... Press Ctrl-C to stop.", "Subscribed to topic '/joint_commands'"]
    echo = terminal.ros2("topic", "echo", "--once", "/joint_commands")  # by then the recording has received some, too
    assert echo.code == 0
    stopped = recording.stop()
    assert "messages in swing" in stopped.out
    publisher.kill()
    publisher.communicate()

    output = terminal.ros2("bag", "info", "swing")
    assert output.code == 0, output.err
    assert "Storage id:        mcap" in output.out
    assert "Files:             swing_0.mcap" in output.out
    assert "Topic information: Topic: /joint_commands | Type: sensor_msgs/msg/JointState | Count: " in output.out
    listener = terminal.start("topic", "echo", "/joint_commands", "sensor_msgs/msg/JointState")
    played = terminal.ros2("bag", "play", "swing", "--rate", "100")
    assert played.code == 0, played.err
    assert listener.lines(1) == ["header:"]
    listener.stop()
    misspelt = terminal.ros2("bag", "play", "swing", "--topics", "/joint_comands")
    assert misspelt.err == "The bag has no topic /joint_comands.\nIt has: /joint_commands.\n"

    again = terminal.ros2("bag", "record", "-o", "swing", "-a")
    assert (again.code, "already exists" in again.err) == (1, True)
    assert "can't be read as a bag" in terminal.ros2("bag", "info", "nothing").err


def test_a_latched_topic_is_stored_in_sqlite3_and_played_back_latched(
    robot: Robot, terminal: Terminal, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    publisher = robot("latched")
    recording = terminal.start("bag", "record", "-s", "sqlite3", "-o", "name", "/robot_name")
    recording.lines(2)
    terminal.ros2("topic", "echo", "--once", "/robot_name")  # by then the recording has received it, too
    assert "1 messages in name" in recording.stop().out
    publisher.kill()
    publisher.communicate()
    said = terminal.ros2("bag", "info", "name").out
    assert "Files:             name_0.db3" in said
    assert "Storage id:        sqlite3" in said
    playing = terminal.start("bag", "play", "name", "--loop")
    late = terminal.ros2(
        "topic", "echo", "--once", "/robot_name", "std_msgs/msg/String", "--qos-durability", "transient_local"
    )
    assert "data: Ada\n" in late.out
    playing.stop()
