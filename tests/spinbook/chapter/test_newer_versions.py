"""A node that a chapter shows again, improved, replaces its first version; others run side by side."""

from __future__ import annotations

from pathlib import Path

import pytest
from fences import GUARD, IMPORTS, MAIN, TALKER, cells, read, reading

from spinbook.build.notebook import notebook_json
from spinbook.chapter.classify import CellKind
from spinbook.chapter.python_code import inspect
from spinbook.course.course import Course, find_course

PROGRAM = IMPORTS + TALKER + MAIN


def titled(name: str, code: str) -> str:
    return f'```python title="{name}.py"\n{code}```\n'


def test_a_node_of_the_same_ros_name_is_a_newer_version(tmp_path: Path) -> None:
    first, second = cells(read(tmp_path, PROGRAM, PROGRAM.replace("pass", "return")))

    assert (first.name, second.name, second.replaces) == ("talker", "talker", "")


def test_a_newer_version_in_another_file_replaces_the_first(tmp_path: Path) -> None:
    *_, second = cells(read(tmp_path, titled("talker", PROGRAM), titled("talker_v2", PROGRAM)))

    assert (second.name, second.replaces) == ("talker_v2", "talker")


def test_a_file_that_is_shown_again_keeps_its_name(tmp_path: Path) -> None:
    assert [cell.name for cell in cells(read(tmp_path, titled("arm", PROGRAM), titled("arm", PROGRAM)))] == ["arm"] * 2


@pytest.mark.parametrize(
    ("one", "other"),
    [
        ("create_publisher(String, '/x', 10)", "create_subscription(String, 'x', print, 10)"),
        ("create_client(String, 'x')", "create_service(String, 'x', print)"),
    ],
)
def test_two_nodes_that_talk_to_each_other_run_side_by_side(tmp_path: Path, one: str, other: str) -> None:
    first, second = PROGRAM.replace(MAIN, f"        self.{one}\n{MAIN}"), PROGRAM.replace("Talker", "Listener")

    nodes = cells(read(tmp_path, first, second.replace("def main", f"        self.{other}\ndef main")))

    assert [(node.name, node.replaces) for node in nodes] == [("talker", ""), ("listener", "")]


def test_classes_without_a_literal_ros_name_are_the_same_node_if_they_have_the_same_name(tmp_path: Path) -> None:
    code = IMPORTS + "class LeftArm(Node):\n    def __init__(self):\n        super().__init__(str(1))\n" + MAIN
    code = code.replace("Talker", "LeftArm")

    nodes = cells(read(tmp_path, code, code, code.replace("LeftArm", "RightArm")))

    assert [node.name for node in nodes] == ["left_arm", "left_arm", "right_arm"]


@pytest.mark.parametrize(
    ("end", "calls"),
    [
        ("def main():\n    rclpy.init()\n    rclpy.spin(Talker('a', 2.0))\n" + GUARD, "Talker('a', 2.0)"),
        ("if __name__ == '__main__':\n    rclpy.init()\n    rclpy.spin(Talker('b', 1))\n", "Talker('b', 1)"),
        ("rclpy.init()\nnode = Talker('c', 3)\nrclpy.spin(node)\n", "Talker('c', 3)"),
    ],
)
def test_a_newer_version_of_a_class_runs_with_the_main_of_the_first(tmp_path: Path, end: str, calls: str) -> None:
    first = IMPORTS + TALKER.replace("self)", "self, name, rate)").replace("'talker'", "name")
    newer = (
        TALKER.replace("self)", "self, name, rate)").replace("'talker'", "name")
        + "        self.create_timer(rate, print)\n"
    )

    before, node = cells(read(tmp_path, first + end, newer))

    assert (node.kind, node.name, node.after) == (CellKind.NODE, before.name, (before.name,))
    assert node.replaces == ""
    assert (node.runs_main, node.spin_classes) == (True, ())
    assert calls in node.before
    assert node.whole.count("class Talker") == 1
    assert not inspect(node.whole).needs


