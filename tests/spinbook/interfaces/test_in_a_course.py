"""A chapter that defines a message, a service and an action: from its text to the notebook, the package, the grade."""

from __future__ import annotations

import xml.etree.ElementTree as ElementTree
from pathlib import Path

import pytest
from click.testing import CliRunner
from course_folder import CourseFolder
from no_compiler import without_compilers

from grader.exercise.exercise import ExerciseError
from grader.exercise.loading import load
from interface_compiler import prefixes, shipped
from interface_compiler.store import ensure
from interface_compiler.wheel import wheel
from spinbook.course.course import find_course
from spinbook.handout.wheels import interface_wheels, package_of, requirement
from spinbook.interfaces import command

CHAPTER = """# Limits

```text title="msg/Limits.msg"
# The limits of one joint (rad)
string name
float64 lower -1.5
```

```text title="srv/Ask.srv"
string name
---
Limits limits
```

```text title="action/Go.action"
Limits goal
---
float64 error
---
float64 position
```

An interface that is installed is only shown:

```text title="geometry_msgs/msg/Point.msg"
float64 x
```

```python
from robot_interfaces.msg import Limits

print(Limits(name="hip"))
```

```python title="answer.py"
import rclpy
from rclpy.executors import ExternalShutdownException
from robot_interfaces.msg import Limits
from robot_interfaces.srv import Ask


def main():
    rclpy.init()
    node = rclpy.create_node("answer")

    def answer(request, response):
        response.limits = Limits(name=request.name)
        return response

    node.create_service(Ask, "ask", answer)
    print("ready", flush=True)
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass


if __name__ == "__main__":
    main()
```

```bash
ros2 interface show robot_interfaces/action/Go
ros2 service call /ask robot_interfaces/srv/Ask "{name: knee}"
```
"""


@pytest.fixture(scope="module")
def built(tmp_path_factory: pytest.TempPathFactory) -> CourseFolder:
    """The course with that chapter, built, executed and packaged."""
    course = CourseFolder(tmp_path_factory.mktemp("course")).write(limits=CHAPTER)
    said = course.spinbook("build", "--execute")
    assert said.returncode == 0, said.stdout + said.stderr
    assert "Interfaces compiled: robot_interfaces" in said.stdout
    assert course.spinbook("package").returncode == 0
    return course


def test_definitions_are_cells_of_their_own(built: CourseFolder) -> None:
    cells = {cell.id: cell.source for cell in built.notebook("limits").cells if cell.cell_type == "code"}

    assert cells["interface-limits-msg"].startswith("%%interface robot_interfaces/msg/Limits.msg\n# The limits")
    assert {"interface-ask-srv", "interface-go-action"} <= cells.keys()
    assert not any("geometry_msgs" in source for source in cells.values())


def test_everything_in_the_notebook_knows_them(built: CourseFolder) -> None:
    outputs = built.outputs("limits")

    assert outputs["interface-limits-msg"] == "robot_interfaces/msg/Limits: ready.\n"
    assert "Limits(name='hip', lower=-1.5)" in outputs["code-limits"]
    assert "ready" in outputs["node-answer"]
    shell = outputs["ros2-interface-show-robot-interfaces-action-go"]
    assert "Limits goal\n\tstring name\n\tfloat64 lower -1.5\n---" in shell
    assert "Limits(name='knee', lower=-1.5)" in shell


def test_nothing_changed_nothing_is_compiled_or_run_again(built: CourseFolder) -> None:
    said = built.spinbook("build", "--execute")

    assert "Interfaces unchanged: robot_interfaces" in said.stdout
    assert "unchanged since its last run" in said.stdout


def test_a_terminal_in_the_courses_folder_knows_them(built: CourseFolder) -> None:
    shown = built.spinbook("ros2", "interface", "show", "robot_interfaces/srv/Ask")

    assert shown.stdout == "string name\n---\nLimits limits\n\tstring name\n\tfloat64 lower -1.5\n"


def test_the_package_of_interfaces_is_one_for_ament_cmake(built: CourseFolder) -> None:
    folder = built.root / "robot_ws" / "src" / "robot_interfaces"
    package = ElementTree.parse(folder / "package.xml").getroot()
    cmake = (folder / "CMakeLists.txt").read_text()

    assert (folder / "msg" / "Limits.msg").read_text().startswith("# The limits of one joint")
    assert package.findtext("export/build_type") == "ament_cmake"
    assert package.findtext("member_of_group") == "rosidl_interface_packages"
    assert [item.text for item in package.findall("buildtool_depend")] == ["ament_cmake", "rosidl_default_generators"]
    assert '"action/Go.action"\n  "msg/Limits.msg"\n  "srv/Ask.srv"' in cmake
    assert "find_package(action_msgs REQUIRED)" in cmake


