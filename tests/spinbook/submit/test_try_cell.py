"""`%try` runs an exercise's node in real time among what surrounds it, with a live picture, until that ends or Stop."""

from __future__ import annotations

import pytest
from notebook_kernel import Kernel

from grader.recording.recording import Ending, ReceivedMessage, Recording
from spinbook.kernel.try_cell import robot_of
from submit.conftest import node_cell, solution


def test_a_cell_that_was_not_run_is_asked_for(kernel: Kernel) -> None:
    shown = kernel.run("%try joint_velocity")

    assert shown.error == "Run the cell that begins with %%node joint_velocity first. Then run this one again."


def test_an_unknown_scenario_lists_those_that_there_are(kernel: Kernel) -> None:
    kernel.run(node_cell(solution()))

    error = kernel.run("%try joint_velocity late").error

    assert error == "joint_velocity has no scenario `late`. There are: chapter, irregular."


def test_a_robot_that_the_node_describes_is_drawn() -> None:
    texts = ['<robot name="arm"><link name="hand"/></robot>', "no robot"]
    received = [
        ReceivedMessage(0, 0, "/robot_description", "std_msgs/msg/String", {"data": text}, node="/arm")
        for text in texts
    ]

    png, words = robot_of(Recording("late", (), tuple(received), (), (), False, Ending("completed")))

    assert png is not None
    assert png.startswith(b"\x89PNG")
    assert words == "The robot arm: no joint has moved."


@pytest.mark.soak  # in real time: on a busy machine, the scenario is over before Stop arrives
def test_the_node_is_started_again_and_drawn_until_stop(kernel: Kernel) -> None:
    kernel.run(node_cell(solution()))
    kernel.run("%stop --all")

    stop = kernel.pressing_stop(lambda shown: "from your node: /joint_velocities" in shown.text and bool(shown.updates))
    shown = kernel.run("%try joint_velocity irregular", stop)

    assert not shown.error
    assert "to your node: /joint_commands  header: (stamp: (sec: 100" in shown.text
    assert "what joint_velocity printed:" in shown.text
    assert len(shown.pictures) == 1
    assert "what your node does, and what the solution does" in shown.pictures[0]["text/plain"]
    running = kernel.run("%nodes").text
    assert "joint_velocity" in running
    assert "surroundings" not in running
