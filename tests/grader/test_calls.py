"""Calls of a node's services, by which the runner knows what the node has handled."""

from __future__ import annotations

from collections.abc import Iterator

import pytest
import rclpy
from rcl_interfaces.srv import GetParameters
from rclpy.executors import SingleThreadedExecutor

from grader.runner.fastdds.graph import Caller, Calls
from grader.runner.fastdds.ros import Ros
from grader.sandbox import Isolation
from grader.workers.jobs import domain_for

REQUEST = GetParameters.Request()


@pytest.fixture
def ros() -> Iterator[Ros]:
    with Ros(domain_for(Isolation.NONE)) as ros:
        yield ros


class Slow:
    """A node that answers when it is told to."""

    def __init__(self, ros: Ros) -> None:
        self.node = ros.node("slow")
        self.asked = 0
        self.node.create_service(GetParameters, "/ask", self._answer)
        self._executor = SingleThreadedExecutor(context=ros.context)
        self._executor.add_node(self.node)

    def _answer(self, request: GetParameters.Request, answer: GetParameters.Response) -> GetParameters.Response:
        self.asked += 1
        return answer

    def turn(self, times: int) -> None:
        while self.asked < times:
            self._executor.spin_once(timeout_sec=1.0)


def test_what_was_repeated_is_answered_by_the_answer_to_the_repetition_alone(ros: Ros) -> None:
    slow = Slow(ros)
    calls = Calls(ros.context, [(Caller(ros.node("runner"), GetParameters, "/ask"), REQUEST)])
    while not calls.ready():
        pass
    calls.call(2)
    calls.call_again()
    assert not calls.answered()
    slow.turn(3)
    calls.wait(0.2)
    assert not calls.answered(), (
        "three answers have come: two to calls that were given up, one of two to their repetition"
    )
    slow.turn(4)
    while not calls.answered():
        calls.wait(1.0)


def test_nothing_is_waited_for_where_there_is_nothing_to_call(ros: Ros) -> None:
    calls = Calls(ros.context, ())
    calls.call(3)
    assert calls.answered()
    assert calls.ready()
    assert rclpy.ok(context=ros.context)
