"""Messages, services and actions are compiled however a chapter names them, in the package that it means."""

from __future__ import annotations

from pathlib import Path

import pytest

from groundwork.problem import Severity
from spinbook.chapter.chapter import Chapter
from spinbook.chapter.classify import CellKind
from spinbook.chapter.read import ReadResult
from spinbook.chapters import read_all
from spinbook.course.course import read_course

SERVICE = "float64 angle\n---\nfloat64 cosine\n"
NODE = (
    "import rclpy\nfrom rclpy.node import Node\nfrom trig_interfaces.srv import Cosine\n\n\ndef main():\n"
    "    rclpy.init()\n    node = Node('trig')\n    node.create_service(Cosine, 'cosine', print)\n"
    "    rclpy.spin(node)\n\n\nif __name__ == '__main__':\n    main()\n"
)


def read(root: Path, *chapters: str) -> list[ReadResult]:
    names = [f"c{number}.md" for number, _ in enumerate(chapters)]
    for name, text in zip(names, chapters, strict=True):
        (root / name).write_text(text)
    (root / "course.toml").write_text(f'title = "T"\nchapters = {names}\n[package]\nname = "robot"\n')
    return list(read_all(read_course(root)))


def chapter(root: Path, text: str) -> Chapter:
    (result,) = read(root, text)
    assert result.chapter is not None
    return result.chapter


def defined(chapter: Chapter) -> list[str | None]:
    return [cell.name for cell in chapter.interfaces]


def fence(code: str, info: str = "") -> str:
    return f"```{info}\n{code}```\n\n"


@pytest.mark.parametrize(
    "shown",
    [
        fence(SERVICE, 'text title="Cosine.srv"'),
        fence(SERVICE, 'text {filename="srv/Cosine.srv"}'),
        fence("%%writefile srv/Cosine.srv\n" + SERVICE, "python"),
        fence("cat > srv/Cosine.srv <<EOF\n" + SERVICE + "EOF\n", "bash"),
        fence("cat <<'END' >src/trig_interfaces/srv/Cosine.srv\n" + SERVICE + "END\n", "bash"),
        fence("mkdir srv\ncat > srv/Cosine.srv <<EOF\n" + SERVICE + "EOF\n\nchmod +x x.py\n", "bash"),
        '=== "Cosine.srv"\n\n' + "".join(f"    {line}\n" for line in fence(SERVICE).split("\n")),
        fence(SERVICE, 'text filename="src/trig_interfaces/srv/Cosine.srv"'),
        "Create `Cosine.srv`:\n\n" + fence(SERVICE),
        "In the folder, make **srv/Cosine.srv**:\n\n" + fence(SERVICE, "python"),
        "编辑文件Cosine.srv，内容如下：\n\n" + fence(SERVICE, "srv"),
        "1. A file `~/ws/src/trig_interfaces/srv/Cosine.srv`:\n\n"
        + "".join(f"   {line}\n" for line in fence(SERVICE, "srv").split("\n")),
        "```bash\nnano srv/Cosine.srv\n```\n\n" + fence(SERVICE, "bash"),
        "## Cosine.srv\n\nOne question, one answer.\n\n" + fence(SERVICE),
        fence("# File: srv/Cosine.srv\n" + SERVICE, "txt"),
        fence("# The request of Cosine.srv\n" + SERVICE, "python"),
        "The service `Cosine` of Cosine.srv is simple.\n\nIt is:\n\n" + fence(SERVICE),
    ],
)
def test_a_definition_is_compiled_however_it_is_named_and_the_node_that_imports_it_runs(
    tmp_path: Path, shown: str
) -> None:
    read_one = chapter(tmp_path, f"# C\n\n{shown}\n\n{fence(NODE, 'python')}")

    assert defined(read_one) == ["trig_interfaces/srv/Cosine.srv"]
    assert [cell.kind for cell in read_one.cells if cell.kind is not CellKind.PROSE][-1] is CellKind.NODE


