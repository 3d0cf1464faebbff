"""`ros2 launch`: Python, YAML and XML files start nodes with names, parameters and remappings."""

from __future__ import annotations

import signal
from pathlib import Path

import pytest
from click.testing import CliRunner
from ros2_terminal import Terminal

from ros_in_python.launch.command import launch

# Prints its arguments, and the parameter files among them; `wait` makes it run until Ctrl-C.
PROGRAM = """\
#!/bin/sh
trap 'echo interrupted; exit 0' INT
echo "given $*"
for word in "$@"; do
    case "$word" in *.yaml) cat "$word" ;; esac
    if [ "$word" = fail ]; then exit 3; fi
done
for word in "$@"; do
    if [ "$word" = wait ]; then while :; do sleep 0.05; done; fi
done
"""
IMPORTS = """\
from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, GroupAction, LogInfo
from launch.conditions import IfCondition, UnlessCondition
from launch.substitutions import LaunchConfiguration, PathJoinSubstitution
from launch_ros.actions import Node, PushRosNamespace
from launch_ros.parameter_descriptions import ParameterValue
from launch_ros.substitutions import FindPackageShare


def generate_launch_description():
    return LaunchDescription([
"""


@pytest.fixture(autouse=True)
def _not_sourced(monkeypatch: pytest.MonkeyPatch) -> None:
    for name in ("AMENT_PREFIX_PATH", "PYTHONPATH"):
        monkeypatch.delenv(name, raising=False)


@pytest.fixture
def workspace(tmp_path: Path) -> Path:
    """A built workspace with the package `arm`, whose executable `swing` prints its arguments."""
    prefix = tmp_path / "install"
    index = prefix / "share/ament_index/resource_index/packages"
    for folder in (index, prefix / "share/arm/launch", prefix / "share/arm/config", prefix / "lib/arm"):
        folder.mkdir(parents=True)
    (prefix / ".colcon_install_layout").write_text("merged\n")
    (index / "arm").touch()
    (prefix / "lib/arm/swing").write_text(PROGRAM)
    (prefix / "lib/arm/swing").chmod(0o755)
    (prefix / "share/arm/config/arm.yaml").write_text("/left:\n  ros__parameters:\n    speed: 0.25\n")
    return tmp_path


def write(workspace: Path, entities: str, name: str = "arm.launch.py") -> None:
    """Write a launch file of the package; a Python one describes these entities."""
    text = f"{IMPORTS}{entities}    ])\n" if name.endswith(".py") else entities
    (workspace / "install/share/arm/launch" / name).write_text(text)


def test_a_python_file_gives_name_parameters_remappings_and_arguments(workspace: Path, terminal: Terminal) -> None:
    write(
        workspace,
        """
        DeclareLaunchArgument('gain', default_value='0.5'),
        LogInfo(msg=['the gain is ', LaunchConfiguration('gain')]),
        Node(package='arm', executable='swing', name='left', namespace='robot', arguments=['hello'],
             parameters=[PathJoinSubstitution([FindPackageShare('arm'), 'config', 'arm.yaml']),
                         {'gain': LaunchConfiguration('gain'), 'joints': ['elbow', 'wrist'], 'fast': True}],
             remappings=[('/a', '/b')]),
""",
    )
    answer = terminal.ros2("launch", "arm", "arm.launch.py", "gain:=2", cwd=workspace)
    assert answer.code == 0, answer.err
    assert "[INFO] [launch.user]: the gain is 2\n" in answer.out
    given = next(line for line in answer.out.splitlines() if "given" in line)
    assert given.startswith("[swing-1] given hello --ros-args -r __node:=left -r __ns:=/robot --params-file /")
    assert given.endswith("-r /a:=/b")
    assert "[swing-1]     speed: 0.25\n" in answer.out
    # As in ROS 2, an argument's text is read as YAML: a whole number is an integer.
    for line in ("/robot/left:", "    fast: true", "    gain: 2", "    - elbow"):
        assert f"[swing-1] {line}\n" in answer.out


