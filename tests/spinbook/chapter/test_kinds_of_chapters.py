"""Chapters as authors write them, one for each kind of fence, in one course: kinds/. What goes wrong while nodes run is
in tests/spinbook/build/test_errors_of_nodes.py."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from spinbook.build.notebook import notebook_json
from spinbook.chapter.chapter import Chapter, ChapterCell
from spinbook.chapter.classify import CellKind
from spinbook.chapter.read import ReadResult
from spinbook.chapters import read_all
from spinbook.course.course import Course, find_course

CREATE = "ros2 pkg create toolbox --build-type ament_python"

#: Chapter -> its cells, and why its other fences are only shown.
CELLS = {
    "across_chapters": (
        [
            "asker robot/asker of methods_that_spin",
            "ros2 run robot asker",
            "ping_robot toolbox/pinger of named_below",
            "ros2 run toolbox pinger",
        ],
        ["no executable `scan_node`"],
    ),
    "arguments": ([CREATE, "adder toolbox/adder waits for arguments", "ros2 run toolbox adder 1 2"], []),
    "as_in_a_notebook": (["snippet"] * 4, ["nothing calls what it defines"]),
    "boxes": ([], []),
    "in_the_background": (["snippet"] * 2, []),
    "class_again": (["beeper", "beeper after beeper"], []),
    "excerpts_of_setup": (
        [CREATE, "ping_node toolbox/pinger toolbox/second", "ros2 run toolbox pinger", "ros2 run toolbox second"],
        ["neither Python nor shell"] * 2,
    ),
    "flavours_in_lists": (["snippet"], []),
    "graph_and_plot": (["rqt_graph; ros2 node list", "rqt_plot /turtle1/pose/x"], []),
    "interfaces_as_shown": (
        [
            "demo_interfaces/srv/Triple.srv",
            "demo_interfaces/msg/Reading.msg",
            "demo_interfaces/action/Countdown.action",
            "tripler",
            "# colcon build --packages-select demo_interfaces; "
            'ros2 service call /triple demo_interfaces/srv/Triple "{m: 3}"',
        ],
        ["an interface of example_interfaces, which is installed"],
    ),
    "methods_that_spin": (["asker"], ["nothing makes a node of its class"]),
    "mistakes_in_commands": (
        ['ros2 topic pub /x geometry_msgs/msg/Twist "{linear: {x: 1.0, w: 2}}"'],
        [
            "there is no `ros2 topci` here",
            "there is no `ros2 topic hzz` here",
            "has no `Strng`",
            "has no program `turtlesim_nod`",
        ],
    ),
    "mistakes_in_programs": (["wrong", "snippet"], ["nothing calls `rclpy.init`"]),
    "named_below": (
        [CREATE, "ping_robot toolbox/pinger", "ros2 run toolbox pinger"],
        ["neither Python nor shell", "no fence above shows `Pingr`"],
    ),
    "names_as_arguments": ([CREATE, "tone_maker toolbox/tone_maker", "ros2 run toolbox tone_maker"], []),
    "packages": (["d"], ["nav2_simple_commander", "sensor_msg", "geometry_msgs.msg.Twits"]),
    "pictures_by_reference": ([], []),
    "placeholders": ([], ["placeholders"] * 4 + ["your_package"]),
    "systems": (
        ["ros2 topic list", "# ros2 topic info <topic_name>; ros2 topic list -t"],
        ["for another system", "needs ROS 2 Kilted"],
    ),
    "transcripts": (
        ["ros2 node list", "ros2 topic list; ros2 node list", "ros2 interface show std_msgs/msg/String"],
        [],
    ),
    "twice": (["adder", "better_adder replaces adder"], []),
    "usual_imports": (["scan", "snippet"], []),
    "various_commands": (
        ["# source install/setup.bash; ros2 topic list", "ros2 lifecycle nodes"],
        ["need a real shell", "`rviz2` is not ros2", "`ros2 bag` runs in a terminal"],
    ),
}

#: Chapter -> line, and what is said about it; warnings about missing file names are left out.
PROBLEMS = {
    "across_chapters": [(12, "Its node cells make these: adder, asker")],
    "interfaces_as_shown": [(47, "Did you mean `n`?"), (62, "Did you mean `n`?")],
    "mistakes_in_commands": [
        (4, "Did you mean `ros2 topic`?"),
        (8, "Did you mean `ros2 topic hz`?"),
        (12, "`Vector3` has no field `w`"),
        (16, "Did you mean `String`?"),
        (20, "It has these: draw_square"),
        (23, "`nowhere.md`"),
        (23, "`pictures/none.svg`"),
    ],
    "mistakes_in_programs": [
        (15, "Did you mean `position`?"),
        (16, "Did you mean `stamp`?"),
        (17, "Write `1.0`"),
        (33, "Call `rclpy.init()` first"),
        (37, "unknown attribute `tittle`"),
    ],
    "named_below": [(39, "Did you mean `ping_robot`?")],
    "packages": [(5, "PyPI does not have ROS 2's"), (14, "Did you mean `sensor_msgs`?"), (23, "Did you mean `Twist`?")],
    "placeholders": [(line, "`static`") for line in (4, 8, 12, 16, 20)],
    "systems": [(23, "Call `rclpy.init()` in a line of its own")],
    "various_commands": [(8, "real shell"), (13, "`rviz2`"), (17, "in a terminal")],
}

#: Chapter -> what its prose in the notebook has.
PROSE = {
    "boxes": ["> **Caution**\n>\n> Short one.", "> **In braces**\n>\n> Body", 'src="attachment:pictures-elbow.svg"'],
    "flavours_in_lists": ["> Mind the step.", "> **Hot *motor***", "**Python**"],
    "pictures_by_reference": ["![The elbow](attachment:pictures-elbow.svg", "![](attachment:pictures-elbow.svg"],
    "transcripts": ["In the author's terminal:\n\n````text\n/talker", "string data"],
}


@pytest.fixture(scope="module")
def course() -> Course:
    return find_course(Path(__file__).with_name("kinds"))


@pytest.fixture(scope="module")
def readings(course: Course) -> dict[str, ReadResult]:
    return {result.chapter.name: result for result in read_all(course) if result.chapter}


def chapter(readings: dict[str, ReadResult], name: str) -> Chapter:
    read = readings[name].chapter
    assert read is not None
    return read


def shown(cell: ChapterCell) -> str:
    """The cell in words."""
    if cell.kind is CellKind.SHELL:
        return "; ".join(command.text for command in cell.commands)
    words = [cell.name or cell.kind.value, *("/".join(names) for names in cell.executables)]
    words += [f"replaces {cell.replaces}"] if cell.replaces else []
    words += [f"after {' '.join(cell.after)}"] if cell.after else []
    words += [f"of {cell.shown_in.stem}"] if cell.shown_in else []
    return " ".join(words + (["waits for arguments"] if cell.keeps and not cell.shown_in else []))


@pytest.mark.parametrize("name", CELLS)
def test_each_fence_becomes_what_its_author_means(readings: dict[str, ReadResult], name: str) -> None:
    cells, reasons = CELLS[name]
    read = chapter(readings, name)

    assert [shown(cell) for cell in read.cells if cell.kind is not CellKind.PROSE] == cells
    assert len(read.static_fences) == len(reasons)
    assert [why for fence, why in zip(read.static_fences, reasons, strict=True) if why not in fence.why] == []


@pytest.mark.parametrize("name", CELLS)
def test_each_mistake_is_named_with_its_line_and_a_remedy(readings: dict[str, ReadResult], name: str) -> None:
    problems = [problem for problem in readings[name].problems if problem.group != "a file name"]
    expected = PROBLEMS.get(name, [])

    assert [problem.line for problem in problems] == [line for line, _ in expected]
    for problem, (_, words) in zip(problems, expected, strict=True):
        assert words in f"{problem.problem} {problem.fix}"


@pytest.mark.parametrize("name", PROSE)
def test_prose_keeps_its_pictures_boxes_and_outputs(course: Course, readings: dict[str, ReadResult], name: str) -> None:
    cells = json.loads(notebook_json(chapter(readings, name), course))["cells"]
    prose = "\n\n".join(cell["source"] for cell in cells if cell["cell_type"] == "markdown")

    assert [text for text in PROSE[name] if text not in prose] == []
