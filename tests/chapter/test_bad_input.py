"""What is wrong in a chapter is told with file, line and what to do; nothing that was built before is lost."""

from __future__ import annotations

import pytest
from course_folder import CourseFolder

GOOD = "# Good\n\n```python\nx = 1\n```\n"

#: name -> (chapter, line that is told, words that are told, whether it stops the chapter)
FAULTS: dict[str, tuple[bytes, int, list[str], bool]] = {
    "syntax error in a fence": (
        b"# T\n\ntext\n\n```python\na = 1\nb = = 2\n```\n",
        7,
        ["not Python", "invalid syntax"],
        True,
    ),
    "unknown package": (
        b"# T\n\n```python\nimport no_such_package\n```\n",
        4,
        ["no_such_package", "not installed"],
        True,
    ),
    "misspelt package": (b"# T\n\n```python\nimport geometri_msgs\n```\n", 4, ["Did you mean `geometry_msgs`"], True),
    "misspelt message": (
        b"# T\n\n```python\nfrom sensor_msgs.msg import JointStat\n```\n",
        4,
        ["no `JointStat`", "Did you mean `JointState`"],
        True,
    ),
    "unknown ROS package": (b"# T\n\n```bash\nros2 run no_such_package talker\n```\n", 4, ["no_such_package"], True),
    "unclosed fence": (b"# T\n\ntext\n\n```python\nx = 1\n\nmore\n", 5, ["never closed", "```"], True),
    "two nodes of one name": (
        b'# T\n\n```python title="a.py"\nimport rclpy\nrclpy.spin(1)\n```\n\n```python title="a.py"\nx = 2\n```\n',
        8,
        ["`a`", "line 3", "another file name"],
        True,
    ),
    "broken front matter": (b"---\ntitle: a\nsummary: b: c\n---\n\n# T\n", 3, ["front matter", "YAML"], True),
    "front matter without end": (b"---\ntitle: a\n\n# T\n", 1, ["never ends", "---"], True),
    "control characters": (b"# T\n\nbell \x07 rings\n", 3, ["U+0007", "column 6", "Delete"], True),
    "not UTF-8": (b"# T\n\nna\xefve\n", 3, ["0xef", "UTF-8"], True),
    "Windows line ends": (b"# T\r\n\r\n```python\r\nx = 1\r\n```\r\n", 1, ["CRLF", "LF"], False),
    "byte-order mark": (b"\xef\xbb\xbf# T\n\ntext\n", 1, ["BOM"], False),
    "no heading": (b"text only\n", 1, ["no heading", "# "], True),
    "empty file": (b"", 1, ["no heading"], True),
    "unknown exercise": (b"# T\n\n<!-- exercise: nothing -->\n", 3, ["no exercise `nothing`"], True),
    "no time": (b"# T\n\n```bash seconds=soon\nros2 topic list\n```\n", 3, ["seconds=soon", "number of seconds"], True),
    "file name that is no module": (
        b'# T\n\n```python title="my-node.py"\nimport rclpy\nrclpy.spin(1)\n```\n',
        3,
        ["my-node", "letters, digits and underscores"],
        True,
    ),
    "magic in a node": (
        b'# T\n\n```python title="a.py"\nimport rclpy\n%stop b\nrclpy.spin(1)\n```\n',
        3,
        ["notebook command", "another fence"],
        True,
    ),
    "dead link": (b"# T\n\nsee [there](nowhere.md)\n", 3, ["nowhere.md", "no such file"], False),
    "misspelt attribute": (b"# T\n\n```bash secnods=3\nros2 topic list\n```\n", 3, ["`secnods`", "Known are"], False),
    "pipe in a shell fence": (b"# T\n\n```bash\nros2 topic list | grep x\n```\n", 4, ["not run", "pipes"], False),
    "unknown ros2 verb": (b"# T\n\n```bash\nros2 topic lsit\n```\n", 4, ["ros2 topic lsit", "list"], False),
    "fence in a list": (b"# T\n\n- item\n\n  ```python\n  x = 1\n  ```\n", 5, ["list", "left margin"], False),
}


@pytest.mark.parametrize("fault", FAULTS)
def test_a_fault_is_told_with_file_and_line_and_what_to_do(course: CourseFolder, fault: str) -> None:
    text, line, words, stops = FAULTS[fault]
    course.write(bad=text, good=GOOD)

    said = course.spinbook("build")

    assert f"chapters/bad.md:{line}: {'error' if stops else 'warning'}:" in said.stdout
    for word in words:
        assert word in said.stdout
    assert "Traceback" not in said.stdout + said.stderr
    assert said.returncode == (1 if stops else 0)
    assert course.notebook("good").cells, "the other chapter is built all the same"
    assert (course.root / "build/notebooks/bad.ipynb").exists() is not stops


def test_a_chapter_that_breaks_keeps_its_last_good_notebook(course: CourseFolder) -> None:
    course.write(one=GOOD).spinbook("build")
    before = (course.root / "build/notebooks/one.ipynb").read_bytes()

    said = course.write(one="# Good\n\n```python\nx = = 1\n```\n").spinbook("build")

    assert said.returncode == 1
    assert (course.root / "build/notebooks/one.ipynb").read_bytes() == before
    assert course.spinbook("build").stdout == said.stdout, "told again until it is mended"


def test_a_missing_chapter_is_told(course: CourseFolder) -> None:
    course.write(one=GOOD)
    (course.root / "chapters/one.md").unlink()

    said = course.spinbook("build")

    assert "chapters/one.md: error: the file can't be read" in said.stdout
    assert said.returncode == 1


@pytest.mark.parametrize(
    ("toml", "words"),
    [
        ("title = ", ["course.toml:1: error", "not TOML"]),
        ('title = "x"\n[package]\nname = "robot"', ["`chapters` is no list"]),
        ('title = "x"\nchapters = ["a.md"]', ["[package]", "name"]),
        ('title = "x"\nchapters = ["a.md"]\n[package]\nname = "My-Robot"', ["My-Robot", "lower-case"]),
        ('title = "x"\nchapters = ["a.md", "a.md"]\n[package]\nname = "robot"', ["listed twice"]),
        ('title = "x"\nchapters = ["a/x.md", "b/x.md"]\n[package]\nname = "robot"', ["x.ipynb", "another name"]),
        ('title = "x"\nchapters = ["../x.md"]\n[package]\nname = "robot"', ["outside the course"]),
        ('title = "x"\nchapters = ["a.md"]\n[package]\nname = "robot"\nnmae = "y"', ["unknown keys: nmae"]),
    ],
)
def test_a_faulty_course_toml_is_told(course: CourseFolder, toml: str, words: list[str]) -> None:
    (course.root / "course.toml").write_text(toml)

    said = course.spinbook("build")

    for word in words:
        assert word in said.stderr
    assert "Traceback" not in said.stderr
    assert said.returncode == 1


def test_outside_a_course_it_says_where_to_go(course: CourseFolder) -> None:
    said = course.spinbook("build")

    assert "no course.toml" in said.stderr
    assert said.returncode == 1
