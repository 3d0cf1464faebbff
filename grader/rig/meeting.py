"""The rig and the student's node get to know one another."""

from __future__ import annotations

import time

from grader.exercise.interface import Topic
from grader.rig.clock import Clock
from grader.rig.fence import CHECK_S, LOOK_S, Fence
from grader.rig.graph import Graph
from grader.rig.patience import Calm, Patience
from grader.rig.publishers import ReferencePublishers
from grader.rig.recorder import Recorder
from grader.rig.watch import Watch
from grader.runner.stopped import Stopped

#: Importing large libraries takes computing time; nothing that a node needs takes this much.
START_CPU_S, START_BLOCKED_S = 20.0, 3.0

#: How often is looked for a node; on the way from one program to another its name takes a tenth of a second, mostly.
NODE_LOOK_S = 0.005

NO_NODE_BUSY = f"Your program computed for {START_CPU_S:g} s and created no node. Is there an endless loop before it?"
NO_NODE_BLOCKED = (
    "Your program waits and creates no node. Does something wait or sleep before the node is created, and is main() "
    "called?"
)


def wait_for_nodes(graph: Graph, fence: Fence, watch: Watch) -> list[str]:
    """The student's nodes, once there is one. Raises `Stopped` when none appears and `Gone` when the program ends."""
    patience, calm = Patience(watch), Calm(watch)
    due = time.monotonic() + CHECK_S
    while not (nodes := graph.nodes()):
        fence.alive()
        time.sleep(NODE_LOOK_S)
        if time.monotonic() < due:
            continue
        if patience.cpu >= START_CPU_S and not watch.student.at_limit():
            raise Stopped("timed-out", NO_NODE_BUSY)
        if calm.look() >= START_BLOCKED_S:
            raise Stopped("timed-out", NO_NODE_BLOCKED)
        due = time.monotonic() + CHECK_S
    return nodes


#: What of the graph has got lost on its way is told again once a second (Fast DDS 2.14, `edp_heartbeat_period`).
TOLD_AGAIN_S = 1.5

#: A program that computes this long (s) is not about to make more of the graph.
BUSY_S = 5.0


class Discovery:
    """Ends after `calm_s` seconds of calm: then all that there is, of the graph or on its way, must have been heard."""

    def __init__(self, watch: Watch, calm_s: float = TOLD_AGAIN_S) -> None:
        self._calm_s = calm_s
        self._calm = Calm(watch)
        self._patience = Patience(watch)
        self._due = time.monotonic()

    def ended(self) -> bool:
        """Whether it has; to be asked again and again. It looks as often as the calm needs, and no more."""
        if time.monotonic() < self._due:
            return False
        self._due = time.monotonic() + CHECK_S
        return self._calm.look() >= self._calm_s or self._patience.cpu >= BUSY_S


def wait_until_connected(
    discovery: Discovery, fence: Fence, clock: Clock, publishers: ReferencePublishers, recorder: Recorder
) -> None:
    """Wait until every topic has found its other end, or until it is clear that some never will.

    A topic of another name or type never does; the checks tell that from the graph.
    """
    while not (publishers.heard and recorder.hears and clock.heard):
        fence.alive()
        if discovery.ended():
            return
        time.sleep(LOOK_S)
        recorder.adapt()


#: What was published before its two ends knew one another is sent again within this time of calm.
SENT_AGAIN_S = 0.4


def let_in(watch: Watch, fence: Fence, recorder: Recorder, topic: Topic, came: int) -> None:
    """Wait until a publisher of `topic`, which the student's node has made only now, has found the recorder, if it ever
    will, and has sent again what it has already published: something other than the first `came` messages."""

    def found() -> bool:
        return recorder.hears_all(topic)

    def sent_again() -> bool:
        return recorder.since(came, topic)

    for done in (found, sent_again):
        discovery = Discovery(watch, SENT_AGAIN_S)
        while not done() and not discovery.ended():
            fence.alive()
            time.sleep(LOOK_S)
            recorder.adapt()
            recorder.hear()
