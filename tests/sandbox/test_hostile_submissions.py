"""Every hostile submission, run against a real publisher in its sandbox: none escapes, and the runner is unharmed.

What the grader makes of them is tested in tests/hostile; this file only tests the sandbox.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

import psutil
import pytest
from sandbox_runner import Runner

from grader.sandbox import Exit, ForkServer, Isolation, Limits, Program

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

HOSTILE = Path(__file__).parents[1] / "hostile"
EXPECTED: dict[str, dict[str, Any]] = tomllib.loads((HOSTILE / "expected.toml").read_text())
PROFILE = Path(__file__).parents[2] / "grader" / "loopback.xml"
# Right, and with nothing of its own to hide.
HONEST = HOSTILE / "submissions" / "sets_use_sim_time_itself.py"
LIMITS = Limits(cpu_s=2.0, output_bytes=4 << 20, file_bytes=16 << 20, processes=96, wall_s=90.0)
# The folders that are watched for files that a student has left.
WATCHED = (Path("/tmp"), Path("/dev/shm"), Path("/var/tmp"), Path.home(), HOSTILE, HOSTILE.parents[1])
# Attacks on the machine are tried at every level; others (on the grading, or on nothing) at the strongest only.
EVERYWHERE = {
    *("fork_bomb_in_the_callback", "imports_the_grader", "kills_everything", "kills_its_parent", "log_1_gb"),
    *("looks_for_solutions", "memory_in_many_processes", "outlives_by_double_fork", "ptraces_others"),
    *("raises_its_limits", "reads_proc_of_others", "remembers_between_runs", "stops_itself", "writes_everywhere"),
    *("writes_to_every_descriptor",),
}
# One of each kind, for every `make test`. `make soak` runs all.
ALWAYS = {
    *("disk_in_many_files", "endless_loop_in_the_callback", "escapes_by_namespaces", "fork_bomb_in_the_callback"),
    *("kills_everything", "log_1_gb", "looks_for_solutions", "memory_10_gb", "network_access"),
    *("outlives_by_double_fork", "random_packets", "remembers_between_runs", "writes_everywhere"),
}
ALWAYS_EVERYWHERE = {"kills_everything"}


def size(names: Iterable[str], always: set[str]) -> list[Any]:
    """Return the parameters of a test, most of them for `make soak` only."""
    return [pytest.param(name, marks=() if name in always else pytest.mark.soak) for name in sorted(names)]


@dataclass(frozen=True)
class Spun:
    """What a submission did: how it ended, what it printed, how many answers the runner received, what it left."""

    exit: Exit | None
    text: str
    answers: int
    left_running: int


#: How long a submission runs: until it answers, until it ends by itself, or for a while if it may do neither.
Until = Literal["it answers", "it ends", "a while has passed"]

#: How long to wait for what has to arrive (s).
DEADLINE_S = 60.0


def spin(fork_server: ForkServer, level: Isolation, source: bytes, domain: int, until: Until) -> Spun:
    """In the runner: publish joint commands to a submission, receive its answers, interrupt and kill it."""
    import os

    import rclpy
    from rclpy.context import Context
    from rclpy.executors import SingleThreadedExecutor
    from rclpy.qos import QoSProfile, ReliabilityPolicy
    from sensor_msgs.msg import JointState

    ros = {
        "ROS_DOMAIN_ID": str(domain),
        "ROS_AUTOMATIC_DISCOVERY_RANGE": "SYSTEM_DEFAULT",
        "FASTRTPS_DEFAULT_PROFILES_FILE": str(PROFILE),
    }
    os.environ.update(ros)
    context = Context()
    rclpy.init(context=context, domain_id=domain)
    node = rclpy.create_node("runner", context=context)
    executor = SingleThreadedExecutor(context=context)
    executor.add_node(node)
    answers: list[JointState] = []
    publisher = node.create_publisher(JointState, "/joint_commands", 10)
    quality = QoSProfile(depth=100, reliability=ReliabilityPolicy.BEST_EFFORT)
    node.create_subscription(JointState, "/joint_velocities", answers.append, quality)
    program = Program("joint_velocity.py", {"joint_velocity.py": source}, environment=ros, readonly=(PROFILE,))
    try:
        with fork_server.start(program, level, LIMITS, core=0) as student:
            deadline = time.monotonic() + (DEADLINE_S if until == "it answers" else 3.0)
            while publisher.get_subscription_count() == 0 and time.monotonic() < deadline and student.poll() is None:
                executor.spin_once(timeout_sec=0.01)
            number, deadline = 0, time.monotonic() + (DEADLINE_S if until == "it answers" else 0.0)
            while number < 60 or (not answers and student.poll() is None and time.monotonic() < deadline):
                number += 1
                message = JointState(name=["left_elbow"], position=[0.01 * number])
                message.header.stamp.sec, message.header.stamp.nanosec = divmod(number * 10**8, 10**9)
                publisher.publish(message)
                executor.spin_once(timeout_sec=0.01)
            # Give answers the time to arrive, and a limit all the time that it takes to be reached.
            deadline = time.monotonic() + (DEADLINE_S if until == "it ends" else 0.0 if answers else 1.0)
            while student.wait(0.0) is None and time.monotonic() < deadline:
                executor.spin_once(timeout_sec=0.05)
            student.interrupt()
            student.wait(1.0)
        text = student.output().text
    finally:
        node.destroy_node()
        rclpy.shutdown(context=context)
    # Only the fork server itself must be left of all that it has started, once our own supervisor has ended.
    deadline = time.monotonic() + DEADLINE_S
    while (left := len(psutil.Process(os.getpid()).children(recursive=True)) - 1) and time.monotonic() < deadline:
        time.sleep(0.001)
    return Spun(student.exit, text, len(answers), left)


def files() -> set[Path]:
    """Return what is in the watched folders, except what tests and Python make there."""
    ours = ("pytest", "spinbook-", "nobody-", "hidden-checks-", "course-", "tmp", "pymp-", "sem.", ".", "fastrtps_")
    return {path for folder in WATCHED for path in folder.iterdir() if not path.name.startswith(ours)}


def over_limit(name: str) -> bool:
    """Return whether a submission is expected to hit a limit."""
    expected: bool = EXPECTED[name]["outcome"] == ["over-limit"]
    return expected


def spin_and_look(runner: Runner, name: str, domain: int) -> Spun:
    """Run a submission, and check what is true for each of them."""
    before = files()
    until: Until = "a while has passed"
    if over_limit(name):
        until = "it ends"
    elif EXPECTED[name]["score"] == "full":
        until = "it answers"
    spun: Spun = runner.do(spin, (HOSTILE / "submissions" / f"{name}.py").read_bytes(), domain, until)

    for word in EXPECTED[name].get("never", ()):
        assert word not in spun.text
    left = [path for path in files() - before if path.name.startswith(("written_by_a", "note-of-an", "results.json"))]
    assert left == []
    assert spun.left_running == 0
    assert spun.exit is not None
    honest: Spun = runner.do(spin, HONEST.read_bytes(), domain, "it answers")
    assert honest.answers > 0
    return spun


@pytest.mark.parametrize("name", size(EXPECTED, ALWAYS))
def test_a_hostile_submission_is_contained(strongest_runner: Runner, name: str, ros_domain: int) -> None:
    spun = spin_and_look(strongest_runner, name, ros_domain)

    if over_limit(name):
        assert spun.exit is not None
        assert spun.exit.limit is not None, spun.text
    if EXPECTED[name]["score"] == "full":
        assert spun.answers > 0, spun.text


@pytest.mark.parametrize("name", size(EVERYWHERE, ALWAYS_EVERYWHERE))
def test_an_attack_on_the_machine_is_contained_at_every_level(
    confined_runner: Runner, name: str, ros_domain: int
) -> None:
    spin_and_look(confined_runner, name, ros_domain)
