"""A check in the page records and prints what the real grader's public part does, for every solution and mistake."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[3]
IN_BOTH = Path(__file__).with_name("checks_in_both.py")
#: Checked by every `make test`; `make soak` checks all.
ALWAYS = ("solution", "degrees", "several_threads")
EXERCISES = sorted(folder.name for folder in (ROOT / "exercises").iterdir() if (folder / "exercise.toml").is_file())
#: A page can't run these, and says so.
NEEDS_MORE = {
    "joint_velocity": {"asyncio_loop", "numpy_arrays"},
    "joint_filter": {"numpy_arrays"},
}


#: Uses messages without importing them when the grader has published some, and after programs that import them.
FORGETFUL = """
import rclpy
import sensor_msgs
from rclpy.node import Node
from std_msgs.msg import Float64MultiArray


class JointVelocity(Node):
    def __init__(self):
        super().__init__("joint_velocity")
        self.publisher = self.create_publisher(Float64MultiArray, "/joint_velocities", 10)
        self.ticks = 0
        self.create_timer(0.1, self.tick)

    def tick(self):
        self.ticks += 1
        self.publisher.publish(Float64MultiArray(data=[float(hasattr(sensor_msgs, "msg"))]))
        if self.ticks == 5:
            self.create_subscription(sensor_msgs.msg.JointState, "/joint_states", print, 10)


rclpy.init()
rclpy.spin(JointVelocity())
"""


#: Both keep themselves busy at one moment, in ways that the hub does not see by itself.
ANSWERS_ITSELF = ROOT / "benchmarks/determinism/programs/answers_itself.py"
CALLS_ITSELF = """
import rclpy
from rclpy.node import Node
from sensor_msgs.msg import JointState
from std_srvs.srv import Trigger


class JointVelocity(Node):
    def __init__(self):
        super().__init__("joint_velocity")
        self.create_subscription(JointState, "/joint_commands", self.call, 10)
        self.create_service(Trigger, "/again", lambda request, response: response)
        self.client = self.create_client(Trigger, "/again")

    def call(self, _):
        self.client.call_async(Trigger.Request()).add_done_callback(self.call)


rclpy.init()
rclpy.spin(JointVelocity())
"""


#: Has always something to do, in three ways.
NEVER_DONE = """
import rclpy
from rclpy.executors import MultiThreadedExecutor, SingleThreadedExecutor
from rclpy.node import Node
from sensor_msgs.msg import JointState


class JointVelocity(Node):
    def __init__(self):
        super().__init__("joint_velocity")
        self.publisher = self.create_publisher(JointState, "/joint_velocities", 10)
        self.create_subscription(JointState, "/joint_commands", self.publisher.publish, 10)
        self.create_timer(0.0, lambda: None)
        self.guard = self.create_guard_condition(lambda: self.guard.trigger())
        self.guard.trigger()


def turn():
    executor.create_task(turn)


rclpy.init()
node = JointVelocity()
executor = SingleThreadedExecutor()
executor.add_node(node)
turn()
executor.spin()
"""
IN_THREADS = NEVER_DONE.replace("= SingleThreadedExecutor()", "= MultiThreadedExecutor(4)")


def found(exercise: str, *names: str) -> dict[str, str]:
    """Return the comparison's result for each program."""
    command = [sys.executable, os.fspath(IN_BOTH), exercise, *names]
    done = subprocess.run(command, capture_output=True, text=True, cwd=ROOT, check=False)
    assert done.returncode == 0, done.stderr
    said: dict[str, str] = json.loads(done.stdout.splitlines()[-1])
    return said


#: Here an assertion of the course's own compiled messages ends the program; in a page, Python's exception does.
ENDED_BY_C = {"joint_mover": {"returns_nothing"}}


def differing(exercise: str, said: dict[str, str]) -> dict[str, str]:
    """Return the programs that differ, without those that a page refuses to run, as it should."""
    refused = {name for name, words in said.items() if words.startswith("not checked: ")}
    assert refused == NEEDS_MORE.get(exercise, set()) & set(said)
    expected = refused | ENDED_BY_C.get(exercise, set())
    return {name: words for name, words in said.items() if words != "same" and name not in expected}


def written(folder: Path, **sources: str) -> list[str]:
    """Write programs into files, and return their paths."""
    for name, source in sources.items():
        (folder / f"{name}.py").write_text(source, encoding="utf-8")
    return [str(folder / f"{name}.py") for name in sources]


def test_a_check_in_the_page_comes_to_the_same(tmp_path: Path) -> None:
    said = found("joint_velocity", *ALWAYS, *written(tmp_path, forgetful=FORGETFUL, never_done=NEVER_DONE))
    assert len(said) == len(ALWAYS) + 2
    assert differing("joint_velocity", said) == {}


@pytest.mark.soak
def test_a_check_of_a_program_that_is_never_done_comes_to_the_same(tmp_path: Path) -> None:
    busy = written(tmp_path, calls_itself=CALLS_ITSELF, in_threads=IN_THREADS)
    said = found("joint_velocity", str(ANSWERS_ITSELF), *busy)
    assert len(said) == 3
    assert differing("joint_velocity", said) == {}


@pytest.mark.soak
@pytest.mark.timeout(3600)
@pytest.mark.parametrize("exercise", EXERCISES)
def test_every_check_in_the_page_comes_to_the_same(exercise: str) -> None:
    assert differing(exercise, found(exercise)) == {}
