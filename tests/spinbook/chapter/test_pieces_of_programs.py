"""Programs that a chapter shows in pieces run as a whole; what stays incomplete is only shown."""

from __future__ import annotations

from pathlib import Path

import pytest
from fences import GUARD, IMPORTS, MAIN, TALKER, cells, read, reading

from spinbook.chapter.classify import CellKind
from spinbook.chapter.python_code import inspect
from spinbook.chapter.read import read_chapter
from spinbook.chapter.surroundings import Surroundings


def test_a_main_continues_the_class_above_which_does_not_run_by_itself(tmp_path: Path) -> None:
    part, node = cells(read(tmp_path, IMPORTS + TALKER, MAIN + GUARD))

    assert (part.kind, part.name) == (CellKind.PART, "talker_part")
    assert (node.kind, node.name, node.after) == (CellKind.NODE, "talker", ("talker_part",))
    assert node.source == MAIN + GUARD
    assert not inspect(node.whole).needs


def test_a_class_whose_imports_alone_a_later_program_uses_runs_by_itself(tmp_path: Path) -> None:
    server = f"from std_srvs.srv import Trigger\n{TALKER}        self.create_service(Trigger, 'a', print)\n"
    later = "def main():\n    rclpy.init()\n    rclpy.spin(Node('later'))\n    print(Trigger)\n"

    first, second = cells(read(tmp_path, server, later))

    assert (first.kind, first.spin_classes) == (CellKind.NODE, ("Talker",))
    assert second.kind is CellKind.NODE


def test_imports_and_a_constant_in_fences_above_are_taken_along(tmp_path: Path) -> None:
    *_, node = cells(
        read(tmp_path, "import rclpy\nimport numpy as pn\n", "RATE = 2.0\n", TALKER + "X = pn.pi * RATE\n" + MAIN)
    )

    assert node.kind is CellKind.NODE
    assert "import numpy as pn" in node.before
    assert "RATE = 2.0" in node.before
    assert "from rclpy.node import Node" in node.before
    assert not inspect(node.whole).needs


@pytest.mark.parametrize("used", ["String", "Twist", "QoSProfile", "np", "MultiThreadedExecutor", "LaserScan"])
def test_the_usual_imports_are_added(tmp_path: Path, used: str) -> None:
    (node,) = cells(read(tmp_path, f"{TALKER}        self.used = {used}\n"))

    assert (node.kind, node.spin_classes) == (CellKind.NODE, ("Talker",))
    assert not inspect(node.whole).needs


@pytest.mark.parametrize(
    ("code", "why"),
    [
        (TALKER + "        self.pub = my_publisher\n", "`my_publisher`, which nothing above defines"),
        (TALKER + "        self.create_timer(1.0, self.tick)\n", "`self.tick` is never set"),
        ("class Arm(Node):\n    def __init__(self, name):\n        super().__init__(name)\n", "nothing makes a node"),
        ("    def tick(self):\n        self.count += 1\n", "indented"),
        ("self.create_timer(1.0, self.tick)\n", "`self`"),
        (IMPORTS + "name = input()\nrclpy.init()\nrclpy.spin(Node(name))\n", "waits for keyboard input"),
    ],
)
def test_what_stays_incomplete_is_shown_with_a_sign(tmp_path: Path, code: str, why: str) -> None:
    chapter = read(tmp_path, code)

    (static,) = chapter.static_fences
    assert why in static.why
    assert cells(chapter) == []
    assert "<small>Not run here: " in chapter.cells[0].source


def test_nothing_is_run_that_changes_the_machine(tmp_path: Path) -> None:
    codes = [
        "import os\nos.system('sudo apt install x')\n",
        "import subprocess\nsubprocess.run(['pip', 'install', 'x'])\n",
        "!rm -rf build\n",
        "import shutil\nshutil.rmtree('build')\n",
        "%pip install x\n",
        "```bash\ngit clone x && colcon build\n```\n",
        "```bash\nsudo apt update\nros2 topic list\n```\n",
    ]

    chapter = read(tmp_path, *codes)

    assert cells(chapter) == []
    assert len(chapter.static_fences) == len(codes)


