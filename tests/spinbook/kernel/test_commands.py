"""`%ros2`, `%colcon`, `%plot` and `%turtle` in a notebook."""

from __future__ import annotations

import re
from collections.abc import Callable
from xml.etree import ElementTree as ET

import pytest
from notebook_kernel import Kernel

ARM = """import math
import rclpy
from rclpy.executors import ExternalShutdownException
from sensor_msgs.msg import JointState


def main():
    rclpy.init()
    node = rclpy.create_node("arm")
    publisher = node.create_publisher(JointState, "/arm/joints", 10)
    count = 0

    def publish():
        nonlocal count
        count += 1
        message = JointState(name=["shoulder", "elbow"], position=[math.sin(count / 10), 0.5], velocity=[0.0, 1.0])
        message.header.stamp = node.get_clock().now().to_msg()
        publisher.publish(message)

    node.create_timer(0.05, publish)
    node.get_logger().info("moving")
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass


if __name__ == "__main__":
    main()
"""


@pytest.fixture(scope="module")
def arm(module_kernel: Kernel) -> Kernel:
    """A notebook in which a node publishes two joints."""
    module_kernel.run(f"%%node arm --seconds 60 --until moving\n{ARM}")
    return module_kernel


def size_of(picture: dict[str, str]) -> tuple[int, int]:
    """Return width and height in pixels."""
    opening = ET.fromstring(picture["image/svg+xml"]).attrib
    return int(opening["width"]), int(opening["height"])


def texts_of(picture: dict[str, str]) -> set[str | None]:
    """Return what is written in a picture."""
    return {node.text for node in ET.fromstring(picture["image/svg+xml"]).iter("{http://www.w3.org/2000/svg}text")}


def test_a_command_that_does_not_end_is_bounded(arm: Kernel) -> None:
    shown = arm.run("%ros2 --seconds 60 --until elbow topic echo /arm/joints --field name")

    assert shown.error == ""
    assert "['shoulder', 'elbow']" in shown.text


def test_a_command_that_fails_fails_the_cell_in_words(arm: Kernel) -> None:
    shown = arm.run("%ros2 interface show std_msgs/msg/Strin")

    assert shown.error == "ros2 interface show: ended with exit code 1."
    assert "Traceback" not in shown.text


def test_python_variables_are_not_put_into_a_command(arm: Kernel) -> None:
    arm.run("data = 'wrong'")

    assert (
        "data='{data}'"
        in arm.run("%ros2 topic pub --times 1 -w 0 /words std_msgs/msg/String \"{data: '{data}'}\"").text
    )


def test_a_plot_names_joints_and_units(arm: Kernel) -> None:
    (picture,) = arm.run("%plot /arm/joints/position --seconds 1").pictures

    words = picture["text/plain"]
    assert "position shoulder: " in words
    assert "position elbow: " in words
    assert "0.500 … 0.500 rad" in words
    assert size_of(picture)[0] >= 640
    assert {"shoulder", "elbow", "position (rad)"} <= texts_of(picture)


@pytest.mark.parametrize(
    ("path", "curves"),
    [
        ("/arm/joints/position[0]", ["position shoulder"]),
        ("arm/joints/velocity[1]", ["velocity elbow"]),
        ("/arm/joints", ["position shoulder", "position elbow", "velocity shoulder", "velocity elbow"]),
        ("/arm/joints/position[0] /arm/joints/velocity[0]", ["position shoulder", "velocity shoulder"]),
    ],
)
def test_a_plot_takes_a_field_an_index_or_a_whole_topic(arm: Kernel, path: str, curves: list[str]) -> None:
    (picture,) = arm.run(f"%plot {path} --seconds 0.5").pictures

    assert [line.split(":")[0] for line in picture["text/plain"].splitlines()] == curves


def test_a_plot_is_live_where_somebody_watches_and_one_figure_where_nobody_does(arm: Kernel) -> None:
    watched = arm.run("%plot /arm/joints/position --seconds 2.5")
    assert len(watched.pictures) == 1
    assert watched.updates >= 2

    arm.run("import os; os.environ['SPINBOOK_EXECUTING'] = '1'")
    shown = arm.run("%plot /arm/joints/position --seconds 1")
    arm.run("del os.environ['SPINBOOK_EXECUTING']")
    assert len(shown.pictures) == 1
    assert shown.updates == 0


def test_the_stop_button_ends_a_plot_with_what_it_has(arm: Kernel) -> None:
    shown = arm.run("%plot /arm/joints/position --seconds 80", arm.pressing_stop(lambda shown: bool(shown.pictures)))

    assert shown.error == ""
    assert "position shoulder" in shown.pictures[0]["text/plain"]


