"""`ros2 run` and `ros2 launch` start what the chapter shows under that name, all of it or nothing."""

from __future__ import annotations

from pathlib import Path

import pytest
from fences import GUARD, IMPORTS, cells, read, reading

from groundwork.problem import Severity
from spinbook.chapter.classify import CellKind

CREATE = "```bash\nros2 pkg create --build-type ament_python bench\n```\n"


def node(name: str, cls: str = "Ticker") -> str:
    return (
        f"{IMPORTS}class {cls}(Node):\n    def __init__(self):\n        super().__init__('{name}')\n\n\n"
        f"def main():\n    rclpy.init()\n    rclpy.spin({cls}())\n\n\n{GUARD}"
    )


def named(file: str, code: str) -> str:
    return f'```python title="{file}"\n{code}```\n'


def shell(command: str) -> str:
    return f"```bash\n{command}\n```\n"


ENTRY = "'tock = bench.tock_tool:main'"


@pytest.mark.parametrize(
    "excerpt",
    [
        f"```python\n...\n    entry_points={{\n        'console_scripts': [\n            {ENTRY},\n"
        "        ],\n    },\n…\n```\n",
        f"```\n{ENTRY},\n```\n",
        f"```python\n        {ENTRY},\n```\n",
        f"```python\n        'console_scripts': [\n            {ENTRY},  # new\n```\n",
        f"- In setup.py:\n\n  ```python\n  entry_points={{'console_scripts': [{ENTRY}]}},\n  ```\n",
        "```python\nentry_points={'console_scripts': [f'tock = {package_name}.tock_tool:main']},\n```\n",
        "```python\nentry_points={'console_scripts': ['tock = ' + package_name + '.tock_tool:main']},\n```\n",
        "```ini\n[options.entry_points]\nconsole_scripts =\n    tock = bench.tock_tool:main\n```\n",
    ],
)
def test_an_excerpt_of_setup_py_names_the_program_however_it_is_cut_out(tmp_path: Path, excerpt: str) -> None:
    result = reading(tmp_path, CREATE, node("clock_face"), "```text\n```\n" + excerpt, shell("ros2 run bench tock"))
    assert result.chapter is not None

    _, ticker, run = cells(result.chapter)

    assert (ticker.executables, run.kind) == ((("bench", "tock"),), CellKind.SHELL)
    assert not any(problem.severity is Severity.NOT_RUN for problem in result.problems)


@pytest.mark.parametrize(
    "code",
    [
        "        super().__init__(name)\n\n\ndef main():\n    rclpy.init()\n    rclpy.spin(Bell('door_bell'))\n",
        "        Node.__init__(self, name)\n\n\ndef main():\n    rclpy.init()\n"
        "    rclpy.spin(Bell(name='door_bell'))\n",
        "        super().__init__(NAME)\n\n\nNAME = 'door_bell'\n\n\ndef main():\n    rclpy.init()\n"
        "    rclpy.spin(Bell('x'))\n",
    ],
)
def test_the_name_of_a_node_may_be_an_argument_or_a_constant(tmp_path: Path, code: str) -> None:
    bell = f"{IMPORTS}class Bell(Node):\n    def __init__(self, name):\n{code}"

    _, ringing, run = cells(read(tmp_path, CREATE, bell, shell("ros2 run bench door_bell")))

    assert ringing.executables == (("bench", "door_bell"),)
    assert run.kind is CellKind.SHELL


def test_a_name_that_differs_by_a_word_starts_the_only_such_node_and_says_so(tmp_path: Path) -> None:
    fences = [CREATE, named("wall_clock.py", node("wall_clock")), named("lamp.py", node("lamp"))]

    result = reading(tmp_path, *fences, shell("ros2 run bench clock"))
    assert result.chapter is not None

    assert cells(result.chapter)[1].executables == (("bench", "clock"),)
    (problem,) = result.problems
    assert problem.severity is Severity.WARNING
    assert "`wall_clock` is started" in problem.problem


@pytest.mark.parametrize(
    ("executable", "meant"),
    [("wall_clok", "wall_clock"), ("kitchen_clock", "wall_clock"), ("clock", "wall_clock")],
)
def test_otherwise_nothing_is_started_and_the_name_that_was_meant_is_suggested(
    tmp_path: Path, executable: str, meant: str
) -> None:
    fences = [CREATE, named("wall_clock.py", node("wall_clock")), named("tower_clock.py", node("tower_clock"))]

    result = reading(tmp_path, *fences, shell(f"ros2 run bench {executable}"))
    assert result.chapter is not None

    assert cells(result.chapter)[-1].kind is CellKind.NODE
    assert f"Did you mean `{meant}`?" in result.problems[-1].fix


def test_a_piece_of_a_launch_file_is_shown_without_a_word(tmp_path: Path) -> None:
    piece = "from launch_ros.actions import Node\n\nlamp = Node(package='bench', executable='lamp')\n"

    result = reading(tmp_path, piece)
    assert result.chapter is not None

    assert [(fence.why, fence.sign) for fence in result.chapter.static_fences] == [("it is a launch file", "")]
    assert result.problems == ()