def test_a_main_without_a_guard_is_called(tmp_path: Path) -> None:
    (node,) = cells(read(tmp_path, IMPORTS + TALKER + MAIN))

    assert node.runs_main
    assert node.spin_classes == ()


def test_two_classes_without_a_main_are_both_spun(tmp_path: Path) -> None:
    (node,) = cells(read(tmp_path, IMPORTS + TALKER + TALKER.replace("Talker", "Listener")))

    assert node.spin_classes == ("Talker", "Listener")


@pytest.mark.parametrize(
    "code",
    [
        "import rclpy\nrclpy.init()\nnode = rclpy.create_node('a')\nwhile rclpy.ok():\n    rclpy.spin_once(node)\n",
        "import time\nwhile True:\n    time.sleep(1)\n",
    ],
)
def test_scripts_that_never_end_are_nodes_and_not_cells_of_the_kernel(tmp_path: Path, code: str) -> None:
    assert [cell.kind for cell in cells(read(tmp_path, code))] == [CellKind.NODE]


def test_a_script_goes_on_in_the_next_fence(tmp_path: Path) -> None:
    *parts, node = cells(
        read(
            tmp_path,
            "import rclpy\nrclpy.init()\nnode = rclpy.create_node('a')\n",
            "rclpy.spin(node)\n",
        )
    )

    assert [part.kind for part in parts] == [CellKind.PART]
    assert node.whole.index("rclpy.init()") < node.whole.index("rclpy.spin(node)")


@pytest.mark.parametrize(
    "before",
    [
        "Create a file `src/arm/arm/gripper.py`:",
        "### gripper.py",
        "Save this as **gripper.py**, and go on.",
        "```bash\ntouch gripper.py\n```",
    ],
)
def test_the_text_before_a_fence_names_its_file(tmp_path: Path, before: str) -> None:
    (tmp_path / "c.md").write_text(f"# T\n\n{before}\n\n```python\n{IMPORTS}{TALKER}{MAIN}```\n")

    chapter = read_chapter(tmp_path, Path("c.md"), Surroundings("robot")).chapter

    assert chapter is not None
    assert [node.name for node in chapter.nodes] == ["gripper"]


SETUP = (
    "from setuptools import setup\nsetup(name='arm', entry_points={'console_scripts': ['hand = arm.gripper:main']})\n"
)
GRIPPER = f'```python title="gripper.py"\n{IMPORTS}{TALKER}{MAIN}```\n'


@pytest.mark.parametrize(
    ("fences", "command"),
    [
        ([GRIPPER], "ros2 run arm gripper"),
        ([GRIPPER], "ros2 run arm gripper.py"),
        ([GRIPPER, SETUP], "ros2 run arm hand"),
        ([GRIPPER], "ros2 run arm talker"),
        ([IMPORTS + TALKER + MAIN], "ros2 run my_package talker"),
        ([IMPORTS + TALKER + MAIN], "ros2 run my_package talker\ncolcon build --packages-select my_package"),
        (["```bash\nros2 pkg create --build-type ament_python arm\n```\n"], "colcon build --packages-select arm"),
        ([GRIPPER, SETUP], "cd ~/ros2_ws && colcon build --packages-select arm && source install/setup.bash"),
        ([GRIPPER], "ros2 topic echo /chatter std_msgs/msg/String"),
        ([GRIPPER], "ros2 node info /talker"),
    ],
)
def test_commands_about_the_chapters_own_package_run(tmp_path: Path, fences: list[str], command: str) -> None:
    last = cells(read(tmp_path, *fences, f"```bash\n{command}\n```\n"))[-1]

    assert last.kind is CellKind.SHELL


@pytest.mark.parametrize("has_main", [True, False])
@pytest.mark.parametrize("given", ["name", "*, name", "name='arm'", "*names"])
def test_a_change_to_a_class_that_needs_arguments_is_not_started_without_them(
    tmp_path: Path, given: str, has_main: bool
) -> None:
    main = "def main():\n    rclpy.init()\n    rclpy.spin(Arm('a'))\n" if has_main else ""
    first = f"{IMPORTS}class Arm(Node):\n    def __init__(self, {given}):\n        super().__init__('arm')\n{main}"
    change = "class Arm(Node):\n    def tick(self):\n        self.count = 2\n"
    chapter = read(tmp_path, first, change)

    runs = has_main or given in {"name='arm'", "*names"}
    assert [cell.after for cell in cells(chapter) if cell.source == change] == ([("arm",)] if runs else [])
    signs = [fence.sign for fence in chapter.static_fences if fence.line > 10]
    assert signs == ([] if runs else ["it is a fragment: nothing makes a node of its class."])


