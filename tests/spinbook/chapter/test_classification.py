"""Every fence has the kind that its content shows; nothing that can't run becomes a code cell."""

from __future__ import annotations

from pathlib import Path

import pytest

from groundwork.problem import Severity
from spinbook.chapter.chapter import Chapter
from spinbook.chapter.classify import CellKind
from spinbook.chapter.read import read_chapter
from spinbook.chapter.surroundings import Surroundings

NODE = "import rclpy\nfrom rclpy.node import Node\nrclpy.init()\nnode = Node('talker')\nrclpy.spin(node)\n"


def read(tmp_path: Path, text: str) -> Chapter:
    (tmp_path / "c.md").write_text(text)
    reading = read_chapter(tmp_path, Path("c.md"), Surroundings("robot"))
    assert reading.chapter is not None, reading.problems
    return reading.chapter


def kinds(chapter: Chapter) -> list[CellKind]:
    return [cell.kind for cell in chapter.cells if cell.kind is not CellKind.PROSE]


@pytest.mark.parametrize(
    ("info", "code", "kind"),
    [
        ('python title="talker.py"', NODE, CellKind.NODE),
        ("python title='talker.py'", NODE, CellKind.NODE),
        ("python title=talker.py", NODE, CellKind.NODE),
        ('py title="src/talker.py"', NODE, CellKind.NODE),
        ("python", NODE, CellKind.NODE),
        ("{code-cell} python", NODE, CellKind.NODE),
        ('python title="a.py"', "from rclpy.node import Node\nclass A(Node):\n    pass\n", CellKind.NODE),
        ("python", "x = 1\nx\n", CellKind.SNIPPET),
        ("py", "x = 1\n", CellKind.SNIPPET),
        ("ipython3", "%plot /a/b\n", CellKind.SNIPPET),
        ("python", "print(\n    '%d of %d'\n    % (1, 2)\n)\n", CellKind.SNIPPET),
        ("python", "%stop --all\n", CellKind.SNIPPET),
        ("python", "def f():\n    return 1\nf()\n", CellKind.SNIPPET),
        ("python", "[i for i in range(3) if i]\n", CellKind.SNIPPET),
        ("bash", "ros2 topic list\n", CellKind.SHELL),
        ("console", "$ ros2 topic list\n", CellKind.SHELL),
        ("bash", "rqt_plot /a/b[0]\n", CellKind.SHELL),
        ("bash", "# a comment\nros2 node list\n", CellKind.SHELL),
        ("bash", 'ros2 topic pub --once /a std_msgs/msg/String "{data: a;b|c}"\n', CellKind.SHELL),
    ],
)
def test_what_can_run_becomes_a_cell(tmp_path: Path, info: str, code: str, kind: CellKind) -> None:
    assert kinds(read(tmp_path, f"# T\n\n```{info}\n{code}```\n")) == [kind]


@pytest.mark.parametrize(
    ("info", "code", "why"),
    [
        ("python", "    self.count += 1\n", "fragment"),
        ("python", "return 1\n", "fragment"),
        ("python", "node.get_logger().info('x')\n", "`node`"),
        ("python", "x = msg.position[0]\n", "`msg`"),
        ("python", "def f():\n    return undefined_thing\nf()\n", "`undefined_thing`"),
        ("python static", "x = 1\n", "static"),
        ('python title="setup.py"', "from setuptools import setup\nsetup(name='x')\n", "setup.py"),
        ('python title="a.launch.py"', "def generate_launch_description():\n    pass\n", "launch file"),
        ("python", "", "empty"),
        ("yaml", "a: 1\n", "neither Python nor shell"),
        ("", "text\n", "without a language"),
        ("bash", "sudo apt install x\n", "sudo"),
        ("bash", "cd x\n", "no command"),
        ("bash", "ros2 topic list > file\n", "redirections"),
        ("bash", "ros2 bag record -a\n", "ros2 bag"),
        ("cpp", "int main() {}\n", "neither"),
    ],
)
def test_what_cannot_run_is_shown_with_a_reason(tmp_path: Path, info: str, code: str, why: str) -> None:
    chapter = read(tmp_path, f"# T\n\n```{info}\n{code}```\n")

    assert kinds(chapter) == []
    assert [why in fence.why for fence in chapter.static_fences] == [True]
    assert code.rstrip("\n") in "\n".join(cell.source for cell in chapter.cells), "it stays in the prose"


@pytest.mark.parametrize(
    ("title", "meant"),
    [
        ("joint-limits.srv", "srv/JointLimits.srv"),
        ("my-msgs/msg/Limits.msg", "my_msgs/msg/Limits.msg"),
    ],
)
def test_a_definition_whose_title_names_no_interface_comes_with_the_one_that_was_meant(
    tmp_path: Path, title: str, meant: str
) -> None:
    (tmp_path / "c.md").write_text(f'# C\n\n```text title="{title}"\nfloat64 x\n```\n')

    (problem,) = read_chapter(tmp_path, Path("c.md"), Surroundings("robot")).problems

    assert (problem.line, problem.severity) == (3, Severity.NOT_RUN)
    assert f'Write title="{meant}"' in problem.fix


