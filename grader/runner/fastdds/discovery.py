"""Lets the rig and the student's node discover each other."""

from __future__ import annotations

import time

from grader.exercise.exercise import Topic
from grader.runner.fastdds.barrier import CHECK_S, LOOK_S, Barrier
from grader.runner.fastdds.budget import IdleTime, TimeBudget, Watch
from grader.runner.fastdds.graph import Graph
from grader.runner.fastdds.ros import Clock, Recorder, ReferencePublishers
from grader.runner.stopped import Stopped

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


#: Graph data that got lost on its way is sent again once a second (Fast DDS 2.14, `edp_heartbeat_period`).
TOLD_AGAIN_S = 1.5

#: A program that computes for this long (s) is not about to change the graph.
BUSY_S = 5.0


class Discovery:
    """Ends after `idle_s` idle seconds: by then the rig must have all graph data that exists or is in transit."""

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
    while not (publishers.heard and recorder.hears and clock.heard):
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
        return recorder.hears_all(topic)

    def sent_again() -> bool:
        return recorder.since(came, topic)

    for done in (found, sent_again):
        discovery = Discovery(watch, SENT_AGAIN_S)
        while not done() and not discovery.ended():
            barrier.alive()
            time.sleep(LOOK_S)
            recorder.adapt()
            recorder.hear()
