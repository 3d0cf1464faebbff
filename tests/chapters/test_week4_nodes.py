"""Week 4's nodes, as a student would save and run them: what the chapter claims but its notebook does not show."""

from __future__ import annotations

import os
import re
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest
import rclpy
from action_msgs.msg import GoalStatus
from rclpy.action import ActionClient
from rclpy.context import Context
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from rclpy.signals import SignalHandlerOptions
from std_msgs.msg import Int32
from test_msgs.action import Fibonacci

CHAPTER = Path(__file__).parents[2] / "chapters" / "04-services-and-actions.md"
NODE_FENCE = re.compile(r'^```python title="(\w+\.py)"[^\n]*\n(.*?)^```$', re.MULTILINE | re.DOTALL)
CODE = dict(NODE_FENCE.findall(CHAPTER.read_text(encoding="utf-8")))
DEADLINE_S = 60.0  # s until a test gives up; far more than anything here takes


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

    def done(self, future: Any, what: str) -> Any:
        self.spin_until(future.done, what)
        return future.result()


@pytest.fixture
def partner(ros_domain: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Partner]:
    """A node in the test's own ROS domain."""
    monkeypatch.setenv("ROS_LOG_DIR", os.fspath(tmp_path / "log"))
    made = Partner()
    yield made
    made.executor.shutdown()
    made.node.destroy_node()
    made.context.try_shutdown()


@contextmanager
def running(folder: Path, *programs: str) -> Iterator[list[subprocess.Popen[str]]]:
    """Run programs, given by their code, until the end of the block."""
    started = []
    try:
        for number, code in enumerate(programs):
            file = folder / f"program{number}.py"
            file.write_text(code, encoding="utf-8")
            started.append(
                subprocess.Popen(
                    [sys.executable, os.fspath(file)],
                    stdout=subprocess.PIPE,
                    stderr=subprocess.STDOUT,
                    text=True,
                    start_new_session=True,
                    preexec_fn=lambda: signal.signal(signal.SIGINT, signal.default_int_handler),
                )
            )
        yield started
    finally:
        for process in started:
            process.kill()
            process.communicate()


def with_test_action(file: str) -> str:
    """Return a node's code with an action that is installed everywhere, instead of the course's own.

    Fibonacci's goal is a whole number, and its result and feedback are lists: enough to follow a goal.
    """
    code = CODE[file].replace("from humanoid_control_interfaces.action import MoveJoint\n", "")
    code = code.replace("import rclpy\n", "import rclpy\nfrom test_msgs.action import Fibonacci as MoveJoint\n", 1)
    code = code.replace("request.position", "request.order").replace("goal.position", "goal.order")
    code = re.sub(r"MoveJoint\.(Result|Feedback)\(position=[\w.]+\)", r"MoveJoint.\1()", code)
    # Steps take a tenth of the time: the tests wait for events, not for a duration.
    return code.replace("self.position = 0.0", "self.position = 0").replace("seconds=0.2", "seconds=0.02")


def end_of(partner: Partner, goal: int) -> tuple[bool, int]:
    """Return (whether a goal is accepted, the status with which it ended)."""
    client = ActionClient(partner.node, Fibonacci, "/move_elbow")
    partner.spin_until(client.server_is_ready, "the action server")
    handle = partner.done(client.send_goal_async(Fibonacci.Goal(order=goal)), "the answer to the goal")
    answer = partner.done(handle.get_result_async(), "the result")
    client.destroy()
    return handle.accepted, answer.status


def heard_on(partner: Partner, topic: str) -> list[int]:
    """Return the numbers from a topic: a list that grows while the partner spins."""
    heard: list[int] = []

    def hear(msg: Any) -> None:
        heard.append(msg.data)

    partner.node.create_subscription(Int32, topic, hear, 100)
    return heard


def test_the_client_with_a_done_callback_asks_again_and_the_one_that_calls_without_a_limit_never_does(
    partner: Partner, tmp_path: Path
) -> None:
    ticks = heard_on(partner, "/ticks")
    stuck = CODE["stuck_client.py"].replace(", timeout_sec=1.5", "").replace("'/ticks'", "'/stuck_ticks'")
    with running(tmp_path, CODE["tare_server.py"], CODE["tare_client.py"], stuck) as (_, _, client):
        assert client.stdout is not None
        assert "I ask" in client.stdout.readline()
        so_far = max(ticks, default=0)
        partner.spin_until(lambda: max(ticks, default=0) > so_far + 50, "two more questions of the client beside it")
        client.kill()
        assert client.stdout.read() == ""


def test_the_complete_server_rejects_what_is_beyond_the_limits_and_a_rejected_goal_has_the_status_0(
    partner: Partner, tmp_path: Path
) -> None:
    with running(tmp_path, with_test_action("elbow_server.py")):
        assert end_of(partner, 3) == (False, GoalStatus.STATUS_UNKNOWN)
        assert end_of(partner, 1) == (True, GoalStatus.STATUS_SUCCEEDED)
        assert end_of(partner, 2) == (True, GoalStatus.STATUS_ABORTED)
        assert end_of(partner, 0) == (True, GoalStatus.STATUS_SUCCEEDED)


def test_a_success_that_nobody_called_so_is_aborted_and_so_is_an_exception(partner: Partner, tmp_path: Path) -> None:
    with running(tmp_path, with_test_action("forgetful_elbow.py")):
        assert end_of(partner, 1) == (True, GoalStatus.STATUS_ABORTED)
        assert end_of(partner, -1) == (True, GoalStatus.STATUS_ABORTED)
        assert end_of(partner, 1) == (True, GoalStatus.STATUS_ABORTED)


@pytest.mark.parametrize(("left_out", "how_many"), [("", 1), ("cancel_callback=self.on_cancel,", 0)])
def test_a_server_without_a_cancel_callback_refuses_to_cancel(
    partner: Partner, tmp_path: Path, left_out: str, how_many: int
) -> None:
    with running(tmp_path, with_test_action("second_elbow.py").replace(left_out, "")):
        client = ActionClient(partner.node, Fibonacci, "/move_elbow")
        partner.spin_until(client.server_is_ready, "the action server")
        handle = partner.done(client.send_goal_async(Fibonacci.Goal(order=1000)), "the answer to the goal")
        answer = partner.done(handle.cancel_goal_async(), "the answer to the request to cancel")
        client.destroy()
    assert len(answer.goals_canceling) == how_many
