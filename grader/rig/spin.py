"""Spins one student's program through one scenario, in lockstep with simulated time."""

from __future__ import annotations

import time
from collections.abc import Callable

from grader.recording import Ending, EndPoint, Recording
from grader.rig.clock import Clock
from grader.rig.ending import interrupted
from grader.rig.fence import AFTER_CLOCK, AFTER_MESSAGES, Fence, Gone
from grader.rig.graph import Graph
from grader.rig.meeting import Discovery, let_in, wait_for_nodes, wait_until_connected
from grader.rig.publishers import ReferencePublishers
from grader.rig.quiet import Receivers, Threads
from grader.rig.recorder import Recorder
from grader.rig.ros import Ros
from grader.rig.watch import Watch
from grader.runner.ending import cut_short
from grader.runner.stopped import Stopped
from grader.runner.student import Student
from grader.runner.task import Task
from grader.scenario.scenario import SECOND, START

#: How far simulated time goes on after the last message, for what a node does by timer.
AFTERWARDS = SECOND // 2


def spin(what: Task, start: Callable[[], Student]) -> Recording:
    """Start the student's program and spin it through the scenario; every fault of the student's is in the recording.

    Anything raised is a fault of the machine's or of ours.
    """
    began = time.monotonic()
    student = start()
    try:
        with Ros(what.domain) as ros:
            return Rig(ros, what, student).run(began)
    finally:
        student.kill()


class Rig:
    """One run: the rig's ends of the graph around one student."""

    def __init__(self, ros: Ros, what: Task, student: Student) -> None:
        self._what, self._student = what, student
        node = ros.node("rig")
        self._clock = Clock(node)
        self._publishers = ReferencePublishers(ros.node("joint_command_publisher"), what.scenario)
        self._recorder = Recorder(node, what.exercise.outputs, self._moment)
        self._graph = Graph(node, ros.names)
        self._watch = Watch(student, Threads(student.pids), Receivers())
        self._fence = Fence(node, self._watch, self._recorder.hear)
        self._nodes: list[str] = []
        self._sim_time = False
        self._met = False
        self._lockstep_seconds = 0.0
        self._end_points: tuple[EndPoint, ...] = ()

    def _moment(self) -> tuple[int, int]:
        return self._clock.now, len(self._publishers.sent)

    def run(self, began: float) -> Recording:
        """The whole run, from the first sign of the node to its end."""
        program = self._what.file_name, self._what.source
        try:
            self._meet()
            self._lockstep()
            ending = interrupted(self._watch, *program) if self._what.scenario.interrupt else Ending("completed")
        except Stopped as stopped:
            ending = Ending(stopped.outcome, stopped.story)
        except Gone:
            ending = cut_short(self._student, *program, self._met, len(self._publishers.sent))
        end_points = self._end_points or self._graph.end_points()
        self._student.kill()  # before the last look at what has come: it may never stop publishing
        self._watch.receivers.wait()
        self._watch.close()
        self._recorder.take()
        return Recording(
            scenario=self._what.scenario.name,
            sent=tuple(self._publishers.sent),
            received=tuple(self._recorder.received),
            nodes=tuple(self._nodes),
            end_points=end_points,
            hold=self._fence.hold if self._met else "none",
            uses_sim_time=self._sim_time,
            ending=ending,
            log=self._student.output().text,
            seconds=time.monotonic() - began,
            lockstep_seconds=self._lockstep_seconds,
        )

    def _meet(self) -> None:
        self._nodes = wait_for_nodes(self._graph, self._fence, self._watch)
        discovery = Discovery(self._watch)
        self._fence.take_hold(self._graph, self._nodes, discovery.ended)
        self._fence.wait(1)
        if self._fence.hold == "parameters":
            self._sim_time = all(self._fence.use_sim_time(node) for node in self._nodes)
        wait_until_connected(discovery, self._fence, self._clock, self._publishers, self._recorder)
        if self._recorder.hears:
            self._recorder.newcomers()
        self._fence.wait(1)
        self._fence.look()
        self._clock.set(START)
        self._fence.wait(AFTER_CLOCK)
        self._met = True

    def _lockstep(self) -> None:
        began = time.monotonic()
        for message in self._what.scenario.messages:
            if message.at > self._clock.now:
                self._keep_pace(began, message.at)
                self._fence.look()
                self._clock.set(message.at)
                self._fence.wait(AFTER_CLOCK)
            came = len(self._recorder.received)
            self._fence.look()
            self._publishers.publish(message)
            self._fence.wait(AFTER_MESSAGES)
            self._let_late_publishers_in(came)
        self._drain()
        self._lockstep_seconds = time.monotonic() - began

    def _let_late_publishers_in(self, came: int) -> None:
        """A node may make a publisher only when it has something to publish; `came` messages had come before."""
        late = self._recorder.newcomers()
        for topic in late:
            let_in(self._watch, self._fence, self._recorder, topic, came)
        if late:
            self._fence.wait(AFTER_MESSAGES)

    def _keep_pace(self, began: float, at: int) -> None:
        if self._what.pace:
            due = began + (at - START) / SECOND / self._what.pace
            time.sleep(max(0.0, due - time.monotonic()))

    def _drain(self) -> None:
        """Let the node finish what it began, and take everything it has published."""
        self._end_points = self._graph.end_points()
        self._fence.look()
        self._clock.set(self._clock.now + AFTERWARDS)
        self._fence.wait(AFTER_CLOCK)
        while True:
            before = len(self._recorder.received)
            self._fence.wait(AFTER_MESSAGES)
            self._let_late_publishers_in(before)
            if len(self._recorder.received) == before:
                return
