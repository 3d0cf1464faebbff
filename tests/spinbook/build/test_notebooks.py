"""Chapters become valid notebooks whose bytes and ids stay the same from build to build."""

from __future__ import annotations

import os
import re
import subprocess
import sys

import nbformat
import pytest
from course_folder import CourseFolder

NODE = "import rclpy\nrclpy.init()\nrclpy.spin(rclpy.create_node('talker'))\n"
CHAPTER = f"""---
title: A chapter
---

# Nodes

Some prose.

```python title="talker.py" seconds=2
{NODE}```

## See it

```bash seconds=3
cd humanoid_ws
ros2 topic hz /rosout
```

```python
x = 1
```

> [!NOTE]
> Remember.

```yaml
# not a heading
a: 1
```

```python raises
1 / 0
```
"""


def sources(course: CourseFolder, name: str = "one") -> dict[str, str]:
    return {cell.id: cell.source for cell in course.notebook(name).cells}


def test_cells_are_what_the_chapter_says_with_ids_that_can_be_read(course: CourseFolder) -> None:
    course.write(one=CHAPTER).spinbook("build")

    cells = sources(course)

    assert list(cells) == [
        "nodes",
        "spinbook-setup",
        "node-talker",
        "see-it",
        "ros2-topic-hz-rosout",
        "code-see-it",
        "see-it-2",
        "code-see-it-2",
    ]
    assert cells["node-talker"] == f"%%node talker --seconds 2\n{NODE}".rstrip("\n")
    assert cells["ros2-topic-hz-rosout"] == "# cd humanoid_ws\n%ros2 --seconds 3 topic hz /rosout"
    assert cells["see-it-2"] == "> **Note**\n>\n> Remember.\n\n```yaml\n# not a heading\na: 1\n```"


def test_a_notebook_is_valid_and_names_its_kernel_and_where_each_cell_comes_from(course: CourseFolder) -> None:
    more_bash_than_python = CHAPTER + "\n```bash\nros2 node list\n```\n" * 9
    course.write(one=more_bash_than_python).spinbook("build")

    notebook = course.notebook("one")

    nbformat.validate(notebook)
    assert notebook.metadata.kernelspec.name == "python3"
    lines = more_bash_than_python.split("\n")
    code = {cell.id: cell for cell in notebook.cells if cell.cell_type == "code"}
    assert lines[code["node-talker"].metadata.spinbook.line - 1] == "import rclpy"
    assert code["code-see-it-2"].metadata.tags == ["raises-exception"]
    assert all(re.fullmatch(r"[A-Za-z0-9_-]{1,64}", cell.id) for cell in notebook.cells)


def test_two_builds_are_identical_to_the_byte(course: CourseFolder) -> None:
    file = course.root / "build/notebooks/one.ipynb"
    course.write(one=CHAPTER, two=CHAPTER.replace("talker", "other")).spinbook("build")
    first = file.read_bytes()
    file.unlink()

    # Another hash seed, and files that are found in another order.
    os.rename(course.root / "chapters/one.md", course.root / "chapters/x.md")  # noqa: PTH104
    os.rename(course.root / "chapters/x.md", course.root / "chapters/one.md")  # noqa: PTH104
    subprocess.run(
        [sys.executable, "-m", "spinbook", "build"],
        cwd=course.root,
        env={**os.environ, "PYTHONHASHSEED": "7"},
        check=True,
    )

    assert file.read_bytes() == first


def test_ids_of_other_sections_stay_when_a_cell_is_added(course: CourseFolder) -> None:
    course.write(one=CHAPTER).spinbook("build")
    before = set(sources(course))

    course.write(one=CHAPTER.replace("Some prose.", "Some prose.\n\n```python\ny = 2\n```\n")).spinbook("build")

    assert set(sources(course)) - before == {"code-nodes"}
    assert before <= set(sources(course))


