"""A terminal's transcript runs its commands, and what the author's terminal printed is shown below as text."""

from __future__ import annotations

from pathlib import Path

import pytest
from fences import cells, read, reading

from groundwork.problem import Severity
from spinbook.chapter.chapter import ChapterCell
from spinbook.chapter.classify import CellKind
from spinbook.chapter.terminal import CommandKind


def commands(cell: ChapterCell) -> list[str]:
    return [command.text for command in cell.commands if command.kind is not CommandKind.NOTE]


def printed(cells: tuple[ChapterCell, ...]) -> str:
    _, mark, text = cells[-1].source.partition("In the author's terminal:\n\n````text\n")
    return text.removesuffix("\n````") if mark else ""


@pytest.mark.parametrize("language", ["bash", "console", "text", ""])
@pytest.mark.parametrize(
    "prompt",
    [
        "$ ",
        "~/ros2_ws$ ",
        "~/ros2_ws $ ",
        "eva@desk ~/ws> ",
        "bash-5.2# ",
        "ros2_ws$ ",
        "eva@desk:~$ ",
        "(venv) eva@desk:~/ws$ ",
        "[eva@desk ws]$ ",
        "root@c1:/# ",
        "╰─❯ ",
        "~/ws ❯ ",
        "> ",
        "% ",
        "eva@mac ws % ",
        "PS C:\\ws> ",
        "➜  ws ",
    ],
)
def test_a_prompt_marks_a_command_and_the_rest_was_printed(tmp_path: Path, prompt: str, language: str) -> None:
    chapter = read(tmp_path, f"```{language}\n{prompt}ros2 topic list\n/clock\n/rosout\n```\n")

    assert [commands(cell) for cell in cells(chapter)] == [["ros2 topic list"]]
    assert printed(chapter.cells) == "/clock\n/rosout"
    assert "/clock" not in cells(chapter)[0].source


@pytest.mark.parametrize(
    "text",
    [
        "ros2 node list\n/hand\n/arm\n",
        "ros2 topic list -t\n/clock [rosgraph_msgs/msg/Clock]\n",
        "ros2 topic info /rosout\nType: rcl_interfaces/msg/Log\n\nPublisher count: 1\n",
        "ros2 run demo_nodes_cpp talker\n[INFO] [17.1] [talker]: Publishing: 'Hello World: 1'\nand more\n",
    ],
)
def test_what_only_a_ros_program_prints_needs_no_prompt_above_it(tmp_path: Path, text: str) -> None:
    chapter = read(tmp_path, f"```bash\n{text}```\n")

    command, _, rest = text.partition("\n")
    assert [commands(cell) for cell in cells(chapter)] == [[command]]
    assert printed(chapter.cells) == rest.rstrip("\n")


def test_a_command_may_go_on_behind_the_second_prompt(tmp_path: Path) -> None:
    text = "$ ros2 topic pub --once /a std_msgs/msg/String \\\n> 'data: hi'\npublisher: beginning loop\n"

    chapter = read(tmp_path, f"```bash\n{text}```\n")

    assert commands(cells(chapter)[0]) == ["ros2 topic pub --once /a std_msgs/msg/String 'data: hi'"]
    assert printed(chapter.cells) == "publisher: beginning loop"


def test_of_several_commands_each_is_above_what_it_printed(tmp_path: Path) -> None:
    text = "$ cd ws\n$ ros2 node list\n/a\n\n$ ros2 interface show std_msgs/msg/Bool\n# A bit\nbool data\n# end\n"

    chapter = read(tmp_path, f"```console\n{text}```\n")

    assert commands(cells(chapter)[0]) == ["ros2 node list", "ros2 interface show std_msgs/msg/Bool"]
    assert printed(chapter.cells) == (
        "$ ros2 node list\n/a\n\n$ ros2 interface show std_msgs/msg/Bool\n# A bit\nbool data\n# end"
    )


def test_a_problem_names_the_line_of_its_command(tmp_path: Path) -> None:
    result = reading(tmp_path, "```bash\n$ ros2 topic list\n/a\n/b\n$ ros2 run no_such_package a\n```\n")
    assert result.chapter is not None

    (problem,) = [item for item in result.problems if item.severity is Severity.NOT_RUN]
    assert problem.line == 7
    assert "/a\n/b\n" in result.chapter.cells[0].source


@pytest.mark.parametrize(
    "text",
    [
        "$ sudo apt update\nReading package lists... Done\n",
        "$ ls\nros2_ws\n",
        "cost$ 5\n",
    ],
)
def test_other_terminals_are_shown_as_they_are(tmp_path: Path, text: str) -> None:
    chapter = read(tmp_path, f"```bash\n{text}```\n")

    assert cells(chapter) == []
    assert text in chapter.cells[0].source


