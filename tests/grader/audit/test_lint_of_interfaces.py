"""`spinbook lint` compares what a solution and its starter create with the interface in exercise.toml."""

from __future__ import annotations

from pathlib import Path

import pytest
from small_exercise import SmallExercise

from grader.checking.agreement import disagreements
from grader.checking.created import CreationCall, created
from grader.checking.proofreader import problems_of
from grader.exercise.exercise import Qos
from grader.exercise.loading import load
from spinbook.new.kind import ExerciseKind
from spinbook.new.templates import KINDS, write_exercise

SOLUTION = "solutions/doubler/solution.py"
TOML = "exercises/doubler/exercise.toml"
PUBLISHER = "self.create_publisher(Float64, '/doubled', 10)"

CREATES = """
import std_msgs.msg
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy, qos_profile_sensor_data
from std_msgs.msg import String as Text
from std_srvs.srv import Trigger

NAME = '/a'
latched = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
changed = QoSProfile(depth=1)
changed.reliability = ReliabilityPolicy.BEST_EFFORT
node.create_publisher(Text, NAME, latched)
node.create_publisher(std_msgs.msg.String, topic='b', qos_profile=changed)
node.create_subscription(Text, '~/c', print, qos_profile_sensor_data)
node.create_subscription(Text, f'/{i}', print, 5)
node.create_service(Trigger, '/d', serve)
ActionClient(node, Turn, '/e')
node.declare_parameter('gain', 1)
node.declare_parameter('names', ['a'])
node.declare_parameter('speed', Parameter.Type.DOUBLE)
"""


def reported(small: SmallExercise) -> list[str]:
    """What there is to fix, with the file's name and the line."""
    problems = [error.problem for error in disagreements(load(small.folder))]
    return [f"{problem.file.name}:{problem.line}: {problem.problem}" for problem in problems]


def test_what_a_program_creates_is_read_as_far_as_it_is_literal() -> None:
    text, late = "std_msgs/msg/String", Qos(durability="transient_local", depth=1)
    assert created(CREATES, "me") == (
        CreationCall("publish", 11, "/a", text, late),
        CreationCall("publish", 12, "/b", text),
        CreationCall("subscribe", 13, "/me/c", text, Qos("best_effort", "volatile", 5)),
        CreationCall("subscribe", 14, None, text, Qos(depth=5)),
        CreationCall("service", 15, "/d", "std_srvs/srv/Trigger"),
        CreationCall("action_client", 16, "/e"),
        CreationCall("parameter", 17, "gain", "integer", default=1),
        CreationCall("parameter", 18, "names", "string_array", default=["a"]),
        CreationCall("parameter", 19, "speed", "double"),
    )
    assert created("def", "me") == ()


@pytest.mark.parametrize(
    ("instead", "found"),
    [
        (
            "self.create_publisher(Float64, 'double', 10)",
            "creates a publisher on /double, which exercise.toml does not",
        ),
        ("self.create_publisher(Float64, '/doubled', 5)", "with depth = 5; exercise.toml has depth = 10"),
        (
            "self.create_publisher(Float64, '/doubled', QoSProfile(depth=10, reliability=Policy.BEST_EFFORT))",
            'on /doubled with reliability = "best_effort"; exercise.toml has reliability = "reliable"',
        ),
        (
            "self.create_client(Trigger, '/doubled')",
            "creates a client of /doubled, which exercise.toml does not declare",
        ),
    ],
)
def test_an_end_not_as_declared_is_reported_with_its_line(small: SmallExercise, instead: str, found: str) -> None:
    small.change(SOLUTION, PUBLISHER, instead)
    first = reported(small)[0]
    assert first.startswith("solution.py:13: the solution ")
    assert found in first


def test_another_type_is_reported(small: SmallExercise) -> None:
    small.change(SOLUTION, "import Float64", "import Float32 as Float64")
    assert 'with type = "std_msgs/msg/Float32"; exercise.toml has type = "std_msgs/msg/Float64"' in reported(small)[0]


def test_what_stands_outside_the_markers_is_the_starters(small: SmallExercise) -> None:
    small.change(
        SOLUTION, "        # BEGIN SOLUTION\n", "        self.create_timer(1, print)\n        # BEGIN SOLUTION\n"
    )
    small.change(SOLUTION, "self.create_timer(1, print)", "self.create_publisher(Float64, '/twice', 10)")
    [found] = reported(small)
    assert found.startswith("solution.py:12: the starter creates a publisher on /twice, which exercise.toml does not")


def test_an_end_that_the_solution_lacks_is_reported_where_it_is_declared(small: SmallExercise) -> None:
    small.change(SOLUTION, PUBLISHER, "None")
    [found] = reported(small)
    line = (small.course / TOML).read_text().splitlines().index("[[publish]]") + 1
    assert found == f"exercise.toml:{line}: solution.py does not create a publisher on /doubled, which is declared here"


@pytest.mark.parametrize("instead", ["self.create_publisher(Float64, name, 10)", "Sender(self, '/doubled')"])
def test_nothing_is_said_of_what_is_computed_or_left_to_a_library(small: SmallExercise, instead: str) -> None:
    small.change(SOLUTION, PUBLISHER, instead)
    assert reported(small) == []


def test_parameters_are_compared_by_type_and_default(small: SmallExercise) -> None:
    with (small.course / TOML).open("a") as file:
        file.write('\n[[parameter]]\nname = "gain"\ntype = "double"\ndefault = 2.0\n')
    assert "solution.py does not declare the parameter gain, which is declared here" in reported(small)[0]
    small.change(SOLUTION, PUBLISHER, "self.declare_parameter('gain', 2); " + PUBLISHER)
    [found] = reported(small)
    assert found.startswith("solution.py:13: the solution declares the parameter gain with type = ")
    assert found.endswith('"integer"; exercise.toml has type = "double"')
    small.change(SOLUTION, "'gain', 2", "'gain', 3.0")
    assert "with default = 3.0; exercise.toml has default = 2.0" in reported(small)[0]


def test_lint_tells_it(small: SmallExercise) -> None:
    small.change(SOLUTION, "'/doubled'", "'/double'")
    assert any("creates a publisher on /double," in problem.problem for problem in problems_of(small.folder))


@pytest.mark.parametrize("kind", KINDS, ids=lambda kind: kind.name)
def test_an_exercise_of_each_kind_agrees_with_its_interface(kind: ExerciseKind, tmp_path: Path) -> None:
    write_exercise(tmp_path, "gripper_force", "Gripper force", kind)
    assert [str(error) for error in disagreements(load(tmp_path / "exercises" / "gripper_force"))] == []
