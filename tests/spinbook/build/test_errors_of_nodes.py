"""What goes wrong in a node after its cell is reported: in the notebook, by `build --execute`, and on the site."""

from __future__ import annotations

import re
import subprocess
import textwrap
from dataclasses import dataclass
from pathlib import Path

import pytest
from course_folder import CourseFolder

from spinbook.build.failures import find_node_errors, node_errors
from spinbook.kernel.node_errors import ERROR, NodeError

#: A node that does BODY in its timer's third call, and AFTER when it is stopped.
PROGRAM = """import os
import signal
import sys
import threading

import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node


class Pump(Node):
    def __init__(self):
        super().__init__("NAME")
        self.calls = 0
        self.create_timer(0.2, self.tick)

    def tick(self):
        self.calls += 1
        self.get_logger().info(f"call {self.calls}")
        if self.calls == 3:
            BODY


def main():
    rclpy.init()
    try:
        rclpy.spin(Pump())
    except (KeyboardInterrupt, ExternalShutdownException):
        AFTER


if __name__ == "__main__":
    main()
"""


def pump(name: str, body: str = "pass", after: str = "pass", words: str = "until='call 1'") -> str:
    """Return a fence with a node."""
    code = PROGRAM.replace("Pump", name.title()).replace("NAME", name).replace("BODY", body).replace("AFTER", after)
    return f'```python title="{name}.py" {words} seconds=30\n{code}```\n'


def line_of(text: str, *parts: str) -> int:
    """Return the number of the line in which the last of these parts is, each after the one before, counted from 1."""
    place = 0
    for part in parts:
        place = text.index(part, place)
    return text[:place].count("\n") + 1


SLEEP = "```python\nimport time\ntime.sleep(1.5)\n```\n"
SNIPPET = "def work():\n    raise LookupError(4)\n\nthread = threading.Thread(target=work)\n"
LAUNCH = textwrap.dedent(
    """
    ```python title="launch/line.launch.py"
    from launch import LaunchDescription
    from launch_ros.actions import Node

    def generate_launch_description():
        return LaunchDescription([Node(package="robot", executable="belt")])
    ```

    ```bash
    colcon build
    ```

    ```bash until="call 1" seconds=30
    ros2 launch robot line.launch.py
    ```
    """
)
CHAPTERS = {
    "callback": f"# One\n\n{pump('valve', 'raise ValueError(7 * 6)')}\n{SLEEP}\n```bash\nros2 node list\n```\n\n"
    f"{pump('calm', words='expect-error')}",
    "various": "\n".join(
        [
            "# One\n",
            pump("pipe", "os.kill(os.getpid(), signal.SIGABRT)"),
            pump("drain", "self.get_logger().fatal(chr(42)); sys.exit(0)"),
            pump("tank", "threading.Thread(target=lambda: {}[1]).start()"),
            pump("lid", after="raise OSError(5)"),
            pump("motor", "raise KeyError(9)").replace("import sys", "import sys; sys.argv[1]"),
            '```bash until="call 1" seconds=30\nros2 run robot motor fast\n```\n',
            pump("belt", "raise RuntimeError(3)"),
            LAUNCH,
            f"```python\nimport threading\n\n{SNIPPET}thread.start()\nthread.join()\n```\n",
            f"```python\n!exit 3\n%cd no_such_folder\nlines = !exit 4\n```\n\n{SLEEP}",
        ]
    ),
    "plain": f"# One\n\n{pump('quiet', after='raise')}\n{pump('second')}\n"
    f"{pump('fuse', 'raise ValueError(1)', words='expect-error')}\n{SLEEP}",
}


@dataclass(frozen=True)
class BuiltCourse:
    """A course after `build --execute`, and what that said."""

    folder: CourseFolder
    said: subprocess.CompletedProcess[str]

    def reported(self, chapter: str) -> str:
        """Return what was said about a chapter."""
        notebook = self.folder.notebook(chapter, "executed")
        return "\n".join(str(error) for error in find_node_errors(Path(f"chapters/{chapter}.md"), notebook))


@pytest.fixture(scope="module")
def built(tmp_path_factory: pytest.TempPathFactory) -> BuiltCourse:
    folder = CourseFolder(tmp_path_factory.mktemp("course")).write(**CHAPTERS)
    return BuiltCourse(folder, folder.spinbook("build", "--execute", "--jobs", "10"))