def test_an_unchanged_chapter_is_not_built_again(course: CourseFolder) -> None:
    course.write(one=CHAPTER, two="# Two\n").spinbook("build")
    written = (course.root / "build/notebooks/one.ipynb").stat().st_mtime_ns

    said = course.write(two="# Two, changed\n").spinbook("build")

    assert "1 built, 1 unchanged" in said.stdout
    assert (course.root / "build/notebooks/one.ipynb").stat().st_mtime_ns == written


def test_a_deleted_notebook_is_built_again(course: CourseFolder) -> None:
    course.write(one=CHAPTER).spinbook("build")
    (course.root / "build/notebooks/one.ipynb").unlink()

    assert "1 built" in course.spinbook("build").stdout
    assert course.notebook("one").cells


def test_warnings_are_reported_again_while_the_chapter_stays_as_it_is(course: CourseFolder) -> None:
    course.write(one=b"# One\r\n")

    assert course.spinbook("build").stdout.replace("1 built, 0 un", "0 built, 1 un") == course.spinbook("build").stdout


def test_notebooks_of_chapters_that_left_the_course_go(course: CourseFolder) -> None:
    course.write(one=CHAPTER, two="# Two\n").spinbook("build")
    (course.root / "chapters/two.md").unlink()

    course.write().spinbook("build")

    assert [file.name for file in (course.root / "build/notebooks").iterdir()] == ["one.ipynb"]


def test_a_chapter_may_import_what_another_chapters_node_defines(course: CourseFolder) -> None:
    course.write(
        one=CHAPTER,
        two='# Two\n\n```python title="user.py"\nfrom robot.talker import x\nimport rclpy\nrclpy.spin(x)\n```\n',
    )

    assert course.spinbook("build").returncode == 0


def test_links_lead_somewhere_in_the_notebook(course: CourseFolder) -> None:
    course.write(
        one="# One\n\n[next](two.md#x) and [file](../course.toml) and [web](https://example.org)\n", two="# 2\n"
    )
    toml = course.root / "course.toml"
    toml.write_text('repository = "https://example.org/r/"\n' + toml.read_text())

    course.spinbook("build")

    assert sources(course)["one"].split("\n")[-1] == (
        "[next](two.ipynb#x) and [file](https://example.org/r/blob/main/course.toml) and [web](https://example.org)"
    )


def test_a_file_name_is_shown_above_a_static_fence(course: CourseFolder) -> None:
    course.write(one='# One\n\n```python title="setup.py"\nfrom setuptools import setup\nsetup()\n```\n').spinbook(
        "build"
    )

    assert "`setup.py`:\n\n```python\nfrom setuptools" in sources(course)["one"]


def test_lint_tells_what_is_not_run_and_builds_nothing(course: CourseFolder) -> None:
    said = course.write(one=CHAPTER).spinbook_from_scratch("lint", "--static")

    assert "1 node, 2 snippet, 1 shell, 1 fences shown and not run" in said.stdout
    assert "chapters/one.md:29: yaml: `yaml` is neither Python nor shell" in said.stdout
    assert said.returncode == 0
    assert not (course.root / "build").exists()


@pytest.mark.parametrize(("words", "code"), [((), 0), (("--strict",), 1)])
def test_lint_fails_for_warnings_only_when_asked_to(course: CourseFolder, words: tuple[str, ...], code: int) -> None:
    assert course.write(one=b"# One\r\n").spinbook("lint", *words).returncode == code


def test_yaml_over_several_lines_is_one_line_of_the_notebook(course: CourseFolder) -> None:
    command = "ros2 topic pub -1 /servos sensor_msgs/msg/JointState \"\nname: ['a']\nposition: [90.0]\n\""

    course.write(one=f"# One\n\n```bash\n{command}\n```\n").spinbook("build")

    wanted = "%ros2 topic pub -1 /servos sensor_msgs/msg/JointState '{name: [a], position: [90.0]}'"
    assert wanted in sources(course).values()
