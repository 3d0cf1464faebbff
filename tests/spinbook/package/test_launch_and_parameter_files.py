"""A chapter's launch and parameter files: cells of the notebook, files of the package."""

from __future__ import annotations

import pytest
from course_folder import CourseFolder

LAUNCH = """\
from launch import LaunchDescription
from launch_ros.actions import Node


def generate_launch_description():
    return LaunchDescription([Node(package='robot', executable='hello')])
"""
CHAPTER = f"""# One

```python title="hello.py"
import rclpy


def main():
    rclpy.init()
    rclpy.spin(rclpy.create_node("hello"))


if __name__ == "__main__":
    main()
```

```python title="launch/robot.launch.py"
{LAUNCH}```

```yaml title="config/hello.yaml"
/hello:
  ros__parameters: {{speed: 0.5}}
```

```bash
colcon build
```

```bash
ros2 launch robot robot.launch.py
ros2 run robot hello --ros-args --params-file src/robot/config/hello.yaml
ros2 param load /hello src/robot/config/hello.yaml
ros2 service call /hello/get_parameters rcl_interfaces/srv/GetParameters "{{names: [speed]}}"
```
"""


def test_they_are_in_the_package_and_setup_py_installs_them(course: CourseFolder) -> None:
    said = course.write(one=CHAPTER).spinbook("package")

    folder = course.root / "robot_ws/src/robot"
    assert "ros2 launch robot robot.launch.py" in said.stdout, said.stderr
    assert (folder / "launch/robot.launch.py").read_text() == LAUNCH
    assert (folder / "config/hello.yaml").read_text().startswith("/hello:\n")
    setup = (folder / "setup.py").read_text()
    assert "from glob import glob\n" in setup
    assert "('share/' + package_name + '/launch', glob('launch/*'))," in setup
    assert "('share/' + package_name + '/config', glob('config/*'))," in setup
    assert "<exec_depend>ros2launch</exec_depend>" in (folder / "package.xml").read_text()


@pytest.mark.soak
def test_one_that_left_the_chapters_leaves_the_package(course: CourseFolder) -> None:
    course.write(one=CHAPTER).spinbook("package")
    course.write(one=CHAPTER.replace("config/hello.yaml", "config/other.yaml")).spinbook("package")

    folder = course.root / "robot_ws/src/robot/config"
    assert [file.name for file in folder.iterdir()] == ["other.yaml"]


def test_the_notebook_writes_them_and_the_commands_that_read_them_run(course: CourseFolder) -> None:
    said = course.write(one=CHAPTER).spinbook("build")

    sources = {cell.id: cell.source for cell in course.notebook("one").cells}
    assert said.returncode == 0, said.stdout
    assert sources["file-robot-launch-py"] == f"%%package_file launch/robot.launch.py\n{LAUNCH}".rstrip("\n")
    assert sources["file-hello-yaml"].startswith("%%package_file config/hello.yaml\n/hello:")
    assert sources["ros2-launch-robot-robot-launch-py"].startswith("%ros2 launch robot robot.launch.py\n%ros2 run")


def test_a_file_that_no_cell_writes_is_not_read(course: CourseFolder) -> None:
    without = CHAPTER.replace('title="config/hello.yaml"', 'title="hello.yaml"')
    said = course.write(one=without).spinbook("lint")

    assert "it reads a parameter file, which is missing" in said.stdout


@pytest.mark.soak
def test_a_launch_file_of_which_ros2_launch_knows_not_all_is_shown_and_its_nodes_run_one_by_one(
    course: CourseFolder,
) -> None:
    more = CHAPTER.replace(
        "from launch import LaunchDescription\n",
        "from launch import LaunchDescription\nfrom launch_ros.actions import ComposableNodeContainer\n",
    )
    course.write(one=more).spinbook("build")

    cells = course.notebook("one").cells
    assert not any("%%package_file launch" in cell.source for cell in cells)
    assert any("# ros2 launch robot robot.launch.py starts:\n%ros2 run robot hello" in cell.source for cell in cells)
