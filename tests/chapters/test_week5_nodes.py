"""Week 5's nodes, as a student would save and run them: plain Python, real DDS, without Spinbook."""

from __future__ import annotations

import os
import signal
from pathlib import Path
from typing import Any

import pytest
from rcl_interfaces.msg import Parameter, ParameterType, ParameterValue, SetParametersResult
from rcl_interfaces.srv import SetParameters, SetParametersAtomically
from rclpy.qos import DurabilityPolicy, QoSProfile
from sensor_msgs.msg import JointState
from std_msgs.msg import String
from test_week3_nodes import NODE_FENCE, Partner, Program, started

CHAPTER = Path(__file__).parents[2] / "chapters" / "05-parameters-and-qos.md"
LATCHED = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)


@pytest.fixture
def files(tmp_path: Path, ros_domain: int, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder that contains the chapter's nodes, each saved as a plain .py, in the last version shown."""
    monkeypatch.setenv("ROS_LOG_DIR", os.fspath(tmp_path / "log"))
    for name, code in NODE_FENCE.findall(CHAPTER.read_text(encoding="utf-8")):
        (tmp_path / name).write_text(code, encoding="utf-8")
    return tmp_path


def double(name: str, value: float) -> Parameter:
    return Parameter(name=name, value=ParameterValue(type=ParameterType.PARAMETER_DOUBLE, double_value=value))


def integer(name: str, value: int) -> Parameter:
    return Parameter(name=name, value=ParameterValue(type=ParameterType.PARAMETER_INTEGER, integer_value=value))


def text(name: str, value: str) -> Parameter:
    return Parameter(name=name, value=ParameterValue(type=ParameterType.PARAMETER_STRING, string_value=value))


class Setter:
    """Sets parameters of one node, as `ros2 param set` and a call of the atomic service do."""

    def __init__(self, partner: Partner, node: str) -> None:
        self._partner = partner
        self._one_by_one = partner.node.create_client(SetParameters, f"/{node}/set_parameters")
        self._at_once = partner.node.create_client(SetParametersAtomically, f"/{node}/set_parameters_atomically")
        for client in (self._one_by_one, self._at_once):
            partner.spin_until(client.service_is_ready, f"/{node} to offer its parameters")

    def set(self, parameter: Parameter) -> SetParametersResult:
        return self._answer(self._one_by_one, SetParameters.Request(parameters=[parameter])).results[0]

    def set_at_once(self, *parameters: Parameter) -> SetParametersResult:
        return self._answer(self._at_once, SetParametersAtomically.Request(parameters=parameters)).result

    def _answer(self, client: Any, request: Any) -> Any:
        answer = client.call_async(request)
        self._partner.spin_until(answer.done, "the node to answer")
        return answer.result()


def ended_well(program: Program) -> bool:
    return program.end(signal.SIGINT) == 0 and "Traceback" not in "".join(program.log)


def test_the_swing_keeps_to_range_type_and_read_only_and_moves_by_what_was_set(files: Path) -> None:
    positions: list[float] = []

    def collect(message: JointState) -> None:
        positions.extend(message.position)

    with started(files / "elbow_swing.py") as (program, partner):
        node = Setter(partner, "elbow_swing")
        for refused in (double("amplitude", 1.1), integer("amplitude", 1), text("joint", "wrist"), double("amp", 0.5)):
            assert not node.set(refused).successful
        assert node.set(double("amplitude", 0.0)).successful
        partner.node.create_subscription(JointState, "/joint_commands", collect, 10)
        partner.spin_until(lambda: len(positions) >= 3, "three commands")
        assert ended_well(program), "".join(program.log)
    assert positions[-1] == 1.2


@pytest.mark.soak
@pytest.mark.parametrize(
    ("given", "error"),
    [("amplitude:=1", "InvalidParameterTypeException"), ("amplitude:=3.0", "InvalidParameterValueException")],
)
def test_a_swing_that_is_started_with_a_wrong_value_does_not_start(files: Path, given: str, error: str) -> None:
    with Program(files / "elbow_swing.py", "-p", given) as program:
        program.wait_for_log(f"rclpy.exceptions.{error}")
        assert program.process.wait(60) == 1


def test_the_range_refuses_with_a_reason_and_follows_what_was_set(files: Path) -> None:
    with started(files / "elbow_range.py") as (program, partner):
        node = Setter(partner, "elbow_range")
        answer = node.set(double("highest", 0.1))
        assert (answer.successful, answer.reason) == (False, "lowest (0.2) must be below highest (0.1)")
        assert node.set(double("highest", 1.2)).successful
        assert "highest is still 2.2" in program.wait_for_log("on-set")
        assert "center 0.70, amplitude 0.50" in program.wait_for_log("post-set")
        assert not node.set(double("lowest", 1.5)).successful
        assert node.set_at_once(double("lowest", 1.5), double("highest", 2.0)).successful
        assert "center 1.75, amplitude 0.25" in program.wait_for_log("post-set")
        assert ended_well(program), "".join(program.log)


def test_of_a_burst_each_queue_keeps_as_many_as_it_is_deep(files: Path) -> None:
    with Program(files / "burst.py") as program:
        for depth in (1, 5, 20):
            received = program.wait_for_log(f"depth {depth} received").partition("received ")[2].strip()
            assert received == str(list(range(21 - depth, 21)))
        assert ended_well(program), "".join(program.log)


def test_the_watch_tells_a_silent_sensor_from_a_dead_one(files: Path) -> None:
    with Program(files / "tilt_watch.py") as watch, started(files / "tilt_sensor.py") as (sensor, partner):
        node = Setter(partner, "tilt_sensor")
        watch.wait_for_log("liveliness: 1 alive, 0 not alive")
        assert node.set(text("trouble", "silent")).successful
        watch.wait_for_log("deadline missed")
        sensor.process.kill()
        watch.wait_for_log("liveliness: 0 alive, 1 not alive")
        assert ended_well(watch), "".join(watch.log)


def test_who_comes_late_gets_the_newest_model_and_only_if_it_asks_for_it(files: Path) -> None:
    latched: list[String] = []
    volatile: list[String] = []
    with started(files / "arm_model.py") as (program, partner):
        program.wait_for_log("Version 3")
        partner.node.create_subscription(String, "/arm_model", latched.append, LATCHED)
        partner.node.create_subscription(String, "/arm_model", volatile.append, 10)
        partner.spin_until(lambda: bool(latched), "the model")
        with Program(files / "model_reader.py") as reader:
            reader.wait_for_log("humanoid, version 3: ['left_elbow', 'right_elbow']")
            reader.wait_for_log("2 s later: 1 latched, 0 volatile")
            assert ended_well(reader), "".join(reader.log)
        assert ended_well(program), "".join(program.log)
    assert ["version 3" in model.data for model in latched] == [True]
    assert volatile == []