def test_a_parameter_value_says_its_type(workspace: Path, terminal: Terminal) -> None:
    write(
        workspace,
        """
        DeclareLaunchArgument('gain'),
        Node(package='arm', executable='swing',
             parameters=[{'gain': ParameterValue(LaunchConfiguration('gain'), value_type=float)}]),
""",
    )
    assert "    gain: 2.0\n" in terminal.ros2("launch", "arm", "arm.launch.py", "gain:=2", cwd=workspace).out
    refused = terminal.ros2("launch", "arm", "arm.launch.py", "gain:=high", cwd=workspace)
    assert (refused.code, "'high' can't be a parameter of type float" in refused.err) == (1, True)


def test_conditions_and_namespaces_of_groups_hold(workspace: Path, terminal: Terminal) -> None:
    write(
        workspace,
        """
        DeclareLaunchArgument('camera', default_value='false'),
        Node(package='arm', executable='swing', name='eye', condition=IfCondition(LaunchConfiguration('camera'))),
        Node(package='arm', executable='swing', name='blind', condition=UnlessCondition(LaunchConfiguration('camera'))),
        GroupAction([PushRosNamespace('left'), Node(package='arm', executable='swing', name='inside')]),
        Node(package='arm', executable='swing', name='outside'),
""",
    )
    answer = terminal.ros2("launch", "arm", "arm.launch.py", cwd=workspace)
    given = sorted(line.partition("--ros-args ")[2] for line in answer.out.splitlines() if "given" in line)
    assert given == ["-r __node:=blind", "-r __node:=inside -r __ns:=/left", "-r __node:=outside"]


@pytest.mark.parametrize(
    ("name", "text"),
    [
        (
            "arm.launch.yaml",
            """\
launch:
  - arg: {name: gain, default: "0.5"}
  - node:
      pkg: arm
      exec: swing
      name: left
      param:
        - from: $(find-pkg-share arm)/config/arm.yaml
        - {name: gain, value: $(var gain)}
      remap:
        - {from: /a, to: /b}
""",
        ),
        (
            "arm.launch.xml",
            """\
<launch>
  <arg name="gain" default="0.5"/>
  <node pkg="arm" exec="swing" name="left">
    <param from="$(find-pkg-share arm)/config/arm.yaml"/>
    <param name="gain" value="$(var gain)"/>
    <remap from="/a" to="/b"/>
  </node>
</launch>
""",
        ),
    ],
)
def test_yaml_and_xml_say_the_same_in_other_words(workspace: Path, terminal: Terminal, name: str, text: str) -> None:
    write(workspace, text, name)
    answer = terminal.ros2("launch", "arm", name, "gain:=0.75", cwd=workspace)
    assert answer.code == 0, answer.err
    assert "given --ros-args -r __node:=left --params-file" in answer.out
    for line in ("speed: 0.25", "gain: 0.75"):
        assert f"[swing-1]     {line}\n" in answer.out


def test_the_arguments_are_shown_as_the_real_command_shows_them(workspace: Path, terminal: Terminal) -> None:
    write(workspace, "        DeclareLaunchArgument('gain', default_value='0.5', description='How strong'),\n")
    answer = terminal.ros2("launch", "--show-args", "arm", "arm.launch.py", cwd=workspace)
    assert answer.out == (
        "Arguments (pass arguments as '<name>:=<value>'):\n\n"
        "    'gain':\n        How strong\n        (default: '0.5')\n"
    )


def test_ctrl_c_reaches_every_node_once_and_is_no_failure(workspace: Path, terminal: Terminal) -> None:
    node = "        Node(package='arm', executable='swing', arguments=['wait']),\n"
    write(workspace, node * 2)
    running = terminal.start("launch", "arm", "arm.launch.py", cwd=workspace)
    running.lines(4)  # two are started, two have printed their arguments
    answer = running.stop(signal.SIGINT)
    assert answer.code == 0
    assert "[WARNING] [launch]: user interrupted with ctrl-c (SIGINT)\n" in answer.out
    for number in (1, 2):
        assert answer.out.count(f"[swing-{number}] interrupted\n") == 1
        assert f"[INFO] [swing-{number}]: process has finished cleanly" in answer.out


