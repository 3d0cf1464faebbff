"""The chapters' nodes become a ROS 2 package that colcon builds and `ros2 run` runs."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import xml.etree.ElementTree as ElementTree
from pathlib import Path

import pytest
from course_folder import CourseFolder

from spinbook.package.command import read_notebooks
from spinbook.problem import SpinbookError

NODE = '''"""Says hello."""

import rclpy
from rclpy.executors import ExternalShutdownException
from std_msgs.msg import String


def main():
    rclpy.init()
    node = rclpy.create_node("hello")
    node.create_publisher(String, "/hello", 10)
    node.create_timer(0.1, lambda: print("hello from the package", flush=True))
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass


if __name__ == "__main__":
    main()
'''
CHAPTER = f'# One\n\n```python title="hello.py"\n{NODE}```\n'


def _notebook(*sources: str) -> str:
    return json.dumps({"cells": [{"cell_type": "code", "source": source} for source in sources]})


def test_modules_are_the_chapters_code_to_the_byte(course: CourseFolder) -> None:
    said = course.write(one=CHAPTER).spinbook("package")

    folder = course.root / "robot_ws/src/robot"
    assert said.returncode == 0, said.stderr
    assert "ros2 run robot hello" in said.stdout
    assert (folder / "robot/hello.py").read_text() == NODE
    assert {p.name for p in folder.iterdir()} >= {"package.xml", "setup.py", "setup.cfg", "resource", "robot"}
    assert (folder / "resource/robot").read_bytes() == b""


def test_no_line_of_what_is_written_is_too_long_for_ament_flake8(course: CourseFolder) -> None:
    course.write(one=CHAPTER)
    file = course.root / "course.toml"
    description = "Robots that don't fall over, " * 9
    file.write_text(file.read_text() + f'description = "{description}"\n')
    course.spinbook("package")

    folder = course.root / "robot_ws/src/robot"
    written = [folder / "setup.py", *sorted((folder / "test").glob("*.py"))]
    assert [file.name for file in written[1:]] == ["test_copyright.py", "test_flake8.py", "test_pep257.py"]
    assert max(len(line) for file in written for line in file.read_text().splitlines()) <= 99
    said = subprocess.run(
        [sys.executable, "setup.py", "--description"], cwd=folder, capture_output=True, text=True, check=True
    )
    assert said.stdout.strip() == description.strip()


#: What ament_flake8 checks with the plugins that ROS 2 Jazzy installs (builtins, comprehensions, docstrings, import
#: order, quotes), and what ament_pep257 does, in the words of ruff: both leave the same rules out.
AMENT_RULES = (
    *("--isolated", "--line-length", "99", "--select", "E,W,F,A,C4,D,I001,Q"),
    *("--ignore", "D100,D101,D102,D103,D104,D105,D106,D107,D203,D212,D404"),
    *("--config", "lint.isort.force-sort-within-sections=true", "--config", "lint.isort.order-by-type=false"),
    *("--config", 'lint.flake8-quotes.inline-quotes="single"'),
)


def test_the_course_s_own_package_keeps_the_rules_of_ament_flake8_and_ament_pep257(tmp_path: Path) -> None:
    course = Path(__file__).parents[3]
    said = subprocess.run(
        [sys.executable, "-m", "spinbook", "package", "--course", str(course), "--workspace", str(tmp_path)],
        capture_output=True,
        text=True,
    )
    assert said.returncode == 0, said.stderr
    (folder,) = tmp_path.glob("src/*/setup.py")
    ruff = [sys.executable, "-m", "ruff", "check", "--no-cache", *AMENT_RULES, str(folder.parent)]
    found = subprocess.run(ruff, capture_output=True, text=True)
    assert found.returncode == 0, found.stdout


def test_package_xml_names_what_the_modules_import(course: CourseFolder) -> None:
    course.write(one=CHAPTER).spinbook("package")

    root = ElementTree.parse(course.root / "robot_ws/src/robot/package.xml").getroot()
    assert root.findtext("name") == "robot"
    assert [item.text for item in root.findall("exec_depend")] == ["rclpy", "std_msgs"]
    tests = [item.text for item in root.findall("test_depend")]
    assert tests == ["ament_copyright", "ament_flake8", "ament_pep257", "python3-pytest"]
    assert root.findtext("export/build_type") == "ament_python"


def test_a_module_that_left_the_chapters_leaves_the_package_and_other_files_stay(course: CourseFolder) -> None:
    course.write(one=CHAPTER).spinbook("package")
    folder = course.root / "robot_ws/src/robot"
    (folder / "robot/mine.py").write_text("# written by a person\n")

    course.write(one=CHAPTER.replace("hello.py", "greet.py")).spinbook("package")

    assert {p.name for p in (folder / "robot").iterdir()} == {"__init__.py", "greet.py", "mine.py"}


def test_two_chapters_with_different_code_of_one_name_are_refused(course: CourseFolder) -> None:
    course.write(one=CHAPTER, two=CHAPTER.replace("Says hello", "Says hi"))

    said = course.spinbook("package")

    assert said.returncode == 1
    clash = "chapters/two.md:4: error: the node `hello` is also defined in chapters/one.md:4, with other text"
    assert clash in said.stderr
    assert not (course.root / "robot_ws").exists()


def test_a_chapter_with_an_error_leaves_the_package_as_it_was(course: CourseFolder) -> None:
    course.write(one=CHAPTER).spinbook("package")

    said = course.write(two=b"# Two\n\nna\xefve\n").spinbook("package")

    assert said.returncode == 1
    assert "chapters/two.md:3" in said.stderr
    assert (course.root / "robot_ws/src/robot/robot/hello.py").exists()


def test_colcon_builds_it_and_ros2_run_runs_it_and_ctrl_c_ends_it(course: CourseFolder, ros_domain: int) -> None:
    (course.root / "interfaces/robot_interfaces/srv").mkdir(parents=True)
    (course.root / "interfaces/robot_interfaces/srv/Tare.srv").write_text("string joint\n---\nfloat64 offset\n")
    tare = NODE.replace("def main", "from robot_interfaces.srv import Tare\n\n\ndef main")
    said = course.write(one=CHAPTER, two=f'# Two\n\n```python title="tare.py"\n{tare}```\n').spinbook("package")
    # As a terminal with an activated environment does it, with no ament_cmake that could build the interfaces.
    built = subprocess.run(
        ["bash", "-ec", said.stdout.partition("Build:\n")[2]],
        cwd=course.root,
        env={**os.environ, "PATH": f"{Path(sys.executable).parent}:{os.environ['PATH']}"},
        capture_output=True,
        text=True,
    )
    assert "1 package finished" in built.stdout, built.stderr
    # With the linters' tests skipped where ROS 2 is not installed, and not without any test, which is a failure.
    tested = subprocess.run(
        [
            sys.executable,
            "-m",
            "colcon",
            "test",
            "--return-code-on-test-failure",
            "--packages-ignore",
            "robot_interfaces",
        ],
        cwd=course.root / "robot_ws",
        env={**os.environ, "AMENT_PREFIX_PATH": sys.prefix, "PYTEST_ADDOPTS": ""},
        capture_output=True,
        text=True,
    )
    assert tested.returncode == 0, tested.stdout + tested.stderr
    report = ElementTree.parse(course.root / "robot_ws/build/robot/pytest.xml").getroot()
    assert report.find("testsuite").attrib["tests"] == "3"  # type: ignore[union-attr]

    node = subprocess.Popen(
        [sys.executable, "-m", "spinbook", "ros2", "run", "robot", "hello"],
        cwd=course.root / "robot_ws",
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
    )
    assert node.stdout is not None
    assert node.stdout.readline() == "hello from the package\n"
    # What --symlink-install promises: the executable runs the file that is in src.
    assert (course.root / "robot_ws/build/robot/robot").resolve() == course.root / "robot_ws/src/robot/robot"
    node.send_signal(signal.SIGINT)
    assert node.wait(30) == 0
    assert "Traceback" not in node.stdout.read()


def test_a_node_s_line_in_a_notebook_is_read_as_its_cell_reads_it(tmp_path: Path) -> None:
    cells = ["%%part --keep b\nb = 2", "%%node --until hello talker --after b\na = b", "%%node other --help"]
    (tmp_path / "one.ipynb").write_text(_notebook("%chapter one --package robot", *cells))
    modules = read_notebooks(tmp_path).modules
    assert {name: module.code for name, module in modules.items()} == {"talker": "b = 2\n\n\na = b\n"}


@pytest.mark.parametrize(
    ("text", "problem"),
    [("{", "not a valid notebook"), (_notebook("%%node a --untill x"), "cell `%%node a --untill x` can't.*: --untill")],
)
def test_a_notebook_of_which_a_part_would_be_left_out_is_refused(tmp_path: Path, text: str, problem: str) -> None:
    (tmp_path / "one.ipynb").write_text(text)
    with pytest.raises(SpinbookError, match=problem):
        read_notebooks(tmp_path)