def test_the_package_of_nodes_depends_on_it(built: CourseFolder) -> None:
    package = ElementTree.parse(built.root / "robot_ws" / "src" / "robot" / "package.xml").getroot()

    assert "robot_interfaces" in [item.text for item in package.findall("exec_depend")]


def test_a_wheel_for_students_is_the_same_bytes_each_time(built: CourseFolder) -> None:
    prefix = next(folder for folder in (built.root / "build" / "interfaces").iterdir() if folder.is_dir())

    name, content = wheel("robot_interfaces", prefix)

    assert wheel("robot_interfaces", prefix) == (name, content)
    assert requirement(name).startswith(f"./wheels/{name} ; platform_machine == ")
    assert str(built.root).encode() not in content


@pytest.mark.soak
def test_a_handout_brings_a_package_that_only_the_courses_definitions_need(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    added = ensure(shipped.definitions("tf2_msgs"), tmp_path / "store").prefix
    monkeypatch.setenv("AMENT_PREFIX_PATH", str(added))
    CourseFolder(tmp_path).write(one="# One\n")
    folder = tmp_path / "interfaces" / "robot_interfaces" / "msg"
    folder.mkdir(parents=True)
    (folder / "Lost.msg").write_text("tf2_msgs/TF2Error error\n")

    names = interface_wheels(find_course(tmp_path), [b"Nothing about it."], environment=added)

    assert {package_of(name) for name in names} == {"tf2_msgs", "robot_interfaces"}


def test_faults_name_the_chapter_and_its_line(tmp_path: Path) -> None:
    wrong = '# One\n\n```text title="msg/Limits.msg"\nstring name\nfloat lower\n```\n'
    course = CourseFolder(tmp_path).write(one=wrong)

    for verb in ("build", "lint", "package"):
        said = course.spinbook(verb)
        assert said.returncode == 1
        assert "chapters/one.md:5: error: `float` is not a type.\n    ROS 2 calls it float32." in (
            said.stdout + said.stderr
        )


def test_a_chapter_may_import_what_another_one_defines_and_nothing_else(tmp_path: Path) -> None:
    first = '# One\n\n```text title="msg/Limits.msg"\nstring name\n```\n'
    second = "# Two\n\n```python\nfrom robot_interfaces.msg import Limits\n```\n"
    course = CourseFolder(tmp_path).write(one=first, two=second)

    assert course.spinbook("lint").returncode == 0

    course.write(two=second.replace("Limits", "Limit"))
    said = course.spinbook("lint").stdout
    assert "chapters/two.md:4: not run: `robot_interfaces.msg` has no `Limit`.\n    Did you mean `Limits`?" in said


def test_the_folder_interfaces_holds_definitions_too(tmp_path: Path) -> None:
    course = CourseFolder(tmp_path).write(one="# One\n\n```python\nfrom arm_msgs.msg import Joint\n```\n")
    folder = tmp_path / "interfaces" / "arm_msgs" / "msg"
    folder.mkdir(parents=True)
    (folder / "Joint.msg").write_text("string name\nfloat64 name\n")

    said = course.spinbook("lint")
    assert "interfaces/arm_msgs/msg/Joint.msg:2: error: the name `name` is already taken in line 1." in said.stdout

    (folder / "Joint.msg").write_text("string name\n")
    assert course.spinbook("lint").returncode == 0
    listed = course.spinbook("interfaces", "list").stdout
    assert listed.splitlines()[0].split() == ["arm_msgs/msg/Joint", "interfaces/arm_msgs/msg/Joint.msg:1"]


def test_a_package_that_can_be_added_is_named(tmp_path: Path) -> None:
    text = '# One\n\n```text title="msg/A.msg"\ncontrol_msgs/JointTolerance t\n```\n'
    course = CourseFolder(tmp_path).write(one=text)

    said = course.spinbook("interfaces", "build")

    if "interface_compiler add" in said.stderr:  # unless this environment has it
        assert "chapters/one.md:4: error: `control_msgs/JointTolerance` needs the package control_msgs" in said.stderr
        assert "interface_compiler add control_msgs" in said.stderr
    else:
        assert said.returncode == 0
    unknown = course.spinbook("interfaces", "add", "nopkg_msgs")
    assert unknown.returncode == 1
    assert unknown.stderr.startswith("There is no package 'nopkg_msgs' to add.")


def test_adding_a_package_says_what_it_does_before_it_takes_its_time(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(command, "is_current", lambda package: package == "turtlesim")
    monkeypatch.setattr(command, "install", lambda package: print(f"(gcc works on {package})"))

    said = CliRunner().invoke(command.interfaces, ["add", "turtlesim", "tf2_msgs"])

    assert said.output.splitlines() == [
        "turtlesim: is installed",
        "tf2_msgs: compiling 4 interfaces",
        "(gcc works on tf2_msgs)",
        "tf2_msgs: compiled and installed",
    ]


EXERCISE = {
    "exercises/width/exercise.toml": (
        'title = "Width"\npoints = 10\nfile = "width.py"\nclass = "Width"\nnode = "width"\n'
        '[[subscribe]]\ntopic = "/limits"\ntype = "robot_interfaces/msg/Limits"\n'
        '[[publish]]\ntopic = "/widths"\ntype = "robot_interfaces/msg/Limits"\n'
    ),
    "exercises/width/task.md": "# Width\n\nDouble it.\n",
    "exercises/width/scenarios.py": (
        "from grader.scenario import Scenario\n"
        "from grader.scenario.numbers import numbers, wave\n"
        "from grader.scenario.times import every\n\n\n"
        "def scenarios(seed):\n"
        '    kind = "robot_interfaces/msg/Limits"\n'
        '    stream = numbers("/limits", wave(1.0, every(0.1, 1)), kind, "lower", name="hip")\n'
        '    return (Scenario("swing", "limits that change", stream),)\n'
    ),
    "exercises/width/checks.py": (
        "from grader.checking import check, fail\n\n\n"
        '@check(points=10, hint="times two")\n'
        "def test_width(swing):\n"
        '    """It is doubled."""\n'
        "    swing.must_answer()\n"
        "    for exchange in swing:\n"
        '        if exchange.answers[0].value("lower") != 2 * exchange.sent.value("lower"):\n'
        '            fail("It is not doubled.", expected="twice", got="something else")\n'
    ),
    "solutions/width/solution.py": (
        "import rclpy\nfrom rclpy.node import Node\nfrom robot_interfaces.msg import Limits\n\n\n"
        "class Width(Node):\n"
        "    def __init__(self):\n"
        '        super().__init__("width")\n'
        '        self.publisher = self.create_publisher(Limits, "/widths", 10)\n'
        '        self.create_subscription(Limits, "/limits", self.hear, 10)\n\n'
        "    def hear(self, limits):\n"
        "        # BEGIN SOLUTION\n"
        "        self.publisher.publish(Limits(name=limits.name, lower=2 * limits.lower))\n"
        "        # END SOLUTION\n\n\n"
        "def main():\n    rclpy.init()\n    rclpy.spin(Width())\n\n\n"
        'if __name__ == "__main__":\n    main()\n'
    ),
}


def test_an_exercise_on_a_message_of_the_course_is_graded_in_the_sandbox(
    built: CourseFolder, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("SPINBOOK_CACHE", str(tmp_path / "cache"))
    for name, text in EXERCISE.items():
        (built.root / name).parent.mkdir(parents=True, exist_ok=True)
        (built.root / name).write_text(text)
    wrong = tmp_path / "wrong.py"
    wrong.write_text(EXERCISE["solutions/width/solution.py"].replace("2 * limits", "3 * limits"))

    right = built.spinbook("grade", "exercises/width", "solutions/width/solution.py")
    other = built.spinbook("grade", "exercises/width", str(wrong))

    assert "10 of 10 points" in right.stdout, right.stderr
    assert "0 of 10 points" in other.stdout
    assert "It is not doubled." in other.stdout


def test_an_exercise_on_a_message_that_was_not_compiled_says_what_to_do(tmp_path: Path) -> None:
    course = CourseFolder(tmp_path).write(one="# One\n")
    for name, text in EXERCISE.items():
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text(text)

    said = course.spinbook("grade", "exercises/width", "solutions/width/solution.py")

    assert "the package robot_interfaces is not installed here" in said.stderr
    assert "spinbook build" in said.stderr


def test_grading_compiles_what_the_exercise_uses_in_a_course_that_was_never_built(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("SPINBOOK_CACHE", str(tmp_path / "cache"))
    folder = tmp_path / "course"
    definition = '# One\n\n```text title="msg/Limits.msg"\nstring name\nfloat64 lower\n```\n'
    course = CourseFolder(folder).write(one=definition)
    for name, text in EXERCISE.items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_text(text)
    words = ("grade", "width", "solutions/width/solution.py")
    announced = "Compiling the course's interfaces, once (robot_interfaces) ..."

    with monkeypatch.context() as without:
        without.setenv("PATH", without_compilers(tmp_path / "programs"))
        impossible = course.spinbook(*words)
    first, second = course.spinbook(*words), course.spinbook(*words)

    assert impossible.returncode == 3
    assert "course.toml: error: the course's interfaces (robot_interfaces) can't be compiled." in impossible.stderr
    assert "Interfaces are compiled with gcc and g++, not found here: sudo apt-get install g++" in impossible.stderr
    assert "Traceback" not in impossible.stderr
    assert "10 of 10 points" in first.stdout, first.stderr
    assert announced in first.stderr
    assert "10 of 10 points" in second.stdout
    assert announced not in second.stderr


def test_lint_compiles_what_an_exercise_needs_to_be_read(tmp_path: Path) -> None:
    definition = '# One\n\n```text title="msg/Limits.msg"\nstring name\nfloat64 lower\n```\n'
    course = CourseFolder(tmp_path).write(one=definition)
    assert course.spinbook("lint").returncode == 0
    assert not (tmp_path / "build").exists()
    for name, text in EXERCISE.items():
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text(text)

    said = course.spinbook("lint")

    assert said.stdout.splitlines()[-1] == "0 errors, 0 warnings", said.stdout + said.stderr


@pytest.mark.skipif(prefixes.prefix_of("control_msgs", prefixes.installed()) is not None, reason="it is installed here")
def test_an_exercise_on_a_package_that_can_be_added_says_how(tmp_path: Path) -> None:
    for name, text in EXERCISE.items():
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text(text.replace("robot_interfaces/msg/Limits", "control_msgs/msg/JointTolerance"))

    with pytest.raises(ExerciseError, match="Compile it, once: python -m interface_compiler add control_msgs"):
        load(tmp_path / "exercises" / "width")


def test_a_student_without_a_package_is_told_to_install_what_came_with_the_handout(tmp_path: Path) -> None:
    for name, text in EXERCISE.items():
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text(text.replace("robot_interfaces", "absent_interfaces"))
    (tmp_path / "exercises" / "width" / "public.json").write_text("{}")

    with pytest.raises(ExerciseError) as caught:
        load(tmp_path / "exercises" / "width")

    assert "the package absent_interfaces is not installed here" in str(caught.value)
    assert "It comes with the handout. In the handout's folder: .venv/bin/pip install -r requirements.txt." in str(
        caught.value
    )
    assert "spinbook build" not in str(caught.value)


def test_what_asks_for_an_interface_that_the_course_lacks_is_shown_with_the_remedy(tmp_path: Path) -> None:
    definition = '# One\n\n```text title="srv/Grip.srv"\nfloat64 force\n---\nbool held\n```\n'
    there = "```bash\nros2 interface show robot_interfaces/srv/Grip\n```\n"
    wrong = there.replace("Grip", "Gripp")
    optional = there.replace("robot_interfaces/srv/Grip", "control_msgs/srv/QueryCalibrationState")
    course = CourseFolder(tmp_path).write(one=f"{definition}\n{there}\n{wrong}\n{optional}")

    said = course.spinbook("lint").stdout
    assert "1 shell, 1 interface, 2 fences shown and not run" in said
    assert "`robot_interfaces/srv` has no `Gripp`" in said
    assert "Compile it, once: spinbook interfaces add control_msgs" in said


def test_a_build_of_a_package_of_interfaces_is_not_run_as_it_is_compiled_here(tmp_path: Path) -> None:
    definition = '# One\n\n```text title="srv/Grip.srv"\nfloat64 force\n---\nbool held\n```\n'
    build = "```bash\ncolcon build --packages-select robot_interfaces\n```\n"
    course = CourseFolder(tmp_path).write(one=f"{definition}\n{build}", two=f"# Two\n\n{build}")

    said = course.spinbook("lint", "--static").stdout
    assert "chapters/one.md:9: bash: it makes a package of interfaces, which is compiled here" in said
    assert "chapters/two.md:3: bash: it makes a package of interfaces, which is compiled here" in said
    assert "0 errors, 0 warnings" in said
