"""Week 3's nodes, as a student would save and run them: plain Python, real DDS, without Spinbook."""

from __future__ import annotations

import math
import os
import queue
import re
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager, suppress
from pathlib import Path
from typing import Any

import psutil
import pytest
import rclpy
from fault_of_rclpy import raise_if_in
from geometry_msgs.msg import Twist
from rcl_interfaces.srv import GetParameters
from rclpy.context import Context
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from rclpy.signals import SignalHandlerOptions
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import JointState

CHAPTER = Path(__file__).parents[2] / "chapters" / "03-nodes-and-topics.md"
NODE_FENCE = re.compile(r'^```python title="(\w+\.py)"[^\n]*\n(.*?)^```$', re.MULTILINE | re.DOTALL)

JOINTS: dict[str, Callable[[float], float]] = {
    "left_shoulder_pitch": lambda t: 0.5 * math.sin(t),
    "left_shoulder_roll": lambda t: 0.3 * math.cos(t),
    "left_elbow": lambda t: 0.8 * math.sin(2 * t),
    "right_shoulder_pitch": lambda t: -0.5 * math.sin(t),
    "right_shoulder_roll": lambda t: -0.3 * math.cos(t),
    "right_elbow": lambda t: -0.8 * math.sin(2 * t),
}
LIMITS = {
    "left_shoulder_pitch": (-1.57, 1.57),
    "left_shoulder_roll": (-0.785, 0.785),
    "left_elbow": (0.0, 2.356),
    "right_shoulder_pitch": (-1.57, 1.57),
    "right_shoulder_roll": (-0.785, 0.785),
    "right_elbow": (0.0, 2.356),
}
STEP = 100_000_000  # ns between two messages of a node at 10 Hz
DEADLINE_S = 60.0  # s until a test gives up; far more than anything here takes


class Program:
    """A node's file, run as a process whose log is read while it runs."""

    def __init__(self, file: Path, *ros_args: str) -> None:
        command = [sys.executable, os.fspath(file)]
        if ros_args:
            command += ["--ros-args", *ros_args]
        self.process = subprocess.Popen(
            command,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            env={**os.environ, "RCUTILS_COLORIZED_OUTPUT": "0"},
            start_new_session=True,
            # A shell's background job ignores SIGINT, and passes that on to everything it starts.
            preexec_fn=lambda: signal.signal(signal.SIGINT, signal.default_int_handler),
        )
        self.log: list[str] = []
        self._unread: queue.Queue[str | None] = queue.Queue()
        self._reader = threading.Thread(target=self._read, daemon=True)
        self._reader.start()

    def _read(self) -> None:
        assert self.process.stdout is not None
        for line in self.process.stdout:
            self._unread.put(line)
        self._unread.put(None)

    def wait_for_log(self, text: str) -> str:
        """Return the next line that contains `text`."""
        deadline = time.monotonic() + DEADLINE_S
        with suppress(queue.Empty):
            while line := self._unread.get(timeout=max(0.0, deadline - time.monotonic())):
                self.log.append(line)
                if text in line:
                    return line
        raise AssertionError(f"no (more) {text!r} in the log:\n{''.join(self.log)}")

    def wait_until_parked(self) -> None:
        """Wait until its main thread waits inside ROS and nothing wakes it.

        rclpy may fail with RCLError when SIGTERM arrives during one of its own calls. That is not a matter of the
        chapter's code, so these tests send the signal to a node that waits, as a node nearly always does.
        """
        process = psutil.Process(self.process.pid)
        quiet, before = 0, -1
        for _ in range(round(DEADLINE_S / 0.02)):
            now = process.num_ctx_switches().voluntary
            quiet = quiet + 1 if now == before and process.status() == psutil.STATUS_SLEEPING else 0
            if quiet == 10:
                return
            before = now
            time.sleep(0.02)
        raise AssertionError("the node's main thread never came to rest")

    def end(self, number: signal.Signals, wake: Callable[[], object] = lambda: None) -> int:
        """Send a signal, and return the exit code; the log is then complete. Raises FaultOfRclpy if it tells of that.

        rclpy's signal thread wakes the node before it shuts the context down. A node that is faster than this thread
        sees nothing new after SIGTERM, and waits for its next timer or message. `wake` sends it one.
        """
        self.process.send_signal(number)
        deadline = time.monotonic() + DEADLINE_S
        while self._still_runs() and time.monotonic() < deadline:
            wake()
        code = self.process.wait(1)
        self._reader.join(DEADLINE_S)
        while line := self._unread.get_nowait():
            self.log.append(line)
        raise_if_in("".join(self.log))
        return code

    def _still_runs(self) -> bool:
        try:
            self.process.wait(1)
        except subprocess.TimeoutExpired:
            return True
        return False

    def __enter__(self) -> Program:
        return self

    def __exit__(self, *_: object) -> None:
        if self.process.poll() is None:
            self.process.kill()
            self.process.wait()


