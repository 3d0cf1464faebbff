"""An error in a chapter is reported with file, line and what to do; earlier builds are not lost."""

from __future__ import annotations

import re
from dataclasses import dataclass

import pytest
from course_folder import CourseFolder

from spinbook.chapter import imports
from spinbook.chapter.python_code import inspect
from spinbook.cli import main

GOOD = "# Good\n\n```python\nx = 1\n```\n"

ERROR, NOT_RUN, WARNING = "error", "not run", "warning"

#: name -> (chapter, reported line, reported words, severity: only an error stops the chapter)
FAULTS: dict[str, tuple[bytes, int, list[str], str]] = {
    "syntax error in a fence": (
        b"# T\n\ntext\n\n```python\na = 1\nb = = 2\n```\n",
        7,
        ["not Python", "invalid syntax"],
        NOT_RUN,
    ),
    "unknown package": (
        b"# T\n\n```python\nimport no_such_package\n```\n",
        4,
        ["no_such_package", "not installed"],
        NOT_RUN,
    ),
    "misspelt package": (
        b"# T\n\n```python\nimport geometri_msgs\n```\n",
        4,
        ["Did you mean `geometry_msgs`"],
        NOT_RUN,
    ),
    "misspelt message": (
        b"# T\n\n```python\nfrom sensor_msgs.msg import JointStat\n```\n",
        4,
        ["no `JointStat`", "Did you mean `JointState`"],
        NOT_RUN,
    ),
    "misspelt kind of block": (b"# T\n\n:::warnin\nHot.\n:::\n", 3, ["`warnin`", "Did you mean `warning`?"], WARNING),
    "misspelt directive": (b"# T\n\n```{waring}\nHot.\n```\n", 3, ["Did you mean `warning`?"], WARNING),
    "misspelt language": (b"# T\n\n```pyhton\nx = 1\n```\n", 3, ["Did you mean `python`?"], WARNING),
    "unknown ROS package": (b"# T\n\n```bash\nros2 run no_such_package talker\n```\n", 4, ["no_such_package"], NOT_RUN),
    "unclosed fence": (b"# T\n\ntext\n\n```python\nx = 1\n\nmore\n", 5, ["never closed", "```"], NOT_RUN),
    "broken front matter": (b"---\ntitle: a\nsummary: b: c\n---\n\n# T\n", 3, ["front matter", "YAML"], WARNING),
    "front matter without end": (b"---\ntitle: a\n\n# T\n", 1, ["never ends", "---"], WARNING),
    "control characters": (b"# T\n\nbell \x07 rings\n", 3, ["U+0007", "column 6", "Delete"], WARNING),
    "not UTF-8": (b"# T\n\nna\xefve\n", 3, ["0xef", "UTF-8"], ERROR),
    "Windows line ends": (b"# T\r\n\r\n```python\r\nx = 1\r\n```\r\n", 1, ["CRLF", "LF"], WARNING),
    "byte-order mark": (b"\xef\xbb\xbf# T\n\ntext\n", 1, ["BOM"], WARNING),
    "no heading": (b"text only\n", 1, ["no heading", "# "], WARNING),
    "empty file": (b"", 1, ["no heading"], WARNING),
    "unknown exercise": (b"# T\n\n<!-- exercise: nothing -->\n", 3, ["no exercise `nothing`"], NOT_RUN),
    "no time": (
        b"# T\n\n```bash seconds=soon\nros2 topic list\n```\n",
        3,
        ["seconds=soon", "number of seconds"],
        WARNING,
    ),
    "file name that is no module": (
        b'# T\n\n```python title="my-node.py"\nimport rclpy\nrclpy.init()\nrclpy.spin(1)\n```\n',
        3,
        ["my-node", "letters, digits and underscores"],
        WARNING,
    ),
    "magic in a node": (
        b'# T\n\n```python title="a.py"\nimport rclpy\n%stop b\nrclpy.spin(1)\n```\n',
        3,
        ["notebook command", "another fence"],
        NOT_RUN,
    ),
    "misspelt component": (
        b"# T\n\n<Asside>\n\nHot.\n\n</Asside>\n",
        3,
        ["`<Asside>`", "Did you mean `<Aside>`?"],
        WARNING,
    ),
    "dead heading": (
        b"# T\n\n## Two of it\n\n[there](#two-of-its)\n",
        5,
        ["no such heading", "Did you mean `#two-of-it`?"],
        WARNING,
    ),
    "macro": (b"# T\n\nOn {{ distro }}.\n", 3, ["`{{ distro }}` is a macro", "Write what it stands for"], WARNING),
    "reference of Quarto": (b"# T\n\nSee @fig-arm.\n", 3, ["`@fig-arm` is a macro"], WARNING),
    "dead link": (b"# T\n\nsee [there](nowhere.md)\n", 3, ["nowhere.md", "no such file"], WARNING),
    "misspelt attribute": (b"# T\n\n```bash secnods=3\nros2 topic list\n```\n", 3, ["`secnods`", "Known are"], WARNING),
    "misspelt tag": (
        b"# T\n\n```{code-cell}\n:tags: [skip-exection]\nx = 1\n```\n",
        3,
        ["unknown tag", "Did you mean `skip-execution`?"],
        WARNING,
    ),
    "pipe in a shell fence": (b"# T\n\n```bash\nros2 topic list | grep x\n```\n", 4, ["not run", "pipes"], WARNING),
    "unknown ros2 verb": (
        b"# T\n\n```bash\nros2 topic lsit\n```\n",
        4,
        ["ros2 topic lsit", "Did you mean `ros2 topic list`?"],
        NOT_RUN,
    ),
    "missing module": (
        b"# T\n\n```python\nfrom geometry_msgs.srv import GetPlan\n```\n",
        4,
        ["no such module", "Did you mean `from nav_msgs.srv import GetPlan`"],
        NOT_RUN,
    ),
    "misspelt module": (
        b"# T\n\n```python\nfrom std_msgs.mgs import String\n```\n",
        4,
        ["no such module", "Did you mean `from std_msgs.msg import String`"],
        NOT_RUN,
    ),
    "relative import": (
        b'# T\n\n```python title="a.py"\nfrom .names import JOINTS\nprint(JOINTS)\n```\n',
        4,
        ["`.names`", "import names"],
        NOT_RUN,
    ),
    "undefined name": (
        b"# T\n\n```python\nimport rclpy\n\n\ndef main():\n    rclpy.init()\n    node = Talker()\n"
        b"    rclpy.spin(node)\n```\n",
        9,
        ["`Talker`", "defined neither here nor above"],
        NOT_RUN,
    ),
    "attribute that nothing sets": (
        b"# T\n\n```python\nimport rclpy\nfrom rclpy.node import Node\n\n\nclass A(Node):\n"
        b"    def beat(self):\n        self.count += 1\n        print(self.total)\n\n\n"
        b"def main():\n    rclpy.init()\n    rclpy.spin(A('a'))\n```\n",
        11,
        ["`self.total`", "never set"],
        WARNING,
    ),
}