def test_a_snippet_may_use_what_earlier_snippets_defined(tmp_path: Path) -> None:
    chapter = read(tmp_path, "# T\n\n```python\nx = 1\n```\n\n```python\nx + 1\n```\n")

    assert kinds(chapter) == [CellKind.SNIPPET, CellKind.SNIPPET]


def test_what_a_node_defines_is_not_in_the_kernel(tmp_path: Path) -> None:
    chapter = read(tmp_path, f'# T\n\n```python title="a.py"\n{NODE}```\n\n```python\nnode\n```\n')

    assert kinds(chapter) == [CellKind.NODE]


def test_a_nodes_code_is_kept_to_the_byte(tmp_path: Path) -> None:
    code = "# umlaut ä, tab\there, trailing space \n\n\n" + NODE + "\n# the end\n"

    chapter = read(tmp_path, f'# T\n\n```python title="a.py"\n{code}```\n')

    assert [cell.source for cell in chapter.nodes] == [code]


def test_attributes_of_a_fence_reach_its_cell(tmp_path: Path) -> None:
    (cell,) = read(tmp_path, f'# T\n\n```python title="a.py" seconds=4.5 raises\n{NODE}```\n').nodes

    assert (cell.name, cell.seconds, cell.raises, cell.line) == ("a", 4.5, True, 4)


def test_a_myst_code_cells_options_are_read_and_left_out_of_its_code(tmp_path: Path) -> None:
    text = "# T\n\n```{code-cell} python\n:tags: [raises-exception]\n1 / 0\n```\n"

    cell = read(tmp_path, text).cells[-1]

    assert (cell.kind, cell.source, cell.raises, cell.line) == (CellKind.SNIPPET, "1 / 0\n", True, 5)


def test_a_class_without_a_main_is_spun_by_the_runtime(tmp_path: Path) -> None:
    code = "from rclpy.node import Node\nclass Silent(Node):\n    pass\n"

    (cell,) = read(tmp_path, f'# T\n\n```python title="silent.py"\n{code}```\n').nodes

    assert cell.spin_classes == ("Silent",)


def test_lines_of_cells_are_the_chapters_lines(tmp_path: Path) -> None:
    text = (
        "---\ntitle: x\n---\n\n# T\n\n```yaml\na: 1\n\n\nb: 2\n```\n\n## A\n\n```python\nx = 1\n```\n\ntext\n\n## B\n"
    )
    lines = text.split("\n")

    for cell in read(tmp_path, text).cells:
        assert cell.source.split("\n")[0] == lines[cell.line - 1]


def test_a_continued_command_is_one_command(tmp_path: Path) -> None:
    text = "# T\n\n```bash\nros2 topic pub --once /a \\\n  std_msgs/msg/String \\\n  \"{data: 'x'}\"\n```\n"

    (command,) = read(tmp_path, text).cells[-1].commands

    assert command.words == ("ros2", "topic", "pub", "--once", "/a", "std_msgs/msg/String", "{data: 'x'}")


@pytest.mark.parametrize(
    "info",
    [
        'python {linenos=true,filename="arm.py"}',
        "python [arm.py]",
        'py3 {title="arm.py"}',
        '{.python #lst-arm filename="arm.py"}',
        'python {1,3} title="arm.py"',
    ],
)
def test_a_file_is_named_as_each_book_tool_does(tmp_path: Path, info: str) -> None:
    assert read(tmp_path, f"```{info}\n{NODE}```\n").cells[-1].name == "arm"


def test_options_of_a_quarto_cell_may_be_in_its_braces(tmp_path: Path) -> None:
    skipped = "```{python, eval=FALSE}\n1 / 0\n```\n\n"

    chapter = read(tmp_path, f"{skipped}```{{python}}\n#| filename: arm.py\n{NODE}```\n")

    assert [(cell.name, cell.tags) for cell in chapter.cells[1:]] == [(None, ("skip-execution",)), ("arm", ())]


@pytest.mark.parametrize("info", ["{.sourceCode .py}", "{#first .sourceCode .python .numberLines}", "pyhton", "ros2"])
def test_a_program_is_one_however_its_language_is_written(tmp_path: Path, info: str) -> None:
    *_, cell = read(tmp_path, f"# C\n\n``` {info}\n{NODE}```\n").cells

    assert (cell.kind, cell.name) == (CellKind.NODE, "talker")


@pytest.mark.parametrize(("language", "kind"), [("linux", CellKind.SHELL), ("input", CellKind.SHELL), ("output", None)])
def test_commands_run_in_a_language_that_nobody_knows_but_not_in_an_output(
    tmp_path: Path, language: str, kind: CellKind | None
) -> None:
    kinds = [cell.kind for cell in read(tmp_path, f"# C\n\n```{language}\nros2 node list\n```\n").cells]

    assert kinds[1:] == ([kind] if kind else [])
