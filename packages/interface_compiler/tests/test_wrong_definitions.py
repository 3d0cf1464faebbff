"""An error in a definition is reported with its file, its line and what to do, before anything is generated."""

from __future__ import annotations

from pathlib import Path

import pytest
from definitions import definition, robot

from interface_compiler import prefixes
from interface_compiler.checks import check
from interface_compiler.definition import Definition, Fault, read_folder

KNOWN = prefixes.interfaces(prefixes.installed())


def faults(*definitions: Definition) -> list[Fault]:
    return check(definitions, KNOWN)


@pytest.mark.parametrize(
    ("line", "found", "fix"),
    [
        ("float x", "`float` is not a type.", "ROS 2 calls it float32."),
        ("flaot64 x", "`flaot64` is not a type.", "Did you mean float64?"),
        ("turtlesim/srv/Spawn s", "is not a type", "A field can't be a service or an action"),
        ("int32 MAX 3", "`MAX` can't be a field's name.", "For a constant, write a `=`: int32 MAX=3."),
        ("int32 MIN=", "the constant `MIN` has no value.", "int32 MIN=1"),
        ("float32 x nan", "`nan`, and ROS 2 accepts only finite numbers", "let the nodes set"),
        ("float64 x 1e400", "`1e400`, and ROS 2 accepts only finite numbers", "Leave it out"),
        ("float64[] x [1.0, inf]", "only finite numbers", "Leave it out"),
        ("float64 LIMIT=inf", "the value of `LIMIT` is `inf`, and ROS 2 accepts only finite numbers", "Leave it out"),
        ("Header header", "there is no message `robot_interfaces/Header`.", "Write std_msgs/Header."),
        ("geometry_msgs/msg/Pose pose", "is not a type", "Write geometry_msgs/Pose"),
        ("geometry_msgs/Pos pose", "there is no message `geometry_msgs/Pos`.", "Did you mean Pose?"),
        ("geometrie_msgs/Pose pose", "there is no package `geometrie_msgs`.", "Did you mean geometry_msgs/Pose"),
        ("std_srvs/Trigger t", "is a service or an action, not a message", "make a message"),
        ("Pose pose", "there is no message `robot_interfaces/Pose`.", "Did you mean geometry_msgs/Pose"),
        ("float64", "`float64` has no name.", "float64 value"),
        ("float64 jointName", "`jointName` can't be a field's name.", "joint_name"),
        ("float64 name__x", "`name__x` can't be a field's name.", "name_x"),
        ("float64 1st", "`1st` can't be a field's name.", "st"),
        ("float64 class", "reserved word of C or C++", "class_value"),
        ("float64 lambda", "reserved word of Python", "lambda_value"),
        ("int32 limit=3", "`limit` can't be a constant's name.", "leave out the `=`: int32 limit 3"),
        (
            "int32 MAX_VELOCITY_OF_BOTH_SHOULDERS_AND_OF_THE_ELBOWs=3",
            "can't be a constant's name.",
            "MAX_VELOCITY_OF_BOTH_SHOULDERS",
        ),
        ("geometry_msgs/Pose HOME=3", "has the type `geometry_msgs/Pose`", "can't be constants"),
        ("int32 x abc", "`abc`, which is not a valid int32", "-2147483648"),
        ("uint8 x 256", "`256`, which is not a valid uint8", "<= 255"),
        ("bool x yes", "`yes`, which is not a valid bool", "true"),
        ("float64 x 1,5", "`1,5`, which is not a valid float64", "'.'"),
        ("uint8 LIMIT=-1", "the value of `LIMIT` is `-1`", ">= 0"),
        ("float64[3] x [1.0, 2.0]", "not a valid float64[3]", "exactly 3"),
        ("float64[<=2] x [1, 2, 3]", "not a valid float64[<=2]", "not more than 2"),
        ('string<=3 x "abcd"', "not a valid string<=3", "3 characters"),
        ("geometry_msgs/Pose pose 3", "messages have no default", "remove it"),
        ('string x "a # b"', "has a # in it", "leave it out"),
        ('string x "a=b"', "has a = in it", "Leave the = out"),
        ("float64[0] x", "`float64[0]` is not a type.", "[<=3]"),
        ("float64[n] x", "`float64[n]` is not a type.", "whole number"),
        ("float64<=3 x", "`float64<=3` is not a type.", "Only strings"),
        ("---", "has 0 lines with ---, and this one has 1", ".srv"),
        ("----", "is not a separator", "three dashes"),
    ],
)
def test_a_wrong_line_is_reported_with_its_number_and_the_remedy(line: str, found: str, fix: str) -> None:
    (fault,) = faults(definition("msg/Thing.msg", f"# A thing\nint32 fine\n{line}\n"))

    assert (str(fault.file), fault.line) == ("interfaces/robot_interfaces/msg/Thing.msg", 3)
    assert found in fault.problem
    assert fix in fault.fix


