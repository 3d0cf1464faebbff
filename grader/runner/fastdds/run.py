"""Runs one program through one scenario over Fast DDS, in step with simulated time."""

from __future__ import annotations

import time
from collections.abc import Callable

from grader.exercise.exercise import Topic
from grader.recording.recording import Ending, EndPoint, Recording
from grader.runner.ending import MAY_TAKE_S, cut_short
from grader.runner.fastdds.barrier import AFTER_CLOCK, AFTER_MESSAGES, CHECK_S, LOOK_S, Barrier, Gone
from grader.runner.fastdds.graph import Graph
from grader.runner.fastdds.idle import IdleTime, Receivers, Threads, TimeBudget, Watch
from grader.runner.fastdds.ros import Clock, Recorder, ReferencePublishers, Ros
from grader.runner.student import Stopped, Student, Task
from grader.runner.tracebacks import error_on_interrupt
from grader.scenario.scenario import SECOND, START


def interrupted(watch: Watch, file_name: str, source: str) -> Ending:
    """Ask the program to end, as Ctrl-C does, and return how it ends."""
    student = watch.student
    before = student.output().text
    student.interrupt()
    budget = TimeBudget(watch, cpu_s=MAY_TAKE_S, blocked_s=MAY_TAKE_S)
    while student.wait(0.02) is None:
        budget.look()
        if budget.blocked + budget.cpu >= MAY_TAKE_S:
            return Ending("completed", interrupted=True, ended_in_time=False)
    error = error_on_interrupt(before, student.output().text, file_name, source)
    return Ending("completed", interrupted=True, traceback=error)


#: How long simulated time continues after the last message, for what a node does by timer.
AFTERWARDS = SECOND // 2


def run(task: Task, start: Callable[[], Student]) -> Recording:
    """Start the student's program and run it through the scenario; every fault of the program is in the recording.

    Any exception is a fault of the machine or of ours.
    """
    began = time.monotonic()
    student = start()
    try:
        with Ros(task.domain) as ros:
            return Run(ros, task, student).run(began)
    finally:
        student.kill()


class Run:
    """One run: the runner's ends of the graph around one student."""

    def __init__(self, ros: Ros, task: Task, student: Student) -> None:
        self._task, self._student = task, student
        node = ros.node("runner")
        self._clock = Clock(node)
        self._publishers = ReferencePublishers(ros.node(task.exercise.reference_node), task.scenario)
        self._recorder = Recorder(node, task.exercise.outputs, self._moment)
        self._graph = Graph(node, ros.names)
        self._watch = Watch(student, Threads(student.pids), Receivers())
        self._barrier = Barrier(node, self._watch, self._recorder.receive)
        self._nodes: list[str] = []
        self._sim_time = False
        self._met = False
        self._lockstep_seconds = 0.0
        self._end_points: tuple[EndPoint, ...] = ()

    def _moment(self) -> tuple[int, int]:
        return self._clock.now, len(self._publishers.sent)

    def run(self, began: float) -> Recording:
        """Do the whole run, from the first sign of the node to its end."""
        program = self._task.file_name, self._task.source
        try:
            self._discover()
            self._lockstep()
            ending = interrupted(self._watch, *program) if self._task.scenario.interrupt else Ending("completed")
        except Stopped as stopped:
            ending = Ending(stopped.outcome, stopped.message)
        except Gone:
            ending = cut_short(self._student, *program, self._met, f"at message {len(self._publishers.sent)}")
        end_points = self._end_points or self._graph.end_points()
        nodes = self._nodes if self._met else sorted({*self._nodes, *self._graph.nodes()})  # one was enough to begin
        self._student.kill()  # before the last look at what has arrived: it may never stop publishing
        self._watch.receivers.wait()
        self._watch.close()
        self._recorder.take()
        return Recording(
            scenario=self._task.scenario.name,
            sent=tuple(self._publishers.sent),
            received=tuple(self._recorder.received),
            nodes=tuple(nodes),
            end_points=end_points,
            synchronization=self._barrier.synchronization if self._met else "none",
            uses_sim_time=self._sim_time,
            ending=ending,
            log=self._student.output().text,
            seconds=time.monotonic() - began,
            lockstep_seconds=self._lockstep_seconds,
        )

    def _discover(self) -> None:
        self._nodes = wait_for_nodes(self._graph, self._barrier, self._watch)
        discovery = Discovery(self._watch)
        self._barrier.choose_method(self._graph, self._nodes, discovery.ended)
        self._barrier.wait(1)
        if self._barrier.synchronization == "parameters":
            self._sim_time = all(self._barrier.use_sim_time(node) for node in self._nodes)
        wait_until_connected(discovery, self._barrier, self._clock, self._publishers, self._recorder)
        if self._recorder.is_connected:
            self._recorder.new_publishers()
        self._barrier.wait(1)
        self._barrier.look()
        self._clock.set(START)
        self._barrier.wait(AFTER_CLOCK)
        self._met = True

    def _lockstep(self) -> None:
        began = time.monotonic()
        for message in self._task.scenario.messages:
            if message.at > self._clock.now:
                self._keep_pace(began, message.at)
                self._barrier.look()
                self._clock.set(message.at)
                self._barrier.wait(AFTER_CLOCK)
            came = len(self._recorder.received)
            self._barrier.look()
            self._publishers.publish(message)
            self._barrier.wait(AFTER_MESSAGES)
            self._wait_for_late_publishers(came)
        self._drain()
        self._lockstep_seconds = time.monotonic() - began

    def _wait_for_late_publishers(self, came: int) -> None:
        """Wait for publishers that the node creates only when it has something to publish, after `came` messages."""
        late = self._recorder.new_publishers()
        for topic in late:
            wait_for_publisher(self._watch, self._barrier, self._recorder, topic, came)
        if late:
            self._barrier.wait(AFTER_MESSAGES)

    def _keep_pace(self, began: float, at: int) -> None:
        if self._task.pace:
            due = began + (at - START) / SECOND / self._task.pace
            time.sleep(max(0.0, due - time.monotonic()))

    def _drain(self) -> None:
        """Let the node finish what it began, and take everything it has published."""
        self._end_points = self._graph.end_points()
        self._barrier.look()
        self._clock.set(self._clock.now + AFTERWARDS)
        self._barrier.wait(AFTER_CLOCK)
        while True:
            before = len(self._recorder.received)
            self._barrier.wait(AFTER_MESSAGES)
            self._wait_for_late_publishers(before)
            if len(self._recorder.received) == before:
                return


