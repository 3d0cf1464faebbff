"""`spinbook new --solution` writes a program with the interface of exercise.toml, which the starter has, too."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
import rclpy
from click.testing import CliRunner, Result
from rclpy.action import ActionClient, ActionServer
from rclpy.node import Node

from grader.exercise import Exercise, load, starter
from grader.exercise.exercise import ExerciseError, Topic
from grader.scenario.scenario import START, Message, Scenario
from spinbook.new.command import new
from spinbook.new.kind import ExerciseKind
from spinbook.new.skeleton import skeleton, with_relative_names
from spinbook.new.templates import BY_NAME, KINDS, write_exercise
from spinbook.problem import SpinbookError

ONE_PROGRAM = [pytest.param(kind, id=kind.name) for kind in KINDS if kind.name not in ("several-nodes", "launch-file")]


@pytest.fixture
def exercise(kind: ExerciseKind, tmp_path: Path) -> Exercise:
    write_exercise(tmp_path, "gripper_force", "Gripper force", kind)
    return load(tmp_path / "exercises" / "gripper_force")


@pytest.fixture
def ros(ros_domain: int) -> Iterator[None]:
    rclpy.init()
    yield
    rclpy.try_shutdown()


def node_of(source: str, class_name: str) -> Node:
    entries: dict[str, Any] = {"__name__": "student"}
    exec(compile(source, "starter.py", "exec"), entries)
    node: Node = entries[class_name]()
    return node


def policies(topic: Topic, node: Node) -> list[tuple[str, str, str]]:
    """Return type, reliability and durability of the node's endpoints of a topic."""
    ends = node.get_publishers_info_by_topic if topic.direction == "publish" else node.get_subscriptions_info_by_topic
    return [
        (end.topic_type, end.qos_profile.reliability.name.lower(), end.qos_profile.durability.name.lower())
        for end in ends(topic.name)
        if end.node_name == node.get_name()
    ]


@pytest.mark.usefixtures("ros")
@pytest.mark.parametrize("kind", ONE_PROGRAM)
def test_the_starter_has_each_declared_end_with_its_type_and_quality_of_service(exercise: Exercise) -> None:
    node = node_of(starter(skeleton(exercise)), exercise.class_name)
    try:
        assert node.get_name() == exercise.node_name
        for topic in exercise.topics:
            assert policies(topic, node) == [(topic.type, topic.reliability, topic.durability)]
        name, space = node.get_name(), node.get_namespace()
        services = dict(node.get_service_names_and_types_by_node(name, space))
        services |= dict(node.get_client_names_and_types_by_node(name, space))
        for one in exercise.endpoints:
            goal = one.role.startswith("action")
            assert services[f"{one.name}/_action/send_goal" if goal else one.name][0].startswith(one.type)
        for parameter in exercise.parameters:
            assert node.get_parameter(parameter.name).value == parameter.default
    finally:
        ends: list[Any] = [end for end in node.waitables if isinstance(end, (ActionClient, ActionServer))]
        for end in ends:
            end.destroy()  # destroy_node leaves them, and with them the node in its ROS domain
        node.destroy_node()


@pytest.mark.parametrize("kind", [BY_NAME["several-nodes"]])
def test_each_of_several_programs_has_a_part_with_its_node(exercise: Exercise) -> None:
    source = skeleton(exercise)
    starter(source)
    for program in exercise.programs:
        part = source.partition(f"# file: {program.file}\n")[2]
        assert f"class {program.class_name}(Node)" in part
        assert f'super().__init__("{program.node}")' in part
        assert "TODO: publish on /gripper_force/output (std_msgs/msg/Float64, depth 10, reliable, volatile)" in part


@pytest.mark.parametrize("kind", [BY_NAME["launch-file"]])
def test_a_launch_file_starts_the_declared_nodes(exercise: Exercise) -> None:
    text = skeleton(exercise)
    for name in ("left", "right"):
        assert f'Node(package="TODO", executable="TODO", name="{name}", namespace="/gripper_force"),' in text
    assert "Node(" not in starter(text)


@pytest.mark.parametrize("kind", [BY_NAME["filter"]])
def test_names_have_no_slash_if_a_scenario_starts_the_program_in_a_namespace(exercise: Exercise) -> None:
    alone, left = Scenario("alone", "alone"), Scenario("left", "on the left", namespace="/left")
    shared = Scenario("shared", "a shared input", Message(START, "/gripper_force/input", "", {}), namespace="/left")
    ends = [
        {topic.name for topic in with_relative_names(exercise, scenarios).topics}
        for scenarios in ([alone], [alone, left], [left, shared])
    ]
    given, relative = "/gripper_force/input", "gripper_force/output"
    assert ends == [{given, f"/{relative}"}, {given[1:], relative}, {given, relative}]


def made(*words: str) -> Result:
    return CliRunner().invoke(new, words)


def test_the_command_writes_a_solution_and_never_overwrites_one(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert made(str(tmp_path / "robots")).exit_code == 0
    monkeypatch.chdir(tmp_path / "robots")
    solution = Path("solutions", "speed_limit", "solution.py")
    assert isinstance(made("--solution", "speed_limit").exception, SpinbookError)
    solution.unlink()
    done = made("--solution", "speed_limit")
    assert f"Made {solution}" in done.output
    assert 'self.create_subscription(Float64, "/wanted_speed", self.on_wanted_speed, 10)' in solution.read_text()
    missing = made("--solution", "no_such_exercise").exception
    assert isinstance(missing, ExerciseError)
    assert "there is no such file" in str(missing)