@pytest.mark.parametrize(
    ("chapter", "parts", "words"),
    [
        ("callback", ["raise ValueError"], "valve went wrong: ValueError: 42. It ended with exit code 1."),
        ("various", ["pipe.py", "import os"], "pipe went wrong: It was ended by signal 6 (SIGABRT)."),
        ("various", ["drain.py", "import os"], "drain went wrong: it logged FATAL: *."),
        ("various", ["tank.py", "threading.Thread("], "tank went wrong: KeyError: 1."),
        ("various", ["raise LookupError"], "thread work went wrong: LookupError: 4."),
        ("various", ["!exit 3"], "!exit 3 went wrong: It ended with exit code 3."),
        ("various", ["!exit 3"], "%cd no_such_folder went wrong: No such file or directory: 'no_such_folder'."),
        ("various", ["raise OSError"], "lid went wrong: OSError: 5. It ended with exit code 1."),
        ("various", ["raise KeyError"], "motor went wrong: KeyError: 9. It ended with exit code 1."),
        ("various", ["raise RuntimeError"], "line went wrong: RuntimeError: 3"),
    ],
)
def test_an_error_after_the_cell_is_reported_with_file_and_line(
    built: BuiltCourse, chapter: str, parts: list[str], words: str
) -> None:
    place = f"chapters/{chapter}.md:{line_of(CHAPTERS[chapter], *parts)}: "

    assert f"{place}{words}" in built.said.stdout
    assert f"✗ {chapter}: ran in" in built.said.stdout
    assert "rclpy/executors.py" not in built.reported(chapter), "only the reader's own frames"


def test_nodes_that_end_with_ctrl_c_have_no_error_and_one_can_be_expected(built: BuiltCourse) -> None:
    assert "✓ plain: ran in" in built.said.stdout
    assert built.reported("plain") == ""
    assert "this cell says `expect-error`, but nothing went wrong" in built.reported("callback")


def test_errors_of_nodes_are_warnings_unless_strict(built: BuiltCourse) -> None:
    again = built.folder.spinbook("build", "--execute", "callback")
    strict = built.folder.spinbook("build", "--execute", "--strict", "callback")

    assert built.said.returncode == again.returncode == 0
    assert "✗ callback: unchanged since its last run" in again.stdout
    assert strict.returncode == 1
    assert "ValueError: 42" in strict.stdout


def test_an_error_that_a_node_repeats_is_reported_once() -> None:
    error = NodeError("lamp", "it logged ERROR: no power.")
    output = {
        "output_type": "display_data",
        "metadata": {ERROR: error.plain},
        "data": {"text/plain": error.in_words},
    }
    cells = [{"cell_type": "code", "source": "pass", "metadata": {}, "outputs": [output]} for _ in range(3)]

    (report,) = find_node_errors(Path("c.md"), {"cells": cells})

    assert report.what == "lamp went wrong: it logged ERROR: no power."


def test_the_notebook_shows_the_error_in_the_next_cell_that_runs(built: BuiltCourse) -> None:
    cells = [cell for cell in built.folder.notebook("callback", "executed").cells if node_errors(cell)]

    assert [cell.source.split("\n")[0] for cell in cells] == ["import time"]
    assert node_errors(cells[0])[0]["words"].startswith("✗ valve: valve.py, line 22: ValueError: 42."), "as in the cell"


def test_the_site_marks_the_chapter_and_the_output(built: BuiltCourse) -> None:
    assert built.folder.spinbook("site", "--no-run").returncode == 0
    site = built.folder.root / "build" / "site"
    page, home = (site / "chapters" / "callback.html").read_text(), (site / "index.html").read_text()

    assert re.search(r'✗ Something went wrong when this chapter ran: <a href="#(wrong-code-\w+)">see its output', page)
    assert re.search(r'id="wrong-code-\w+">✗ Output: something went wrong</p>', page)
    assert "✗ valve: valve.py, line 21: ValueError: 42." in page, "as in the page's editor, without %%node"
    assert home.count("✗ Something went wrong when this chapter ran.") == 2
    assert "went-wrong" not in (site / "chapters" / "plain.html").read_text()