class Partner:
    """The test's own node, with a context of its own and no signal handlers."""

    def __init__(self) -> None:
        self.context = Context()
        rclpy.init(context=self.context, signal_handler_options=SignalHandlerOptions.NO)
        self.node = Node("partner", context=self.context)
        self.executor = SingleThreadedExecutor(context=self.context)
        self.executor.add_node(self.node)

    def spin_until(self, condition: Callable[[], bool], what: str) -> None:
        deadline = time.monotonic() + DEADLINE_S
        while not condition():
            assert time.monotonic() < deadline, f"waited {DEADLINE_S:.0f} s for {what}"
            self.executor.spin_once(timeout_sec=0.05)

    def wait_until_known_to(self, node: str) -> None:
        """Wait until a node knows of every subscription that this one has made so far.

        It answers only who subscribes to its answers. That subscription is the last one that it is told of.
        """
        client = self.node.create_client(GetParameters, f"{node}/get_parameters")
        self.spin_until(client.service_is_ready, f"{node} to offer its parameters")

        def answered() -> bool:
            answer = client.call_async(GetParameters.Request(names=["use_sim_time"]))
            self.executor.spin_until_future_complete(answer, timeout_sec=1)
            return bool(answer.done())

        self.spin_until(answered, f"{node} to answer")

    def close(self) -> None:
        self.executor.shutdown()
        self.node.destroy_node()
        self.context.try_shutdown()


@contextmanager
def started(file: Path, *ros_args: str) -> Iterator[tuple[Program, Partner]]:
    """Yield a program and the test's own node, both ended in any case."""
    with ExitStack() as stack:
        program = stack.enter_context(Program(file, *ros_args))
        partner = Partner()
        stack.callback(partner.close)
        yield program, partner


@pytest.fixture
def files(tmp_path: Path, ros_domain: int, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder that holds the chapter's nodes, each saved as a plain .py; ROS is set up for this test alone."""
    monkeypatch.setenv("ROS_LOG_DIR", os.fspath(tmp_path / "log"))
    for name, code in NODE_FENCE.findall(CHAPTER.read_text(encoding="utf-8")):
        (tmp_path / name).write_text(code, encoding="utf-8")
    return tmp_path


def first_messages(file: Path, name: str, message_type: type, topic: str, count: int) -> list[Any]:
    """Return the first `count` messages of the node `name` at 10 Hz, under a clock that the test moves by hand."""
    heard: list[Any] = []
    with started(file, "-p", "use_sim_time:=true") as (program, partner):
        node = partner.node
        node.create_subscription(message_type, topic, heard.append, count)
        clock = node.create_publisher(Clock, "/clock", 10)
        partner.spin_until(lambda: clock.get_subscription_count() == 1, "the node to follow the clock")
        # Its first message is for those that it knows by then.
        partner.wait_until_known_to(name)
        for step in range(1, count + 1):
            tick = Clock()
            tick.clock.sec, tick.clock.nanosec = divmod(step * STEP, 10**9)

            def arrived(tick: Clock = tick, step: int = step) -> bool:
                # Repeated until it is received, as a clock is best effort; the same time twice changes nothing.
                if len(heard) < step:
                    clock.publish(tick)
                return len(heard) >= step

            partner.spin_until(arrived, f"message {step} on {topic}")
        assert program.end(signal.SIGINT) == 0, "".join(program.log)
    assert len(heard) == count
    return heard


@pytest.mark.parametrize("name", ["joint_publisher.py", "joint_monitor.py", "turtle_circle.py"])
@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM], ids=["SIGINT", "SIGTERM"])
def test_a_node_ends_in_good_order_when_asked_to(files: Path, name: str, number: signal.Signals) -> None:
    ros_name = {
        "joint_publisher.py": "joint_command_publisher",
        "joint_monitor.py": "joint_state_monitor",
        "turtle_circle.py": "turtle_circle",
    }[name]
    # While the clock stands still no timer is due, so the node has nothing to do but wait.
    with started(files / name, "-p", "use_sim_time:=true") as (program, partner):
        client = partner.node.create_client(GetParameters, f"/{ros_name}/get_parameters")
        partner.spin_until(client.service_is_ready, f"/{ros_name} to offer its parameters")
        answer = client.call_async(GetParameters.Request(names=["use_sim_time"]))
        partner.spin_until(answer.done, f"/{ros_name} to spin")
        program.wait_until_parked()
        code = program.end(number, wake=lambda: client.call_async(GetParameters.Request()))
        log = "".join(program.log)
        assert "Traceback" not in log, log
        assert code == 0, log