@dataclass(frozen=True)
class Built:
    """A course with one chapter per fault, and a good chapter among them, built once."""

    course: CourseFolder
    said: str


@pytest.fixture(scope="module")
def faulty(tmp_path_factory: pytest.TempPathFactory) -> Built:
    """That course."""
    course = CourseFolder(tmp_path_factory.mktemp("faulty"))
    course.write(good=GOOD, **{name_of(fault): FAULTS[fault][0] for fault in FAULTS})
    assert course.spinbook("build").returncode == 1
    said = course.spinbook("lint")
    assert "Traceback" not in said.stdout + said.stderr
    return Built(course, said.stdout)


def name_of(fault: str) -> str:
    """The name of the chapter with a fault."""
    return fault.lower().replace(" ", "_").replace("-", "_")


@pytest.mark.parametrize("fault", FAULTS)
def test_a_fault_is_reported_with_file_and_line_and_what_to_do(faulty: Built, fault: str) -> None:
    _, line, words, severity = FAULTS[fault]
    name = name_of(fault)

    # What is reported for this chapter: from its name to the name of the next.
    reported = [part for part in re.split(r"^(?=chapters/)", faulty.said, flags=re.MULTILINE) if f"/{name}.md:" in part]

    assert any(part.startswith(f"chapters/{name}.md:{line}: {severity}:") for part in reported)
    for word in words:
        assert word in "".join(reported)
    assert (faulty.course.root / f"build/notebooks/{name}.ipynb").exists() is (severity != ERROR)


def test_chapters_beside_a_faulty_one_are_built_all_the_same(faulty: Built) -> None:
    assert faulty.course.notebook("good").cells


def test_what_cannot_run_stops_nothing_and_is_reported_once_with_what_would_help(course: CourseFolder) -> None:
    fence = "```python\nimport no_such_package\n```\n"

    said = course.write(one=f"# A\n\n{fence}\n{fence}", two=f"# B\n\n{fence}").spinbook("build")

    assert said.returncode == 0
    assert "3 fences need no_such_package in 2 chapters." in said.stdout
    assert said.stdout.count("no_such_package") == 1
    shown = course.notebook("two").cells[0].source
    assert "<small>Not run here: it needs `no_such_package`, not installed here.</small>" in shown