def test_a_plot_of_nothing_says_what_there_is(arm: Kernel) -> None:
    error = arm.run("%plot /leg/joints/position").error

    assert error == "Nobody publishes /leg/joints/position. Topics with a publisher are: /arm/joints."


def test_a_plot_of_an_unknown_field_names_the_fields(arm: Kernel) -> None:
    error = arm.run("%plot /arm/joints/positon").error

    assert "there is no field `positon`. The fields are: header, name, position, velocity, effort." in error


def test_colcon_builds_the_package_and_ros2_run_starts_its_executable(arm: Kernel) -> None:
    arm.run("%stop arm")

    built = arm.run("%colcon build --symlink-install")
    assert built.error == "", built.text
    assert "1 package finished" in built.text

    assert "arm continues in the background" in arm.run("%ros2 --seconds 60 --until moving run robot arm").text
    assert "/arm\n" in arm.run("%ros2 node list").text
    assert arm.run("%stop arm").text == "arm stopped.\n"
    arm.run("%ros2 --seconds 60 --until moving run robot arm")  # for other tests


def test_the_turtle_runs_and_is_shown(arm: Kernel) -> None:
    kernel = arm
    kernel.run("%ros2 --seconds 60 --until 'Spawning turtle' run turtlesim turtlesim_node")
    twist = "{linear: {x: 2.0}, angular: {z: 1.0}}"
    kernel.run(f'%ros2 --seconds 1 topic pub --rate 5 /turtle1/cmd_vel geometry_msgs/msg/Twist "{twist}"')

    (picture,) = kernel.run("%turtle").pictures

    assert min(size_of(picture)) >= 300
    assert any((text or "").startswith("turtle1:  x ") for text in texts_of(picture))
    assert "animation:" in picture["image/svg+xml"], "it drives again"
    assert kernel.run("%stop turtlesim_node").text == "turtlesim_node stopped.\n"


def test_a_demo_node_runs_in_a_cell_and_is_heard_in_the_next(arm: Kernel) -> None:
    said = arm.run("%ros2 --seconds 60 --until 'World: 1' run demo_nodes_cpp talker")
    assert "[talker]: Publishing: 'Hello World: 1'" in said.text, said.error

    heard = arm.run("%ros2 --seconds 60 --until heard run demo_nodes_py listener")
    assert re.search(r"\[listener\]: I heard: \[Hello World: \d+\]", heard.text)
    assert arm.run("%stop talker\n%stop listener").text == "talker stopped.\nlistener stopped.\n"


def test_ros2_is_a_command_of_the_shell_too_though_the_environment_is_not_activated(
    new_kernel: Callable[..., Kernel],
) -> None:
    kernel = new_kernel(PATH="/usr/bin:/bin", ROS_IN_PYTHON="own")
    assert "The daemon is not running" in kernel.run("!ros2 daemon status").text
    assert "The daemon is not running" in kernel.run("%%bash\nros2 daemon status").text


def test_a_second_instance_under_another_name_runs_beside_the_first(arm: Kernel) -> None:
    for words in ("", " --ros-args -r __node:=second"):
        assert not arm.run(f"%ros2 --seconds 60 --until Spawning run turtlesim turtlesim_node{words}").error
    listed = arm.run("%nodes").text
    assert re.search(r"^turtlesim_node +running", listed, re.MULTILINE)
    assert re.search(r"^second +running", listed, re.MULTILINE)
    arm.run("%stop turtlesim_node\n%stop second")


def test_a_timeline_has_what_happened_on_topics_and_services_while_other_cells_ran(arm: Kernel) -> None:
    begun = arm.run("%timeline --record /arm/joints /arm/list_parameters")
    assert begun.text.startswith("Recording /arm/joints, /arm/list_parameters."), begun.error
    arm.run("%ros2 param list /arm")

    shown = arm.run("%timeline")

    assert shown.error == ""
    (picture,) = shown.pictures
    topic, service = picture["text/plain"].splitlines()
    assert re.match(r"/arm/joints: \d+ messages from", topic)
    assert re.match(r"/arm/list_parameters: .*response at", service)
    assert "prefers-reduced-motion" in picture["image/svg+xml"]
    assert "Nothing is being recorded" in arm.run("%timeline").error


def test_a_node_that_prints_nothing_is_said_to(arm: Kernel) -> None:
    code = "import rclpy\nrclpy.init()\nrclpy.spin(rclpy.create_node('quiet'))\n"

    shown = arm.run(f"%%node quiet --seconds 0.2\n{code}")

    assert re.search(r"^— nothing arrived in \d+ s —$", shown.text, re.MULTILINE), shown.text
    arm.run("%stop quiet")