def test_the_publisher_commands_the_six_joints_of_the_table(files: Path) -> None:
    messages = first_messages(
        files / "joint_publisher.py", "/joint_command_publisher", JointState, "/joint_commands", 40
    )
    for index, message in enumerate(messages):
        assert message.name == list(JOINTS)
        assert list(message.position) == pytest.approx([f(0.1 * index) for f in JOINTS.values()], abs=1e-9)
        assert list(message.velocity) == [0.0] * 6
        assert list(message.effort) == []
        assert message.header.frame_id == "base_link"
        assert message.header.stamp.sec * 10**9 + message.header.stamp.nanosec == (index + 1) * STEP


def test_the_publisher_sends_about_ten_messages_a_second(files: Path) -> None:
    stamps: list[float] = []

    def on_message(message: JointState) -> None:
        stamps.append(message.header.stamp.sec + 1e-9 * message.header.stamp.nanosec)

    with started(files / "joint_publisher.py") as (program, partner):
        partner.node.create_subscription(JointState, "/joint_commands", on_message, 100)
        partner.spin_until(lambda: len(stamps) >= 21, "21 messages")
        program.wait_for_log("messages sent")
        assert program.end(signal.SIGINT) == 0, "".join(program.log)
    # A busy machine makes it slower now and then, but never faster for long.
    average = (stamps[20] - stamps[0]) / 20
    assert 0.08 < average < 0.5


def test_the_monitor_warns_of_each_joint_that_leaves_its_limits(files: Path) -> None:
    with started(files / "joint_monitor.py") as (program, partner):
        commands = partner.node.create_publisher(JointState, "/joint_commands", 50)
        partner.spin_until(lambda: commands.get_subscription_count() == 1, "the monitor to subscribe")
        for joint, (low, high) in LIMITS.items():
            for outside, inside in ((low - 0.001, low), (high + 0.001, high)):
                commands.publish(JointState(name=[joint], position=[outside]))
                line = program.wait_for_log("SAFETY:")
                assert joint in line
                assert re.search(rf"\]: SAFETY: .*{outside:.3f}", line)
                commands.publish(JointState(name=[joint], position=[inside]))


def test_the_monitor_says_once_that_a_joint_is_out_and_again_after_it_was_back(files: Path) -> None:
    with started(files / "joint_monitor.py") as (program, partner):
        commands = partner.node.create_publisher(JointState, "/joint_commands", 50)
        partner.spin_until(lambda: commands.get_subscription_count() == 1, "the monitor to subscribe")
        for position in (-0.1, -0.2, -0.3, 0.1, -0.4):
            commands.publish(JointState(name=["left_elbow"], position=[position]))
        commands.publish(JointState(name=["right_elbow"], position=[-0.5]))
        program.wait_for_log("right_elbow")
        warnings = [line for line in program.log if "SAFETY:" in line]
        assert [float(line.split(" at ")[1].split()[0]) for line in warnings] == [-0.1, -0.4, -0.5]


def test_the_monitor_is_silent_about_joints_within_their_limits(files: Path) -> None:
    with started(files / "joint_monitor.py") as (program, partner):
        commands = partner.node.create_publisher(JointState, "/joint_commands", 50)
        partner.spin_until(lambda: commands.get_subscription_count() == 1, "the monitor to subscribe")
        for at in (0.0, 0.5, 1.0):
            positions = [low + at * (high - low) for low, high in LIMITS.values()]
            commands.publish(JointState(name=list(LIMITS), position=positions))
        commands.publish(JointState(name=["a_joint_without_limits"], position=[100.0]))
        commands.publish(JointState())
        # The value outside the range is last: once it is reported, everything before it has been judged.
        commands.publish(JointState(name=["right_elbow"], position=[-0.5]))
        program.wait_for_log("right_elbow")
        assert [line for line in program.log if "SAFETY:" in line] == program.log[-1:]
        assert any("6 joints, first position: -1.570 rad" in line for line in program.log)


def test_beside_the_publisher_the_monitor_warns_of_both_elbows_and_of_no_other_joint(files: Path) -> None:
    with Program(files / "joint_monitor.py") as monitor, Program(files / "joint_publisher.py") as publisher:
        monitor.wait_for_log("SAFETY: left_elbow")
        monitor.wait_for_log("SAFETY: right_elbow")
        assert not [line for line in monitor.log if "SAFETY:" in line and "_elbow" not in line]
        assert publisher.end(signal.SIGINT) == 0, "".join(publisher.log)
        assert monitor.end(signal.SIGINT) == 0, "".join(monitor.log)


def test_the_turtle_turns_steadily_while_its_speed_rises_and_falls(files: Path) -> None:
    messages = first_messages(files / "turtle_circle.py", "/turtle_circle", Twist, "/turtle1/cmd_vel", 70)
    for index, message in enumerate(messages):
        assert message.linear.x == pytest.approx(2 + math.sin(0.1 * index), abs=1e-9)
        assert message.angular.z == 1.0
        assert [message.linear.y, message.linear.z, message.angular.x, message.angular.y] == [0.0] * 4
