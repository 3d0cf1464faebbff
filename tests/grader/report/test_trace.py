"""`spinbook trace` shows one scenario of an exercise, also when its solution fails."""

from __future__ import annotations

import time
from dataclasses import replace
from pathlib import Path

import pytest
from click.testing import CliRunner, Result

from grader.recording import Ending, ReceivedMessage, Recording, SentMessage
from grader.recording.events import Call, Goal, GoalState, ParameterChange, Truth
from grader.report import trace as trace_module
from grader.report.timeline import lines_of
from grader.report.trace import trace
from grader.scenario.scenario import ToWorld

SECOND, START = 1_000_000_000, 100_000_000_000
TOML = """\
title = "Echo"
points = 2
file = "echo.py"
node = "echo"

[[subscribe]]
topic = "/in"
type = "std_msgs/msg/Float64"

[[publish]]
topic = "/out"
type = "std_msgs/msg/Float64"
"""
SCENARIOS = """\
from grader.scenario import Scenario, at


def scenarios(seed):
    return tuple(Scenario(name, name, at(0.1, 0.2).publish("/in", data=value)) for name, value in
                 (("one", 1.0), ("two", 2.0)))
"""
CHECKS = """\
from grader.checking import Run, check


@check(points=1, hint="Publish.")
def test_one(one: Run) -> None:
    \"\"\"It publishes.\"\"\"
    one.must_publish("/out")


@check(points=1, hint="Double it.", depends=[test_one])
def test_two(two: Run) -> None:
    \"\"\"It doubles.\"\"\"
    assert two.messages_on("/out")[0].data == 4.0, "expected 4"
"""
SOLUTION = """\
import rclpy
from std_msgs.msg import Float64

rclpy.init()
node = rclpy.create_node("echo")
node.get_logger().info("Ready")
# TODO: publish.
# BEGIN SOLUTION
out = node.create_publisher(Float64, "/out", 10)
# END SOLUTION
node.create_subscription(Float64, "/in", lambda m: out.publish(m), 10)
rclpy.spin(node)
"""


@pytest.fixture(scope="module")
def exercise(tmp_path_factory: pytest.TempPathFactory) -> Path:
    root = tmp_path_factory.mktemp("trace")
    files = {"exercise.toml": TOML, "task.md": "# Echo\n", "scenarios.py": SCENARIOS, "checks.py": CHECKS}
    files = {f"exercises/echo/{name}": text for name, text in files.items()}
    for name, text in {**files, "solutions/echo/solution.py": SOLUTION}.items():
        (root / name).parent.mkdir(parents=True, exist_ok=True)
        (root / name).write_text(text)
    return root / "exercises" / "echo"


def run(*words: object) -> Result:
    return CliRunner().invoke(trace, [str(word) for word in words])


def test_a_scenario_that_the_solution_fails_is_shown_drawn_and_written(exercise: Path, tmp_path: Path) -> None:
    result = run(exercise, "-s", "two", "--log", "--plot", tmp_path / "two.svg", "--bag", tmp_path / "bags")
    assert result.exit_code == 0, result.output
    assert "    0.100 s  → /in  data = 2\n    0.100 s  ← /out  data = 2\n" in result.output
    assert "✗    0/1  It doubles." in result.output
    assert "It publishes." not in result.output
    assert "[INFO] [echo]: Ready" in result.output
    assert not (tmp_path / "two.svg").exists()
    assert "there is nothing to draw, no number that changes" in result.output
    assert (tmp_path / "bags" / "two" / "metadata.yaml").exists()


def test_wrong_names_and_an_exercise_at_fault_are_said(exercise: Path) -> None:
    assert "the scenarios are one, two" in run(exercise, "-s", "three").output
    scenarios = exercise / "scenarios.py"
    scenarios.write_text(SCENARIOS.replace("1.0", "1"))
    try:
        result = run(exercise)
    finally:
        scenarios.write_text(SCENARIOS)
    assert result.exit_code == 3
    assert "scenarios.py:5: /in: 1 (int) is given for data" in result.output


def test_a_saved_file_is_noticed(exercise: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    looks = iter([lambda: None, (exercise / "scenarios.py").touch])

    def look(seconds: float) -> None:
        try:
            next(looks)()
        except StopIteration:
            raise KeyboardInterrupt from None

    monkeypatch.setattr(time, "sleep", look)
    monkeypatch.setattr(trace_module, "_traced", lambda asked, workers: 0)
    result = run(exercise, "--watch")
    assert result.output.count("scenarios.py was saved: again") == 1
    assert result.exit_code == 0


def test_the_timeline_has_all_kinds_of_events_and_thins_messages() -> None:
    def at(seconds: float) -> int:
        return START + round(seconds * SECOND)

    fields = {"header": {"stamp": {"sec": 0, "nanosec": 0}, "frame_id": ""}, "x": 0.0, "list": [1.0] * 9}
    recording = Recording("s", (), (), (), (), True, Ending("completed"))
    recording = replace(
        recording,
        sent=(SentMessage(at(0), "/in", "", fields, heard=False),),
        received=tuple(ReceivedMessage(at(n / 10), 1, "/out", "", {"data": float(n)}) for n in range(40)),
        calls=(Call(at(1), "/add", "", {"a": 1}, "grader", at(1.5), {"sum": 3}),),
        goals=(Goal(1, at(2), "/go", "", {"to": 1}, "grader", True, at(2), (GoalState(at(2), "executing"),)),),
        parameters=(ParameterChange(at(3), "/node", "gain", -1.0, False, "too low"),),
        truth=tuple(Truth(at(n / 10), {"x": 1.0}) for n in range(14)),
    )
    push = ToWorld(at(3), "push", {"body": "pole"})
    assert "    3.000 s  • world push  body = 'pole'" in lines_of(recording, steps=(push,))
    lines = list(lines_of(recording))
    assert "    0.000 s  → /in  x = 0, list = [1, 1, 1, 1, 1, 1, 1, 1, …]  (nobody subscribes)" in lines
    assert "    1.500 s  • response /add  sum = 3" in lines
    assert "    2.000 s  • state /go 1  executing" in lines
    assert "    3.000 s  • set gain  -1.0: refused too low" in lines
    assert "    0.000 s  = truth  x = 1" in lines
    assert {*lines[-2:]} == {
        "28 more messages of /out are not shown: --all shows them.",
        "2 more messages of truth are not shown: --all shows them.",
    }
    assert sum("← /out" in line for line in lines) == 12
    assert sum("← /out" in line for line in lines_of(recording, everything=True)) == 40
    assert {line.split()[3] for line in lines_of(recording, ("/add",))} == {"request", "response"}


def test_of_a_stamped_message_what_changes_comes_first_and_its_stamp_is_short() -> None:
    def scan(n: int) -> SentMessage:
        header = {"stamp": {"sec": 100, "nanosec": n * SECOND // 10}, "frame_id": "laser_of_the_robot"}
        fields = {"header": header, "angle_min": -1.5707963, "angle_max": 1.5707963, "ranges": [float(n)] * 9}
        return SentMessage(START + n * SECOND // 10, "/scan", "", fields)

    recording = Recording("s", tuple(map(scan, (1, 2))), (), (), (), True, Ending("completed"))
    first, _ = lines_of(recording)
    assert first.startswith("    0.100 s  → /scan  ranges = [1, 1, 1, 1, 1, 1, 1, 1, …], stamp = 100.100, ")