def test_a_class_that_gives_its_node_no_name_is_not_started(tmp_path: Path) -> None:
    chapter = read(tmp_path, IMPORTS + "class Arm(Node):\n    def tick(self):\n        pass\n")

    assert cells(chapter) == []
    assert chapter.static_fences[0].sign == "it is a fragment: nothing makes a node of its class."


def test_a_node_knows_what_ros2_run_calls_it(tmp_path: Path) -> None:
    node, _ = cells(read(tmp_path, GRIPPER, SETUP, "```bash\nros2 run arm hand\n```\n"))

    assert node.executables == (("arm", "hand"),)


@pytest.mark.parametrize("command", ["ros2 topic echo /chatter", "ros2 node info /listener", "ros2 topic hz chatter"])
def test_the_demo_nodes_run_and_what_they_make_can_be_looked_at(tmp_path: Path, command: str) -> None:
    demos = "```bash\nros2 run demo_nodes_cpp talker\n```\n\n```bash\nros2 run demo_nodes_py listener\n```\n"
    found = cells(read(tmp_path, demos, f"```bash\n{command}\n```\n"))

    assert [cell.kind for cell in found] == [CellKind.SHELL] * 3


def test_a_demo_node_is_not_the_chapters_own_node_of_that_name(tmp_path: Path) -> None:
    own, demo = cells(read(tmp_path, IMPORTS + TALKER + MAIN + GUARD, "```bash\nros2 run demo_nodes_py talker\n```\n"))

    assert (own.name, own.executables) == ("talker", ())
    assert demo.kind is CellKind.SHELL


def test_a_command_whose_program_is_shown_and_not_run_says_why_that_is(tmp_path: Path) -> None:
    lacks = IMPORTS.replace("import rclpy\n", "import rclpy\nimport not_here\n", 1) + TALKER + MAIN + GUARD

    *_, problem = reading(tmp_path, lacks, "```bash\nros2 run arm talker\n```\n").problems

    assert "is not run itself: it needs `not_here`, which is not installed" in problem.problem


@pytest.mark.parametrize(
    ("command", "why"),
    [
        ("ros2 run nav2_map_server map_saver", "no package `nav2_map_server`"),
        ("ros2 run turtlesim turtle_race", "has no program `turtle_race`"),
        ("ros2 run demo_nodes_cpp talker_qos", "has no program `talker_qos`"),
        ("ros2 run turtlesim turtle_teleop_key", "reads keys from a terminal"),
        ("ros2 run arm other", "no fence above shows `other`"),
        ("colcon build", "no cell above makes"),
        ("ros2 pkg create --build-type ament_cmake arm", "C++"),
        ("ros2 pkg create --bui1d-type ament_python arm", "has no option `--bui1d-type`"),
        ("ros2 topic pub /a nav2_msgs/msg/Route {}", "needs `nav2_msgs`"),
        ("ros2 topic echo /scan", "nothing above makes `/scan`"),
        ("ros2 topic echo ...", "holds placeholders"),
        ("ros2 topic info /topic_name", "holds placeholders"),
        ("ros2 run arm hand --ros-args --params-file p.yaml", "reads a parameter file"),
    ],
)
def test_foreign_commands_are_shown_with_a_word(tmp_path: Path, command: str, why: str) -> None:
    chapter = read(tmp_path, SETUP, f"```bash\n{command}\n```\n")

    assert cells(chapter) == []
    assert why in chapter.static_fences[-1].sign