def test_a_constant_that_is_the_same_in_two_parts_needs_a_comment() -> None:
    text = "int32 goal\n---\nuint8 NONE=0\nuint8 code\n---\nuint8 NONE=0{}\nuint8 state\n"

    (fault,) = faults(definition("action/Go.action", text.format("")))

    assert fault.line == 6
    assert "`NONE=0` is in line 3 too" in fault.problem
    assert faults(definition("action/Go.action", text.format(" # nothing yet"))) == []


def test_a_field_twice_names_the_first_ones_line() -> None:
    (fault,) = faults(definition("msg/Thing.msg", "int32 a\nint32 b\n\nfloat64 a\n"))

    assert fault.line == 4
    assert "`a` is already taken in line 1" in fault.problem


def test_request_and_response_may_have_the_same_field() -> None:
    assert faults(definition("srv/Echo.srv", "string text\n---\nstring text\n")) == []


@pytest.mark.parametrize(
    ("path", "text", "found"),
    [
        ("srv/Ask.srv", "int32 a\n", "a .srv file has 1 line with ---, and this one has 0."),
        ("action/Go.action", "int32 a\n---\nint32 b\n", "a .action file has 2 lines with ---, and this one has 1."),
        ("msg/joint_limits.msg", "int32 a\n", "`joint_limits` can't be an interface's name."),
    ],
)
def test_a_definition_of_the_wrong_shape_is_reported(path: str, text: str, found: str) -> None:
    (fault,) = faults(definition(path, text))

    assert fault.problem == found


def test_a_bad_name_comes_with_a_good_one() -> None:
    (fault,) = faults(definition("msg/joint_limits.msg", "int32 a\n"))

    assert "JointLimits.msg" in fault.fix
    assert fault.line is None


def test_a_bad_name_in_a_chapter_is_on_the_line_with_the_fences_title() -> None:
    fence = Definition("robot_interfaces", "msg", "joint_limits", "int32 x\n", Path("chapters/04.md"), line=40)

    (fault,) = faults(fence)

    assert str(fault).startswith("chapters/04.md:39: `joint_limits` can't be an interface's name.")


def test_a_message_that_contains_itself_is_reported_with_the_circle() -> None:
    (fault,) = faults(definition("msg/A.msg", "int32 x\nB b\n"), definition("msg/B.msg", "A[] a\n"))

    assert fault.line in (1, 2)
    assert "contains itself: robot_interfaces/" in fault.problem


def test_each_circle_is_reported() -> None:
    found = faults(
        definition("msg/A.msg", "B b\n"), definition("msg/B.msg", "A[] a\n"), definition("msg/C.msg", "C[] parts\n")
    )

    assert [fault.problem for fault in found] == [
        "`robot_interfaces/A` contains itself: robot_interfaces/A -> robot_interfaces/B -> robot_interfaces/A.",
        "`robot_interfaces/C` contains itself: robot_interfaces/C -> robot_interfaces/C.",
    ]


def test_a_message_named_like_a_number_is_one() -> None:
    own = definition("msg/Float64.msg", "float64 data\n")

    assert faults(own, definition("msg/Pair.msg", "Float64 first\nFloat64 second\n")) == []


def test_packages_that_need_one_another_are_reported() -> None:
    (fault,) = faults(
        definition("msg/A.msg", "two_interfaces/B b\n", "one_interfaces"),
        definition("msg/B.msg", "one_interfaces/C c\n", "two_interfaces"),
        definition("msg/C.msg", "int32 x\n", "one_interfaces"),
    )

    assert "packages that need one another" in fault.problem


def test_two_texts_for_one_name_are_reported() -> None:
    (fault,) = faults(definition("msg/A.msg", "int32 x\n"), definition("msg/A.msg", "int32 y\n"))

    assert "is defined in interfaces/robot_interfaces/msg/A.msg:1 too" in fault.problem


def test_lines_are_the_chapters_where_a_definition_is_a_fence_of_one() -> None:
    fence = Definition("robot_interfaces", "msg", "A", "int32 x\nint64 x\n", Path("chapters/04.md"), line=40)

    (fault,) = faults(fence)

    assert str(fault).startswith("chapters/04.md:41: the name `x` is already taken in line 40.")


def test_every_fault_is_reported_at_once_in_order() -> None:
    found = faults(definition("msg/A.msg", "float x\nint y\nPose p\n"))

    assert [fault.line for fault in found] == [1, 2, 3]


def test_right_definitions_have_no_faults() -> None:
    assert faults(*robot()) == []


def test_files_in_the_wrong_folder_or_encoding_are_reported(tmp_path: Path) -> None:
    folder = tmp_path / "interfaces"
    (folder / "my_interfaces" / "msg").mkdir(parents=True)
    (folder / "my_interfaces" / "msg" / "Go.srv").write_text("---\n")
    (folder / "my_interfaces" / "msg" / "Bad.msg").write_bytes(b"\xff\n")

    definitions, found = read_folder(folder, tmp_path)

    assert definitions == []
    assert [str(fault.file) for fault in found] == [
        "interfaces/my_interfaces/msg/Bad.msg",
        "interfaces/my_interfaces/msg/Go.srv",
    ]