def test_the_node_that_pkg_create_makes_can_be_run(tmp_path: Path) -> None:
    create = CREATE.replace("ros2 pkg create", "ros2 pkg create --node-name greeter")

    assert [cell.kind for cell in cells(read(tmp_path, create, shell("ros2 run bench greeter")))] == [
        CellKind.SHELL
    ] * 2


def test_a_program_that_reads_keys_does_not_keep_its_neighbours_from_running(tmp_path: Path) -> None:
    both = shell("ros2 run turtlesim turtlesim_node\n# Terminal 2\nros2 run turtlesim turtle_teleop_key")

    (cell,) = cells(read(tmp_path, both))

    assert [command.text for command in cell.commands] == [
        "ros2 run turtlesim turtlesim_node",
        "# Terminal 2",
        "# ros2 run turtlesim turtle_teleop_key (reads keys: run it in a terminal)",
    ]


def launch(body: str, imports: str = "") -> str:
    return (
        "```python\nfrom launch import LaunchDescription\nfrom launch_ros.actions import Node\n"
        f"{imports}\n\ndef generate_launch_description():\n{body}```\n"
    )


LAMP = "Node(package='bench', executable='lamp', output='screen')"


@pytest.mark.parametrize(
    ("body", "started"),
    [
        (f"    return LaunchDescription([{LAMP}])\n", "ros2 run bench lamp"),
        (f"    lamp = {LAMP}\n    plan = LaunchDescription()\n    plan.add_action(lamp)\n    return plan\n", ""),
        (
            "    where = DeclareLaunchArgument('where', default_value='hall')\n    return LaunchDescription([where,\n"
            "        Node(package='bench', executable='lamp', name=LaunchConfiguration('where'))])\n",
            "ros2 run bench lamp --ros-args -r __node:=hall",
        ),
    ],
)
def test_a_launch_file_that_only_starts_nodes_runs_whole(tmp_path: Path, body: str, started: str) -> None:
    fences = [CREATE, named("lamp.py", node("lamp")), launch(body)]

    *_, run = cells(read(tmp_path, *fences, shell("ros2 launch bench lamp.launch.py")))

    assert [command.text for command in run.commands][1:] == [started or "ros2 run bench lamp"]


@pytest.mark.parametrize(
    ("body", "why"),
    [
        (
            f"    return LaunchDescription([TimerAction(period=1.0, actions=[{LAMP}])])\n",
            "it uses `TimerAction` (line 6)",
        ),
        (f"    return LaunchDescription([{LAMP}, ExecuteProcess(cmd=['ls'])])\n", "it uses `ExecuteProcess` (line 6)"),
        (f"    return LaunchDescription([{LAMP[:-1]}, respawn=True)])\n", "it gives a node `respawn` (line 6)"),
        (f"    return LaunchDescription([{LAMP[:-1]}, name=get_name())])\n", "it uses `get_name` (line 6)"),
        (
            f"    return LaunchDescription([{LAMP[:-1]}, parameters=['p.yaml'])])\n",
            "it reads a file of parameters (line 6)",
        ),
        (f"    return LaunchDescription([{LAMP} for _ in range(2)])\n", "it has a loop or a condition (line 6)"),
    ],
)
def test_a_launch_file_that_does_more_starts_nothing_and_says_why(tmp_path: Path, body: str, why: str) -> None:
    fences = [CREATE, named("lamp.py", node("lamp")), launch(body), shell("ros2 launch bench lamp.launch.py")]

    chapter = read(tmp_path, *fences)

    assert chapter.static_fences[-1].sign == f"its launch file can't run here: {why}."
    assert cells(chapter)[-1].kind is CellKind.NODE


def test_a_launch_file_of_an_installed_package_runs(tmp_path: Path) -> None:
    files = [shell(f"ros2 launch turtlesim {name}.launch.py") for name in ("multisim", "multism")]

    chapter = read(tmp_path, *files)

    assert [cell.kind for cell in cells(chapter)] == [CellKind.SHELL]
    assert chapter.static_fences[-1].sign == "no fence above is its launch file."


def test_a_launch_file_of_another_name_is_not_taken_for_the_one_that_is_launched(tmp_path: Path) -> None:
    titled = launch(f"    return LaunchDescription([{LAMP}])\n").replace("python", 'python title="lamps.launch.py"', 1)

    result = reading(
        tmp_path, CREATE, named("lamp.py", node("lamp")), titled, shell("ros2 launch bench lamp.launch.py")
    )
    assert result.chapter is not None

    assert result.chapter.static_fences[-1].sign == "no fence above is its launch file."
    assert result.problems[-1].fix == "Did you mean `lamps.launch.py`?"


