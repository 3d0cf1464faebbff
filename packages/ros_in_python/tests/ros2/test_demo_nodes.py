"""`ros2 run demo_nodes_cpp talker` and its companions, without a ROS installation."""

from __future__ import annotations

import re
import signal
from pathlib import Path

import pytest
from ros2_terminal import Running, Terminal

EXECUTABLES = ["add_two_ints_client", "add_two_ints_server", "listener", "talker"]


@pytest.fixture(autouse=True)
def _not_sourced(monkeypatch: pytest.MonkeyPatch) -> None:
    for name in ("AMENT_PREFIX_PATH", "PYTHONPATH"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setenv("RCUTILS_LOGGING_USE_STDOUT", "1")


def logged(node: Running, count: int) -> list[str]:
    """The next lines of a node's log, without their time: `[talker]: text`."""
    return [re.sub(r"^\[INFO\] \[[\d.]+\] ", "", line) for line in node.lines(count)]


@pytest.mark.parametrize(
    ("package", "first"),
    [
        ("demo_nodes_cpp", ["Publishing: 'Hello World: 1'", "Publishing: 'Hello World: 2'"]),
        ("demo_nodes_py", ['Publishing: "Hello World: 0"', 'Publishing: "Hello World: 1"']),
    ],
)
def test_the_talker_counts_and_quotes_as_its_package_does(
    ros_domain: int, terminal: Terminal, package: str, first: list[str]
) -> None:
    talker = terminal.start("run", package, "talker")

    assert logged(talker, 2) == [f"[talker]: {text}" for text in first]


@pytest.mark.parametrize(("package", "number"), [("demo_nodes_cpp", signal.SIGINT), ("demo_nodes_py", signal.SIGTERM)])
def test_the_listener_hears_the_talker_on_a_remapped_topic_under_another_name(
    ros_domain: int, terminal: Terminal, package: str, number: int
) -> None:
    listener = terminal.start("run", package, "listener", "--ros-args", "-r", "chatter:=gossip", "-r", "__node:=ear")
    talker = terminal.start("run", "demo_nodes_py", "talker", "--ros-args", "-r", "chatter:=gossip")

    (heard,) = logged(listener, 1)
    assert re.fullmatch(r"\[ear\]: I heard: \[Hello World: \d+\]", heard)
    for node in (listener, talker):
        answer = node.stop(number)
        assert (answer.code, answer.err) == (0, "")


@pytest.mark.parametrize("package", ["demo_nodes_cpp", "demo_nodes_py"])
def test_the_client_waits_for_the_server_and_gets_the_sum(ros_domain: int, terminal: Terminal, package: str) -> None:
    client = terminal.start("run", package, "add_two_ints_client")
    waiting = logged(client, 1)[0].removeprefix("[add_two_ints_client]: ")
    server = terminal.start("run", package, "add_two_ints_server")

    said = [waiting]
    while said[-1] == "service not available, waiting again...":
        said.append(logged(client, 1)[0].removeprefix("[add_two_ints_client]: "))
    assert said[0] == "service not available, waiting again..."
    assert said[-1] == "Result of add_two_ints: 5"
    assert logged(server, 2) == ["[add_two_ints_server]: Incoming request", "a: 2 b: 3"]
    assert client.process.wait(60) == 0
    assert server.stop().code == 0


def test_a_client_without_a_server_ends_with_ctrl_c(ros_domain: int, terminal: Terminal) -> None:
    client = terminal.start("run", "demo_nodes_py", "add_two_ints_client")
    client.lines(1)

    answer = client.stop()
    assert (answer.code, answer.err) == (0, "")


def test_a_launch_file_starts_them(ros_domain: int, terminal: Terminal, tmp_path: Path) -> None:
    file = tmp_path / "talk.launch.py"
    file.write_text(
        "from launch import LaunchDescription\nfrom launch_ros.actions import Node\n\n\n"
        "def generate_launch_description():\n    return LaunchDescription([\n"
        "        Node(package='demo_nodes_cpp', executable='talker', name='mouth', remappings=[('chatter', 'news')]),\n"
        "        Node(package='demo_nodes_py', executable='listener', remappings=[('chatter', 'news')]),\n    ])\n"
    )
    launched = terminal.start("launch", str(file))

    seen = ""
    while "[listener]: I heard: [Hello World: " not in seen:
        seen += launched.lines(1)[0] + "\n"
    assert "[mouth]: Publishing: 'Hello World: 1'" in seen
    assert launched.stop().code == 0


def test_they_are_listed_with_the_other_packages(terminal: Terminal) -> None:
    packages = terminal.ros2("pkg", "list").out.split()
    assert {"demo_nodes_cpp", "demo_nodes_py", "turtlesim"} <= set(packages)
    listed = terminal.ros2("pkg", "executables", "demo_nodes_cpp").out
    assert listed.splitlines() == [f"demo_nodes_cpp {name}" for name in EXECUTABLES]


def test_an_executable_that_is_missing_is_named_with_those_that_exist(terminal: Terminal) -> None:
    answer = terminal.ros2("run", "demo_nodes_cpp", "talker_qos")

    assert answer.code == 1
    assert f"Executables of demo_nodes_cpp: {', '.join(EXECUTABLES)}." in answer.err


def test_a_real_package_comes_first(terminal: Terminal, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    index, program = tmp_path / "share/ament_index/resource_index/packages", tmp_path / "lib/demo_nodes_cpp/talker"
    for folder in (index, program.parent):
        folder.mkdir(parents=True)
    (index / "demo_nodes_cpp").touch()
    program.write_text("#!/bin/sh\necho the real one\n")
    program.chmod(0o755)
    monkeypatch.setenv("AMENT_PREFIX_PATH", str(tmp_path))

    assert terminal.ros2("run", "demo_nodes_cpp", "talker").out == "the real one\n"