def test_a_class_that_needs_no_arguments_runs_with_the_main_of_its_first_version_too(tmp_path: Path) -> None:
    *_, node = cells(read(tmp_path, PROGRAM, TALKER + "        self.count = 0\n"))

    assert node.runs_main
    assert "rclpy.spin(Talker())" in node.before


SPINS_INSIDE = (
    TALKER + "    def ask(self):\n        rclpy.spin_until_future_complete(self, self.client.call_async(1))\n"
)


@pytest.mark.parametrize(
    ("method", "starts"),
    [
        ("def ask(self):\n        rclpy.spin_once(self)", "Talker.ask"),
        ("def ask(self, a=1):\n        self._wait()\n\n    def _wait(self):\n        rclpy.spin(self)", "Talker.ask"),
        ("def run(self):\n        while rclpy.ok():\n            print(1)", "Talker.run"),
        (
            "def make(self):\n        self.create_timer(1, print)\n\n    def ask(self, a):\n        rclpy.spin(self)",
            "Talker",
        ),
    ],
)
def test_a_lone_class_is_spun_or_its_method_that_spins_is_called(tmp_path: Path, method: str, starts: str) -> None:
    (node,) = cells(read(tmp_path, f"{IMPORTS}{TALKER}\n    {method}\n"))

    assert (node.kind, node.spin_classes, node.keeps) == (CellKind.NODE, (starts,), False)


def test_a_class_is_only_shown_if_nothing_calls_its_method_that_spins_and_takes_arguments(tmp_path: Path) -> None:
    code = f"{IMPORTS}{TALKER}\n    def ask(self, a):\n        rclpy.spin_once(self)\n"
    shown = read(tmp_path, code)
    (named,) = cells(read(tmp_path, titled("talker", code)))

    assert shown.static_fences[0].why == "it is a fragment: nothing calls `Talker.ask`, which spins"
    assert (named.spin_classes, named.keeps) == (("Talker.ask",), True)


def test_a_program_that_uses_a_class_that_spins_runs_as_it_is(tmp_path: Path) -> None:
    code = SPINS_INSIDE.replace("self.client.call_async(1)", "None") + "rclpy.init()\nTalker().ask()\n"

    (node,) = cells(read(tmp_path, IMPORTS + code))

    assert (node.kind, node.spin_classes, node.runs_main) == (CellKind.NODE, (), False)


def test_a_script_that_makes_its_node_and_does_not_spin_it_runs(tmp_path: Path) -> None:
    (node,) = cells(read(tmp_path, TALKER + "rclpy.init()\ntalker = Talker()\nprint('made')\n"))

    assert (node.kind, node.spin_classes) == (CellKind.NODE, ())


def test_nodes_and_parts_without_a_file_name_get_their_classs_name(tmp_path: Path) -> None:
    code = IMPORTS + "RATE = 2\nclass LeftArm(Node):\n    def __init__(self, n):\n        super().__init__(n)\n"
    make = "rclpy.init()\nrclpy.spin(LeftArm(str(RATE)))\n"

    part, _ = cells(read(tmp_path, code, make))

    assert part.name == "left_arm"


def test_nodes_without_a_file_name_are_one_warning_for_each_chapter(tmp_path: Path) -> None:
    other = PROGRAM.replace("Talker", "Arm").replace("'talker'", "'arm'")

    (problem,) = reading(tmp_path, PROGRAM, other).problems

    assert problem.problem == "nodes have no file name; they are called `talker` (line 3), `arm` (line 15)."
    assert problem.fix == 'Name the file: ```python title="talker.py"'


def test_the_cell_says_what_it_replaces(tmp_path: Path) -> None:
    (tmp_path / "course.toml").write_text('title = "T"\nchapters = ["c.md"]\n[package]\nname = "robot"\n')
    chapter = read(tmp_path, titled("talker", PROGRAM), titled("talker_v2", PROGRAM))
    course: Course = find_course(tmp_path)

    assert "%%node talker_v2 --main --replaces talker\\n" in notebook_json(chapter, course)