def test_a_node_that_dies_is_named_and_the_launch_fails(workspace: Path, terminal: Terminal) -> None:
    write(workspace, "        Node(package='arm', executable='swing', arguments=['fail']),\n")
    answer = terminal.ros2("launch", "arm", "arm.launch.py", cwd=workspace)
    assert answer.code == 1
    assert "[ERROR] [swing-1]: process has died [pid " in answer.out
    assert f", exit code 3, cmd '{workspace}/install/lib/arm/swing fail']." in answer.out


@pytest.mark.parametrize(
    ("name", "text", "expected"),
    [
        (
            "a.launch.py",
            "from launch.actions import OpaqueCoroutine\n",
            "a.launch.py:1: `OpaqueCoroutine` of launch.act",
        ),
        ("a.launch.py", "import launch_ros.actions as a\na.Composed\n", "a.launch.py:2: `Composed` of launch_ros.act"),
        ("a.launch.py", "import launch.legacy\n", "a.launch.py:1: the module launch.legacy is not"),
        (
            "a.launch.py",
            "from launch import *\nfrom launch.events import *\n"
            "def generate_launch_description():\n    return LaunchDescription([Shutdown()])\n",
            "is not an action. EmitEvent(event=…)",
        ),
        (
            "a.launch.py",
            "import xacro\n",
            "a.launch.py:1: ModuleNotFoundError: No module named 'xacro'\n`pip install xacro`",
        ),
        ("a.launch.py", "def generate_launch_description(\n", "a.launch.py:1: not valid Python"),
        ("a.launch.py", "x = 1\n", "has no function generate_launch_description()"),
        ("a.launch.py", "def generate_launch_description():\n    return 1 / 0\n", "a.launch.py:2: ZeroDivisionError"),
        ("a.launch.yaml", "launch:\n  - node_container: {pkg: a}\n", "`node_container` has no `exec`"),
        ("a.launch.yaml", "launch:\n  - log: {message: $(log_dir)}\n", "`$(log_dir)` is not supported here"),
        ("a.launch.xml", '<launch><arg name="a"><let name="b"/></arg></launch>', "`arg` can't hold `let`"),
        (
            "a.launch.xml",
            '<launch><executable cmd="a" on_exit="b"/></launch>',
            "`on_exit` of `executable` is `sh",
        ),
        ("a.launch.yaml", "launch:\n  - log: {message: $(var a}\n", "no closing parenthesis"),
        ("a.launch.yaml", "launch:\n  - param: {name: a, value: 1}\n", "stands within a node"),
        ("a.launch.yaml", "launch:\n  - node: {pkg: arm}\n", "`node` has no `exec`"),
        ("a.launch.xml", "<launch><node</launch>", "not well-formed"),
    ],
)
def test_what_it_does_not_know_is_refused_with_file_and_line(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, name: str, text: str, expected: str
) -> None:
    monkeypatch.chdir(tmp_path)
    Path(name).write_text(text)
    answer = CliRunner().invoke(launch, [name])
    assert answer.exit_code == 1
    assert expected in answer.output


def test_arguments_and_files_that_are_not_there_are_refused_with_those_that_are(
    workspace: Path, terminal: Terminal
) -> None:
    write(workspace, "        DeclareLaunchArgument('gain'),\n")
    unknown = terminal.ros2("launch", "arm", "arm.launch.py", "gian:=1", cwd=workspace)
    assert "no argument 'gian'. It has: gain." in unknown.err
    missing = terminal.ros2("launch", "arm", "arm.launch.py", cwd=workspace)
    assert "give gain:=VALUE" in missing.err
    absent = terminal.ros2("launch", "arm", "leg.launch.py", cwd=workspace)
    assert "Launch files there: arm.launch.py." in absent.err
    assert {unknown.code, missing.code, absent.code} == {1}


def test_turtlesim_comes_with_its_launch_file(terminal: Terminal) -> None:
    answer = terminal.ros2("launch", "--show-args", "turtlesim", "multisim.launch.py")
    assert (answer.code, answer.err) == (0, "")
    absent = terminal.ros2("launch", "turtlesim", "mimic.launch.py")
    assert "Launch files there: multisim.launch.py." in absent.err