#: Importing large libraries takes CPU time; nothing that a node needs takes this much.
START_CPU_S, START_BLOCKED_S = 20.0, 3.0

#: How often to look for a node; its name mostly takes a tenth of a second from one program to another.
NODE_LOOK_S = 0.005

NO_NODE_BUSY = f"Your program computed for {START_CPU_S:g} s and created no node. Is there an endless loop before it?"
NO_NODE_BLOCKED = (
    "Your program waits and creates no node. Does something wait or sleep before the node is created, and is main() "
    "called?"
)


def wait_for_nodes(graph: Graph, barrier: Barrier, watch: Watch) -> list[str]:
    """Return the student's nodes, once there is one. Raises `Stopped` if none appears, `Gone` if the program ends."""
    budget, idle_time = TimeBudget(watch), IdleTime(watch)
    due = time.monotonic() + CHECK_S
    while not (nodes := graph.nodes()):
        barrier.alive()
        time.sleep(NODE_LOOK_S)
        if time.monotonic() < due:
            continue
        if budget.cpu >= START_CPU_S and not watch.student.at_limit():
            raise Stopped("timed-out", NO_NODE_BUSY)
        if idle_time.look() >= START_BLOCKED_S:
            raise Stopped("timed-out", NO_NODE_BLOCKED)
        due = time.monotonic() + CHECK_S
    return nodes


#: Graph data that got lost on its way is sent again once per second (Fast DDS 2.14, `edp_heartbeat_period`).
TOLD_AGAIN_S = 1.5

#: A program that computes for this long (s) is not about to change the graph.
BUSY_S = 5.0


class Discovery:
    """Ends after `idle_s` idle seconds: by then the runner must have all graph data that exists or is in transit."""

    def __init__(self, watch: Watch, idle_s: float = TOLD_AGAIN_S) -> None:
        self._idle_s = idle_s
        self._idle_time = IdleTime(watch)
        self._budget = TimeBudget(watch)
        self._due = time.monotonic()

    def ended(self) -> bool:
        """Return whether it has ended; to be called repeatedly. It looks as often as needed, and no more."""
        if time.monotonic() < self._due:
            return False
        self._due = time.monotonic() + CHECK_S
        return self._idle_time.look() >= self._idle_s or self._budget.cpu >= BUSY_S


def wait_until_connected(
    discovery: Discovery, barrier: Barrier, clock: Clock, publishers: ReferencePublishers, recorder: Recorder
) -> None:
    """Wait until every topic has found its other end, or until it is clear that some never will.

    A topic with another name or type never does; the checks see that in the graph.
    """
    while not (publishers.have_subscribers and recorder.is_connected and clock.has_subscriber):
        barrier.alive()
        if discovery.ended():
            return
        time.sleep(LOOK_S)
        recorder.adapt()


#: What was published before its two ends knew each other is sent again within this much idle time.
SENT_AGAIN_S = 0.4


def wait_for_publisher(watch: Watch, barrier: Barrier, recorder: Recorder, topic: Topic, came: int) -> None:
    """Wait until a publisher of `topic`, which the student's node has only just created, has found the recorder, if it
    ever will, and has sent again what it has already published: something other than the first `came` messages."""

    def found() -> bool:
        return recorder.is_connected_to_all(topic)

    def sent_again() -> bool:
        return recorder.since(came, topic)

    for done in (found, sent_again):
        discovery = Discovery(watch, SENT_AGAIN_S)
        while not done() and not discovery.ended():
            barrier.alive()
            time.sleep(LOOK_S)
            recorder.adapt()
            recorder.receive()