@pytest.mark.parametrize(
    ("text", "package"),
    [
        ("In the package `limb_msgs`:\n\n", "limb_msgs"),
        (fence("ros2 pkg create --build-type ament_cmake limb_interfaces\n", "bash"), "limb_interfaces"),
        (fence("<package>\n  <name>limb_interfaces</name>\n</package>\n", "xml"), "limb_interfaces"),
        (fence("project(limb_msgs)\nfind_package(rosidl_default_generators)\n", "cmake"), "limb_msgs"),
        (fence("ros2 topic echo /limb limb_interfaces/msg/Limb\n", "bash"), "limb_interfaces"),
        ("As in `std_msgs`:\n\n", "robot_interfaces"),
    ],
)
def test_the_package_is_the_one_that_the_chapter_speaks_of(tmp_path: Path, text: str, package: str) -> None:
    shown = chapter(tmp_path, f"# C\n\n{text}Create `Limb.msg`:\n\n" + fence("float64[3] position\n"))

    assert defined(shown) == [f"{package}/msg/Limb.msg"]


@pytest.mark.parametrize(
    "after",
    [
        fence('rosidl_generate_interfaces(${PROJECT_NAME}\n  "msg/Limb.msg"\n)\n', "cmake"),
        "- Import it: `from limb_msgs.msg import Limb`\n",
    ],
)
def test_the_name_may_come_after_the_definition_in_its_section(tmp_path: Path, after: str) -> None:
    first, second = fence("float64 angle\n"), fence("float64 other\n")

    shown = chapter(tmp_path, f"# C\n\nIn `limb_msgs`:\n\n{first}{after}\n## Next\n\n{second}")

    assert defined(shown) == ["limb_msgs/msg/Limb.msg"]


def test_what_interface_show_printed_is_no_definition(tmp_path: Path) -> None:
    shown = "`ros2 interface show limb_msgs/msg/Limb` prints Limb.msg's fields:\n\n"
    printed, used = fence("float64 angle\n"), fence("from limb_msgs.msg import Limb\n", "python")

    assert defined(chapter(tmp_path, f"# C\n\n{shown}{printed}{used}")) == []


def test_several_definitions_in_one_fence_are_cells_of_their_own(tmp_path: Path) -> None:
    code = "# limb_msgs/msg/Joint.msg\nfloat64 angle\n\n# limb_msgs/msg/Limb.msg\nJoint[] joints\n"

    shown = chapter(tmp_path, "# C\n\n" + fence(code))

    assert defined(shown) == ["limb_msgs/msg/Joint.msg", "limb_msgs/msg/Limb.msg"]
    assert [cell.line for cell in shown.interfaces] == [4, 7]


@pytest.mark.parametrize(
    ("text", "code"),
    [
        ("Look at `Cosine.srv`, then write:", "import rclpy\nrclpy.init()\n"),
        ("`Cosine.srv` is used like this:", "angle: 1.0\n"),
        ("It is in `Cosine.srv`:", "srv/\n└── Cosine.srv\n"),
        ("As in `AddTwoInts.srv`:", "int64 a\nint64 b\n---\nint64 sum\n"),
        ("The message `geometry_msgs/Vector3.msg`:", "float64 x\nfloat64 y\nfloat64 z\n"),
    ],
)
def test_other_text_and_definitions_that_are_installed_are_not_compiled(tmp_path: Path, text: str, code: str) -> None:
    assert defined(chapter(tmp_path, f"# C\n\n{text}\n\n{fence(code)}")) == []


def test_a_definition_with_a_fault_is_shown_with_the_reason_and_stops_nothing(tmp_path: Path) -> None:
    shown = "# C\n\nCreate `Path.msg`:\n\n" + fence("duration length\nnot_here_msgs/Point[] points\n")

    (result,) = read(tmp_path, shown)

    assert result.chapter is not None
    assert defined(result.chapter) == []
    assert "there is no package `not_here_msgs`" in result.chapter.static_fences[0].sign
    assert {problem.severity for problem in result.problems} == {Severity.NOT_RUN}


def test_a_definition_shown_again_with_more_fields_is_compiled_as_it_was_shown_last(tmp_path: Path) -> None:
    first, second = read(
        tmp_path,
        "# A\n\nCreate `Limb.msg`:\n\n" + fence("float64 angle\n"),
        "# B\n\nChange `Limb.msg`:\n\n" + fence("float64 angle\nfloat64 speed\n"),
    )

    assert first.chapter is not None
    assert second.chapter is not None
    assert defined(first.chapter) == []
    assert "c1.md:6 shows it with other fields" in first.problems[0].problem
    assert defined(second.chapter) == ["robot_interfaces/msg/Limb.msg"]
