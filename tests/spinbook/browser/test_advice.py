"""What a page's editor says before code runs: errors, and the names that can follow."""

from __future__ import annotations

import pytest

from spinbook.browser.in_page.advice import completions, problems

PROGRAM = """\
from geometry_msgs.msg import Twist, Vector3
from rclpy.node import Node


class Driver(Node):
    def __init__(self):
        super().__init__("driver")
        self.create_subscription(Twist, "cmd_vel", self.drive, 10)

    def drive(self, msg):
        {line}
"""


def offered(line: str) -> list[str]:
    """Return what is offered at the `|` in this line."""
    program = PROGRAM.replace("{line}", line)
    at = program.index("|")
    return [option["label"] for option in completions(program.replace("|", ""), at)]


@pytest.mark.parametrize(
    ("line", "names"),
    [
        ("msg.|", ["linear", "angular"]),
        ("y = abs(msg.angular.z + msg.li|", ["linear", "angular"]),
        ("if msg.linear.|:", ["x", "y", "z"]),
        ("copy = Twist(linear=Vector3(|))", ["x=", "y=", "z="]),
        ("pri|", []),
        ("else msg.|", ["linear", "angular"]),
    ],
)
def test_fields_of_a_message_are_offered(line: str, names: list[str]) -> None:
    assert offered(line) == names


def test_a_nodes_own_names_come_before_those_of_rclpy() -> None:
    names = offered("self.|")
    assert names.index("drive") < names.index("create_publisher")


@pytest.mark.parametrize(
    ("line", "said"),
    [
        ("pass", []),
        ("msg.lineer = 1", ["`Twist` has no field `lineer`. Did you mean `linear`? Its fields: `linear`, `angular`."]),
        ("if msg", ["SyntaxError: expected ':'"]),
        ("Vector3(x=1)", ["`x` of `Vector3` is a float64, and this is an integer, `1`."]),
    ],
)
def test_errors_are_named_with_their_line(line: str, said: list[str]) -> None:
    problems_there = problems(PROGRAM.replace("{line}", line))
    assert [problem["line"] for problem in problems_there] == [11] * len(said)
    assert all(problem["text"].startswith(text) for problem, text in zip(problems_there, said, strict=True))


def test_lines_for_the_page_are_no_errors() -> None:
    assert problems("%plot /a/b --seconds 3\nx = 1\n") == []
