"""The rig and the student's node get to know one another."""

from __future__ import annotations

import time

from grader.exercise.interface import Topic
from grader.rig.clock import Clock
from grader.rig.fence import LOOK_S, Fence
from grader.rig.graph import Graph
from grader.rig.patience import Patience
from grader.rig.publishers import ReferencePublishers
from grader.rig.quiet import Receivers
from grader.rig.recorder import Recorder
from grader.rig.stopped import Stopped
from grader.rig.student import Student

#: Importing large libraries takes computing time; nothing that a node needs takes this much.
START_CPU_S, START_BLOCKED_S = 20.0, 3.0

#: How often is looked for a node; on the way from one program to another its name takes a tenth of a second, mostly.
NODE_LOOK_S = 0.005

NO_NODE_BUSY = f"Your program computed for {START_CPU_S:g} s and created no node. Is there an endless loop before it?"
NO_NODE_BLOCKED = (
    "Your program waits and creates no node. Does something wait or sleep before the node is created, and is main() "
    "called?"
)


def wait_for_nodes(graph: Graph, fence: Fence, student: Student) -> list[str]:
    """The student's nodes, once there is one. Raises `Stopped` when none appears and `Gone` when the program ends."""
    patience = Patience(student, START_CPU_S, START_BLOCKED_S)
    while not (nodes := graph.nodes()):
        fence.alive()
        which = patience.ended()
        if which:
            raise Stopped("timed-out", NO_NODE_BUSY if which == "cpu" else NO_NODE_BLOCKED)
        time.sleep(NODE_LOOK_S)
    return nodes


def wait_until_connected(
    student: Student, fence: Fence, clock: Clock, publishers: ReferencePublishers, recorder: Recorder
) -> None:
    """Wait until every topic has found its other end, or until it is clear that some never will.

    A topic of another name or type never does; the checks tell that from the graph.
    """
    patience = Patience(student, cpu_s=5.0, blocked_s=0.3)
    while not (publishers.heard and recorder.hears and clock.heard):
        fence.alive()
        if patience.ended():
            return
        time.sleep(LOOK_S)
        recorder.adapt()


#: What was published before its two ends knew one another is sent again within this time, in which neither the rig nor
#: the program has anything to do but wait. A look counts for this much of it at most, however late it came.
SENT_AGAIN_S, COUNTS_S = 0.4, 0.01


def let_in(student: Student, fence: Fence, receivers: Receivers, recorder: Recorder, topic: Topic, came: int) -> None:
    """Wait until a publisher of `topic`, which the student's node has made only now, has found the recorder, if it ever
    will, and has sent again what it has already published: something other than the first `came` messages."""

    def found() -> bool:
        return recorder.hears_all(topic)

    def sent_again() -> bool:
        return recorder.since(came, topic)

    for done in (found, sent_again):
        patience = Patience(student, cpu_s=5.0, blocked_s=5.0)
        quiet, looked = 0.0, time.monotonic()
        while not done() and quiet < SENT_AGAIN_S and not patience.ended():
            fence.alive()
            time.sleep(LOOK_S)
            recorder.adapt()
            recorder.hear()
            now = time.monotonic()
            if not student.runnable_threads() and not receivers.at_work():
                quiet += min(now - looked, COUNTS_S)
            looked = now
