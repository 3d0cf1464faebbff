"""A scenario in real time over real ROS 2: topics, services and actions, in both directions."""

from __future__ import annotations

import contextlib
import gc
import threading
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
import rclpy
from rclpy.action import ActionClient, ActionServer
from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor
from rclpy.node import Node
from ros_domains import nodes_left, reserved
from std_msgs.msg import String
from std_srvs.srv import SetBool, Trigger
from test_msgs.action import Fibonacci

from grader.exercise import load
from grader.exercise.exercise import Topic
from grader.recording.recording import Recording
from grader.runner.real_time import RealTimeRun
from grader.scenario import ActionServer as ScriptedActionServer
from grader.scenario import Scenario, Server, at, reply, succeeds

TEXT, FIBONACCI = "std_msgs/msg/String", "test_msgs/action/Fibonacci"
EXERCISE = replace(
    load(Path(__file__).parents[3] / "exercises" / "heartbeat"),
    node_name="student",
    topics=(Topic("/in", TEXT, "subscribe"), Topic("/out", TEXT, "publish")),
)
SCENARIO = Scenario(
    "both",
    "every kind of endpoint, in both directions",
    (
        at(0.1).publish("/in", TEXT, data="hello"),
        at(0.2).call("/switch", "std_srvs/srv/SetBool", data=True),
        at(0.3).send_goal("/count", FIBONACCI, order=2),
    ),
    servers=(
        Server("/ask", "std_srvs/srv/Trigger", reply(0.2, success=True, message="later")),
        ScriptedActionServer("/go", FIBONACCI, succeeds(0.3, {"sequence": [7]}, {0.1: {"sequence": [1]}})),
    ),
    duration=1.0,
)


class Student(Node):
    """Answers everything, and asks for everything when a message arrives."""

    def __init__(self, context: Any) -> None:
        super().__init__("student", context=context)
        self.out = self.create_publisher(String, "/out", 10)
        self.create_subscription(String, "/in", self.ask, 10)
        self.create_service(SetBool, "/switch", self.switch)
        self.asks = self.create_client(Trigger, "/ask")
        self.goes = ActionClient(self, Fibonacci, "/go")
        self.counts = ActionServer(self, Fibonacci, "/count", self.count)

    def ask(self, message: String) -> None:
        self.asks.call_async(Trigger.Request()).add_done_callback(lambda done: self.say(done.result().message))
        sent = self.goes.send_goal_async(Fibonacci.Goal(order=5), lambda heard: self.say("feedback"))
        sent.add_done_callback(lambda done: done.result().get_result_async())

    def say(self, text: str) -> None:
        self.out.publish(String(data=text))

    def switch(self, request: SetBool.Request, response: SetBool.Response) -> SetBool.Response:
        response.success = request.data
        return response

    def count(self, goal: Any) -> Fibonacci.Result:
        goal.succeed()
        return Fibonacci.Result(sequence=[0, 1])


def spun(executor: SingleThreadedExecutor) -> None:
    """Spin until the context is shut down."""
    with contextlib.suppress(ExternalShutdownException):
        executor.spin()


@pytest.fixture(scope="module")
def recording() -> Iterator[Recording]:
    """What happened to a student's node in the scenario."""
    with reserved() as domain:
        context = rclpy.Context()
        rclpy.init(context=context, domain_id=domain)
        executor = SingleThreadedExecutor(context=context)
        student, reference = Student(context), rclpy.create_node("reference", context=context)
        executor.add_node(student)
        spinning = threading.Thread(target=spun, args=[executor], daemon=True)
        spinning.start()
        run = RealTimeRun(reference, EXERCISE, SCENARIO)
        assert run.wait_for_program() == ""
        run.play(lambda so_far: None)
        yield run.recording()
        rclpy.try_shutdown(context=context)
        spinning.join(10)
        student.goes.destroy()
        student.counts.destroy()
        leave(student, reference)
        del run, executor, student, reference, context
        gc.collect()
        assert not nodes_left()


def leave(*nodes: Node) -> None:
    """Take nodes out of their ROS domain, which the next test uses."""
    for node in nodes:
        node.destroy_node()


def test_messages_arrive_in_both_directions(recording: Recording) -> None:
    assert [(one.topic, one.fields["data"]) for one in recording.sent] == [("/in", "hello")]
    assert [one.fields["data"] for one in recording.received] == ["feedback", "later"]


def test_the_students_service_is_called_and_a_server_answers_when_it_should(recording: Recording) -> None:
    own, asked = sorted(recording.calls, key=lambda call: call.by)

    assert (own.service, own.response) == ("/switch", {"success": True, "message": ""})
    assert (asked.service, asked.response) == ("/ask", {"success": True, "message": "later"})
    assert asked.answered_ns is not None
    assert asked.answered_ns - asked.at_ns >= 200_000_000


def test_goals_run_to_their_ends_on_both_sides(recording: Recording) -> None:
    ends = {(goal.action, goal.by, goal.status, str(goal.result)) for goal in recording.goals}

    assert ends == {
        ("/count", "grader", "succeeded", "{'sequence': [0, 1]}"),
        ("/go", "node", "succeeded", "{'sequence': [7]}"),
    }


def test_what_a_program_lacks_is_named() -> None:
    with reserved() as domain:
        context = rclpy.Context()
        rclpy.init(context=context, domain_id=domain)
        student = rclpy.create_node(EXERCISE.node_name, context=context)
        reference = rclpy.create_node("reference", context=context)
        lacks = RealTimeRun(reference, EXERCISE, SCENARIO).wait_for_program()
        rclpy.try_shutdown(context=context)
        leave(student, reference)
    assert (
        lacks
        == "Your node does not subscribe to /in. Your node does not serve /count. Your node does not serve /switch."
    )
