"""`%try` runs an exercise's node in real time among what surrounds it, with a live picture, until that ends or Stop."""

from __future__ import annotations

import pytest
from notebook_kernel import Kernel

from grader.recording.events import Fields
from grader.recording.recording import Ending, ReceivedMessage, Recording
from grader.scenario.scenario import SECOND
from spinbook.kernel.surroundings import events_of, robot_of
from spinbook.kernel.timeline import lanes
from submit.conftest import node_cell, solution


def test_an_unknown_scenario_lists_those_that_there_are(kernel: Kernel) -> None:
    kernel.run(node_cell(solution()))

    error = kernel.run("%try joint_velocity late").error

    assert error == "joint_velocity has no scenario `late`. There are: chapter, irregular."


def a_recording(topic: str, *messages: Fields) -> Recording:
    received = [ReceivedMessage(SECOND * at, 0, topic, "", fields) for at, fields in enumerate(messages)]
    return Recording("late", (), tuple(received), (), (), False, Ending("completed"))


def test_a_robot_that_the_node_describes_is_drawn() -> None:
    texts = ['<robot name="arm"><link name="hand"/></robot>', "no robot"]

    robot = robot_of(a_recording("/robot_description", *({"data": text} for text in texts)))

    assert robot is not None
    assert robot.name == "arm"


def test_messages_without_numbers_to_plot_are_drawn_along_time() -> None:
    (beats,) = lanes(events_of(a_recording("/heartbeat", {}, {}, {})))

    assert (beats.name, [mark.at for mark in beats.marks]) == ("/heartbeat", [0, 1, 2])


@pytest.mark.soak  # in real time: on a busy machine, the scenario is over before Stop arrives
def test_the_node_is_started_again_and_drawn_until_stop(kernel: Kernel) -> None:
    kernel.run(node_cell(solution()))
    kernel.run("%stop --all")

    stop = kernel.pressing_stop(lambda shown: "from your node: /joint_velocities" in shown.text and bool(shown.updates))
    shown = kernel.run("%try joint_velocity irregular", stop)

    assert not shown.error
    assert "to your node: /joint_commands  header: (" in shown.text
    assert "what joint_velocity printed:" in shown.text
    assert len(shown.pictures) == 1
    assert "what your node does, and what the solution does" in shown.pictures[0]["text/plain"]
    running = kernel.run("%nodes").text
    assert "joint_velocity" in running
    assert "surroundings" not in running