@pytest.mark.parametrize(
    ("title", "fix"),
    [
        ("line.launch.xml", 'Write title="launch/line.launch.xml", and ros2 launch robot line.launch.xml'),
        ("launch/line.launch.xml", "Write: ros2 launch robot line.launch.xml"),
    ],
)
def test_a_launch_file_that_another_package_has_comes_with_the_right_command(
    tmp_path: Path, title: str, fix: str
) -> None:
    shown = f'```xml title="{title}"\n<launch/>\n```\n'

    (problem,) = reading(tmp_path, CREATE, shown, shell("ros2 launch bench line.launch.xml")).problems

    assert problem.fix == fix


def test_a_launch_file_with_more_than_nodes_comes_with_the_title_that_runs_all_of_it(tmp_path: Path) -> None:
    start = "Node(package='robot', executable='bell')"
    shown = (
        "from launch import LaunchDescription\nfrom launch.actions import TimerAction\n"
        "from launch_ros.actions import Node\n\n\ndef generate_launch_description():\n"
        f"    return LaunchDescription([TimerAction(period=1.0, actions=[{start}])])\n"
    )

    (problem,) = reading(tmp_path, named("later.launch.py", shown), shell("ros2 launch robot later.launch.py")).problems

    assert (
        problem.fix == 'To run all of it, write title="launch/later.launch.py", and ros2 launch robot later.launch.py'
    )


WHOLE = launch(f"    return LaunchDescription([{LAMP}])\n").replace(
    "```python", '```python title="launch/lamp.launch.py"'
)
BUILD_AND_LAUNCH = shell("colcon build\nros2 launch robot lamp.launch.py")


@pytest.mark.parametrize(
    ("file", "package", "program", "fix"),
    [
        (
            launch(f"    return LaunchDescription([{LAMP}])\n"),
            "robot",
            "lmap",
            "Did you mean `lamp`? Its node cells make",
        ),
        (WHOLE, "robot", "lmap", "Did you mean `lamp`? Its node cells make"),
        (WHOLE, "turtlesim", "turtlesim_nod", "Did you mean `turtlesim_node`? It has these"),
        (WHOLE, "not_here", "bell", "Show its program in a fence of the chapter"),
        (
            '```xml title="launch/lamp.launch.xml"\n<launch>\n<node pkg="bench" exec="lamp"/>\n</launch>\n```\n',
            "robot",
            "lmap",
            "Did you mean `lamp`? Its node cells make",
        ),
    ],
)
def test_a_program_that_a_launch_file_lacks_is_named_with_the_one_that_was_meant(
    tmp_path: Path, file: str, package: str, program: str, fix: str
) -> None:
    file = file.replace("bench", package).replace("'lamp'", f"'{program}'").replace('"lamp"', f'"{program}"')
    run = BUILD_AND_LAUNCH.replace(".py", ".xml" if "<launch>" in file else ".py")

    (problem,) = reading(tmp_path, named("lamp.py", node("lamp")), file, run).problems

    assert problem.problem.startswith(f"its launch file starts `{program}` of `{package}`, but ")
    assert "(`ros2 launch robot lamp.launch." in problem.problem
    assert problem.fix.startswith(fix)


MAKE = "ros2 pkg create --build-type ament_python bench"


def test_files_that_a_terminal_writes_among_its_commands_are_programs_there(tmp_path: Path) -> None:
    typed = f"{MAKE}\ncat > lamp.py <<'EOF'\n{node('lamp')}EOF\nchmod +x lamp.py\nros2 run bench lamp\n"

    made, program, run = cells(read(tmp_path, shell(typed)))

    assert made.commands[0].text == MAKE
    assert (program.name, program.executables) == ("lamp", (("bench", "lamp"),))
    assert run.commands[-1].text == "ros2 run bench lamp"


def test_a_launch_file_starts_node_by_node_until_colcon_has_built_its_package(tmp_path: Path) -> None:
    whole = WHOLE.replace("bench", "robot")
    commands = shell("ros2 launch robot lamp.launch.py")

    *_, unbuilt, built = cells(
        read(tmp_path, named("lamp.py", node("lamp")), whole, commands, "# B\n", BUILD_AND_LAUNCH)
    )
    markup = '```xml title="launch/l.launch.xml"\n<launch/>\n```\n'
    (problem,) = reading(tmp_path, markup, shell("ros2 launch robot l.launch.xml")).problems

    assert unbuilt.commands[-1].text == "ros2 run robot lamp"
    assert built.commands[-1].text == "ros2 launch robot lamp.launch.py"
    assert problem.fix == "Put a shell fence with `colcon build` above it."


def test_a_launch_file_that_decides_what_it_starts_is_not_judged(tmp_path: Path) -> None:
    chosen = WHOLE.replace("bench", "rviz2").replace("output='screen'", "condition=IfCondition('false')")

    assert reading(tmp_path, named("lamp.py", node("lamp")), chosen, BUILD_AND_LAUNCH).problems == ()
