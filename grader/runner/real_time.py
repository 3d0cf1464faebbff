"""Plays the grader's side of a scenario over real ROS 2, in real time, next to a program that somebody else runs.

The reference publishers, servers, clients and the world are those of a grading, and so is the recording; but nothing
waits for the program, so this judges nothing.
"""

from __future__ import annotations

import time
from collections import deque
from collections.abc import Callable, Iterator

from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node

from grader.exercise.exercise import Exercise
from grader.recording.recording import Ending, Recording
from grader.runner.grader_side import Clocks, GraderSide
from grader.runner.program import Task
from grader.runner.publishers import ReferencePublishers
from grader.runner.real_ros import RealRos
from grader.runner.recorder import Recorder, recorded_topics
from grader.runner.script import AFTERWARDS, Script
from grader.scenario.scenario import SECOND, START, Message, Scenario

#: How long the program may take to appear, and then to connect to everything (s).
APPEAR_S, CONNECT_S = 10.0, 5.0
#: The time between two reports (s).
REPORT_S = 0.5


class RealTimeRun:
    """One scenario around a program that is there or still to come."""

    def __init__(self, node: Node, exercise: Exercise, scenario: Scenario) -> None:
        self._node, self._exercise, self._scenario = node, exercise, scenario
        self._executor = SingleThreadedExecutor(context=node.context)
        self._executor.add_node(node)
        self._ros = RealRos(node)
        self._clocks, hub_node = Clocks("simulated"), self._ros.node()
        task = Task(exercise, scenario, exercise.file_name, "", 1.0)
        self._recorder = Recorder(hub_node, recorded_topics(task))
        self._publishers = ReferencePublishers(hub_node, scenario)
        ends = GraderSide(self._ros, hub_node, self._clocks)
        self._script = Script(ends, task, self._publishers, self._recorder, self._publish)
        self._began = 0

    def _publish(self, message: Message) -> None:
        self._publishers.publish(message)

    def wait_for_program(self) -> str:
        """Wait until the program is there and connected. Return what is missing after a while, in words."""
        there = self._until(lambda: self._exercise.node_name in self._node.get_node_names(), APPEAR_S)
        if not there:
            own = self._node.get_name()
            others = ", ".join(sorted(name for name in self._node.get_node_names() if name != own)) or "none"
            name = self._exercise.node_name
            return f"No node called {name} has appeared within {APPEAR_S:g} s. Nodes that are there: {others}."
        self._until(lambda: not any(self._missing()), CONNECT_S)
        return " ".join(self._missing())

    def _missing(self) -> Iterator[str]:
        for topic in sorted({message.topic for message in self._scenario.messages}):
            if not self._node.count_subscribers(topic):
                yield f"Your node does not subscribe to {topic}."
        yield from (f"Your node does not serve {name}." for name in self._ros.missing_servers())

    def _until(self, condition: Callable[[], bool], seconds: float) -> bool:
        deadline = time.monotonic() + seconds
        while not (done := condition()) and time.monotonic() < deadline:
            self._executor.spin_once(timeout_sec=0.05)
        return done

    def play(self, report: Callable[[Recording], None]) -> None:
        """Play the scenario to its end, with a report now and then. Raises `ExerciseError` and `CannotContinue`."""
        self._began = time.monotonic_ns()
        self._clocks.set(START, self._began, 0)
        content, next_report = deque(self._scenario.content), START
        end = START + round(self._scenario.seconds * SECOND) + AFTERWARDS
        while (now := self._now()) < end or content:
            while content and content[0].at <= now:
                one = content.popleft()
                self._publish(one) if isinstance(one, Message) else self._script.do(one)
            while self._script.act(min(self._script.due or now, now)):
                pass
            if now >= next_report:
                report(self.recording())
                next_report = self._now() + round(REPORT_S * SECOND)
            due = [content[0].at] if content else []
            self._spin(min([*due, self._script.due or end, next_report, end]))

    def _now(self) -> int:
        return START + time.monotonic_ns() - self._began

    def _spin(self, until: int) -> None:
        """Take what arrives; return after the first thing, or when it is `until` (ns)."""
        self._executor.spin_once(timeout_sec=max(0.0, (until - self._now()) / SECOND))

    def recording(self) -> Recording:
        """Return what has happened so far."""
        return Recording(
            scenario=self._scenario.name,
            sent=tuple(self._publishers.sent),
            received=self._recorder.received(self._clocks, self._publishers.stages),
            nodes=(),
            end_points=(),
            uses_sim_time=False,
            ending=Ending("completed"),
            **self._script.recorded(),
        )