def test_strict_makes_it_an_error_that_something_does_not_run(course: CourseFolder) -> None:
    said = course.write(one="# A\n\n```python\nimport no_such_package\n```\n").spinbook("build", "--strict")

    assert said.returncode == 1
    assert "chapters/one.md:4: error: imports `no_such_package`" in said.stdout


def test_a_warning_stops_nothing(course: CourseFolder) -> None:
    assert course.write(linked=b"# T\n\nsee [there](nowhere.md)\n").spinbook("build").returncode == 0


def test_what_a_books_tool_understands_is_no_oversight(course: CourseFolder) -> None:
    course.write(
        one="""# T

import {
  Asside,
} from '@site/src/Asside';

## 1. Ünder & Über {#own}

<a id="raw"></a>

(mine)=

## Twice

## Twice

[a](#1-ünder--über) [b](#under-uber) [c](#own) [d](#raw) [e](#mine) [f](#twice-1) [g](#twice_1) [h](#top) [i](#Twice)
[j](#ros-2) [k](#a-quote) [l](#my-eq) [m](#raw-one) [n](#:~:text=raw) [o](#fn-note) [p](#id1)

## ROS 2 の概要

> ### A quote

<h2>Raw one</h2>

$$
{{\\bf x}} = 1
$$ (my-eq)

<!-- {{ later }} -->

`{{ code }}`, $x^{{2}}$ and <b style={{color: "red"}}>red</b>.

<Asside>

Mine.

</Asside>
"""
    )
    assert "0 errors, 0 warnings" in course.spinbook("lint").stdout


def test_a_chapter_that_breaks_keeps_its_last_good_notebook(course: CourseFolder) -> None:
    course.write(one=GOOD).spinbook("build")
    before = (course.root / "build/notebooks/one.ipynb").read_bytes()

    said = course.write(one="# Good\n\n```python\nx = = 1\n```\n").spinbook("build", "--strict")

    assert said.returncode == 1
    assert (course.root / "build/notebooks/one.ipynb").read_bytes() == before
    assert course.spinbook("build", "--strict").stdout == said.stdout, "reported again until it is fixed"


def test_a_missing_chapter_is_reported(course: CourseFolder) -> None:
    course.write(one=GOOD)
    (course.root / "chapters/one.md").unlink()

    said = course.spinbook("build")

    assert "chapters/one.md: error: the file can't be read" in said.stdout
    assert said.returncode == 1


@pytest.mark.parametrize(
    ("toml", "words"),
    [
        ("title = ", ["course.toml:1: error", "not TOML"]),
        ('title = "x"\n[package]\nname = "robot"', ["`chapters` is not a list"]),
        ('title = "x"\nchapters = ["a.md"]', ["[package]", "name"]),
        ('title = "x"\nchapters = ["a.md"]\n[package]\nname = "My-Robot"', ["My-Robot", "lower-case"]),
        ('title = "x"\nchapters = ["a.md", "a.md"]\n[package]\nname = "robot"', ["listed twice"]),
        ('title = "x"\nchapters = ["../x.md"]\n[package]\nname = "robot"', ["outside the course"]),
        ('title = "x"\nchapters = ["a.md"]\n[package]\nname = "robot"\nnmae = "y"', ["unknown keys: nmae"]),
    ],
)
def test_a_faulty_course_toml_is_reported(
    course: CourseFolder,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    toml: str,
    words: list[str],
) -> None:
    (course.root / "course.toml").write_text(toml)
    monkeypatch.chdir(course.root)
    monkeypatch.setattr("sys.argv", ["spinbook", "build"])

    with pytest.raises(SystemExit) as ended:
        main()

    said = capsys.readouterr().err
    for word in words:
        assert word in said
    assert ended.value.code == 1


def test_outside_a_course_it_says_where_to_go(course: CourseFolder) -> None:
    said = course.spinbook("build")

    assert "no course.toml" in said.stderr
    assert said.returncode == 1


def test_a_cell_that_draws_where_matplotlib_is_missing_is_told_what_to_install(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(imports, "_is_installed", lambda module: module != "matplotlib")
    (missing,) = imports.missing_imports(inspect("import rclpy\nfrom matplotlib import pyplot\n"), {})
    assert (missing.line, missing.fix) == (2, "Install it: pip install matplotlib")
