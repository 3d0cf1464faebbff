"""`ros2 action`."""

from __future__ import annotations

import re
import signal

import pytest
from ros2_terminal import Robot, Terminal

pytestmark = pytest.mark.usefixtures("ros_domain")

FIBONACCI = "test_msgs/action/Fibonacci"


def test_list_info_and_type(standing: Robot, terminal: Terminal) -> None:
    standing("action")
    assert terminal.ros2("action", "list", "-t").out == f"/fibonacci [{FIBONACCI}]\n"
    assert terminal.ros2("action", "type", "/fibonacci").out == f"{FIBONACCI}\n"
    assert terminal.ros2("action", "info", "-t", "/fibonacci").out == (
        f"Action: /fibonacci\nAction clients: 0\nAction servers: 1\n    /fibonacci_server [{FIBONACCI}]\n"
    )


def test_send_goal_prints_feedback_and_result(standing: Robot, terminal: Terminal) -> None:
    standing("action")
    out = terminal.ros2("action", "send_goal", "-f", "/fibonacci", FIBONACCI, "{order: 2}").out
    assert re.sub(r"ID: [0-9a-f]{32}", "ID: …", out) == (
        "Waiting for an action server to become available...\n"
        "Sending goal:\n     order: 2\n\n"
        "Goal accepted with ID: …\n\n"
        "Feedback:\n    sequence:\n- 0\n- 1\n- 1\n\n"
        "Result:\n    sequence:\n- 0\n- 1\n- 1\n\n"
        "Goal finished with status: SUCCEEDED\n"
    )


def test_feedback_stands_between_acceptance_and_result_whatever_overtakes_what(
    standing: Robot, terminal: Terminal
) -> None:
    standing("hasty_action")
    out = terminal.ros2("action", "send_goal", "-f", "/fibonacci", FIBONACCI).out
    heads = [line.split(":")[0] if line[:1].isupper() else line for line in out.splitlines() if line.strip()]
    feedback = [line for number in range(1, 6) for line in ("Feedback", "    sequence:", f"- {number}")]
    assert heads[heads.index("Goal accepted with ID") :] == [
        *("Goal accepted with ID", *feedback),
        *("Result", "    sequence:", "- 5", "Goal finished with status"),
    ]


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_signal_cancels_the_goal(standing: Robot, terminal: Terminal, number: int) -> None:
    standing("action")
    goal = terminal.start("action", "send_goal", "/fibonacci", FIBONACCI, "{order: 10000}")
    goal.lines(5)
    answer = goal.stop(number)
    assert answer.out.endswith("Canceling goal...\nGoal canceled.\n")
    assert answer.err == ""


def test_the_wrong_type_is_refused(standing: Robot, terminal: Terminal) -> None:
    standing("action")
    other = terminal.ros2("action", "send_goal", "/fibonacci", "test_msgs/action/NestedMessage")
    assert other.code == 1
    assert f"is of type {FIBONACCI}" in other.err
    twin = terminal.ros2("action", "send_goal", "/fibonacci", "example_interfaces/action/Fibonacci", "{order: 1}")
    assert twin.code == 1
    assert f"is of type {FIBONACCI}" in twin.err