@pytest.mark.parametrize(
    ("code", "kind"),
    [
        ("$ ros2 topic list\n$ ros2 node list\n", CellKind.SHELL),
        ("cd ros2_ws\nros2 topic list\n", CellKind.SHELL),
        ("user@pc:~$ ros2 topic list\n", CellKind.SHELL),
        (IMPORTS + TALKER, CellKind.NODE),
        ("ros2 topic list\n/chatter\n/rosout\n", None),
        ("src/\n  arm/\n", None),
    ],
)
def test_a_fence_without_a_language_is_what_it_surely_is(tmp_path: Path, code: str, kind: CellKind | None) -> None:
    assert [cell.kind for cell in cells(read(tmp_path, f"```\n{code}```\n"))] == ([kind] if kind else [])


def test_a_caption_is_no_file_name(tmp_path: Path) -> None:
    (node,) = cells(read(tmp_path, f'```python title="Publisher Node"\n{IMPORTS}{TALKER}{MAIN}```\n'))

    assert node.name == "talker"


def test_an_import_that_the_code_can_do_without_is_not_missed(tmp_path: Path) -> None:
    code = "try:\n    import no_such_package\nexcept ImportError:\n    no_such_package = None\n"

    assert [cell.kind for cell in cells(read(tmp_path, code))] == [CellKind.SNIPPET]


def test_a_launch_file_of_the_chapter_starts_its_nodes(tmp_path: Path) -> None:
    launch = (
        '```python title="arm.launch.py"\n'
        "from launch import LaunchDescription\nfrom launch_ros.actions import Node\n\n\n"
        "def generate_launch_description():\n    return LaunchDescription([\n"
        "        Node(package='arm', executable='gripper', name='left', parameters=[{'rate': 2.0, 'loud': True}],\n"
        "             remappings=[('chatter', 'left/chatter')]),\n    ])\n```\n"
    )

    shell = cells(read(tmp_path, GRIPPER, launch, "```bash\nros2 launch arm arm.launch.py\n```\n"))[-1]

    assert [command.text for command in shell.commands] == [
        "# ros2 launch arm arm.launch.py starts:",
        "ros2 run arm gripper --ros-args -r __node:=left -r chatter:=left/chatter -p rate:=2.0 -p loud:=true",
    ]


def test_a_launch_file_from_elsewhere_is_shown_only(tmp_path: Path) -> None:
    chapter = read(tmp_path, "```bash\nros2 launch nav2_bringup navigation.launch.py\n```\n")

    assert chapter.static_fences[0].sign == "there is no package `nav2_bringup` here."


def test_a_launch_file_of_the_chapters_package_that_no_fence_shows_is_shown_only(tmp_path: Path) -> None:
    chapter = read(tmp_path, "```bash\nros2 launch robot robot.launch.py\n```\n")

    assert chapter.static_fences[0].sign == "no fence above is its launch file."


def test_methods_are_added_to_the_class_above(tmp_path: Path) -> None:
    begun = f"{IMPORTS}{TALKER}        self.count = 0\n\n    def shout(self):\n        pass\n"
    added = "class Talker(Node):\n    # ...\n\n    def beat(self):\n        self.count += 1\n        self.shout()\n"

    *_, node = cells(read(tmp_path, begun, added))

    assert (node.kind, node.after, node.spin_classes) == (CellKind.NODE, ("talker",), ("Talker",))
    assert node.before.rstrip().endswith("Node = Talker")


def test_where_failing_is_the_lesson_it_may_fail(tmp_path: Path) -> None:
    fences = [f"```python {more}raises\nimport rclpy\nrclpy.spin(undefined)\n```\n" for more in ("", 'title="a.py" ')]

    chapter = read(tmp_path, *fences, "```python raises\nundefined\n```\n")

    assert [cell.raises for cell in cells(chapter)] == [True, True, True]


def test_a_program_that_is_shown_again_line_by_line_runs(tmp_path: Path) -> None:
    begin, rest = "rclpy.init()\nnode = rclpy.create_node('hand')\n", "while rclpy.ok():\n    print(node)\n"

    _, part, spinning, printing = cells(read(tmp_path, "import rclpy\n", begin, "rclpy.spin(node)\n", rest))

    assert (part.kind, part.name) == (CellKind.PART, "hand_part")
    assert (spinning.kind, spinning.after) == (CellKind.NODE, ("hand_part",))
    assert (printing.name, printing.after) == ("hand", ("hand_part",))