@pytest.mark.parametrize(
    ("text", "kind", "command"),
    [
        ("rqt_graph", CommandKind.GRAPH, "rqt_graph"),
        ("rqt_graph &", CommandKind.GRAPH, "rqt_graph"),
        ("ros2 run rqt_graph rqt_graph", CommandKind.GRAPH, "rqt_graph"),
        ("ros2 run rqt_plot rqt_plot /a/b", CommandKind.PLOT, "rqt_plot /a/b"),
        ("ros2 run demo_nodes_py talker &", CommandKind.ROS2, "ros2 run demo_nodes_py talker"),
    ],
)
def test_windows_are_drawn_in_the_cell(tmp_path: Path, text: str, kind: CommandKind, command: str) -> None:
    (cell,) = cells(read(tmp_path, f"```bash\n{text}\n```\n"))

    assert [(item.kind, item.text) for item in cell.commands] == [(kind, command)]


def test_a_plot_of_nothing_is_shown_only(tmp_path: Path) -> None:
    chapter = read(tmp_path, "```bash\nrqt_plot\n```\n")

    assert "rqt_plot needs a topic here" in chapter.static_fences[0].sign


def test_a_snippet_gets_the_usual_imports_once_and_keeps_its_lines(tmp_path: Path) -> None:
    first, second = cells(read(tmp_path, "a = np.eye(2)\nprint(Twist(), a)\n", "print(np.pi, a)\n"))

    assert first.shown == (
        "from geometry_msgs.msg import Twist\nimport numpy as np\n\na = np.eye(2)\nprint(Twist(), a)\n"
    )
    assert second.shown == "print(np.pi, a)\n"
    assert (first.kind, first.line) == (CellKind.SNIPPET, 4)


@pytest.mark.parametrize(
    "code",
    [
        "class P(Node):\n    def __init__(self):\n        super().__init__('p')\n"
        "        self.declare_parameter('v', 1, ParameterDescriptor(type=ParameterType.PARAMETER_INTEGER))\n",
        "class Q(Node):\n    def __init__(self):\n        super().__init__('q')\n"
        "        print(inspect.signature(self.go), partial(self.go), GoalStatus.STATUS_ABORTED)\n\n"
        "    def go(self, goal: ServerGoalHandle):\n        goal.succeed()\n",
    ],
)
def test_a_node_gets_the_names_that_tutorials_use(tmp_path: Path, code: str) -> None:
    (node,) = cells(read(tmp_path, code))

    assert node.kind is CellKind.NODE


@pytest.mark.parametrize("language", ["powershell", "ps1", "pwsh"])
def test_a_terminal_of_windows_runs_ros_commands(tmp_path: Path, language: str) -> None:
    chapter = read(tmp_path, f"```{language}\nPS C:\\ws> ros2 node list\n/arm\n```\n")

    assert [commands(cell) for cell in cells(chapter)] == [["ros2 node list"]]
    assert printed(chapter.cells) == "/arm"


@pytest.mark.parametrize("language", ["python", "pycon", "text", "", "ipython"])
@pytest.mark.parametrize("prompts", [(">>>", "...", ""), ("In [12]:", "    ...:", "Out[12]: ")])
def test_a_session_of_python_runs_as_a_snippet(tmp_path: Path, language: str, prompts: tuple[str, str, str]) -> None:
    first, more, out = prompts
    text = f"{first} for i in range(2):\n{more}     print(i)\n{more}\n0\n1\n{first} i + 1\n{out}2\n"

    chapter = read(tmp_path, f"```{language}\n{text}```\n")

    (snippet,) = cells(chapter)
    assert (snippet.kind, " ".join(snippet.source.split())) == (CellKind.SNIPPET, "for i in range(2): print(i) i + 1")
    assert printed(chapter.cells) == f"0\n1\n{out}2"


def test_a_cell_that_jupyter_runs_in_a_shell_is_one_for_the_terminal(tmp_path: Path) -> None:
    (cell,) = cells(read(tmp_path, "```{code-cell} ipython3\n%%bash\nros2 node list\n```\n"))

    assert (cell.line, commands(cell)) == (5, ["ros2 node list"])


def test_commands_that_no_rule_understands_are_reported(tmp_path: Path) -> None:
    (problem,) = reading(tmp_path, "```bash\nTerminal 1: ros2 run demo_nodes_py talker\n```\n").problems

    assert problem.problem.startswith("this shell fence is shown and not run")
