"""Waits until a program is ready: it has created its nodes and begins to spin them."""

from __future__ import annotations

from collections.abc import Callable

from grader.runner.budget import BLOCKED_S, Allowance
from grader.runner.stopped import Stopped
from grader.scenario.scenario import SECOND
from rmw_lockstep.hub import Hub

#: Importing large libraries takes CPU time; nothing that a node needs takes this much. A student with an endless loop
#: waits this long for the check to say so.
START_CPU_S = 6.0

#: How long a program may sleep before it makes a node, or spins it, by the computer's clock (ns).
LONGEST = 10 * SECOND

#: How long to wait for the subscriptions of a node that spins (ns).
LONGEST_FOR_SUBSCRIPTIONS = 3 * SECOND // 2

NO_NODE_BUSY = f"Your program computed for {START_CPU_S:g} s and created no node. Is there an endless loop before it?"
NOT_SPUN_BUSY = (
    f"Your program created its node, then computed for {START_CPU_S:g} s and did not spin it. Is there an endless loop "
    "before rclpy.spin(node), such as in __init__?"
)
NO_NODE_BLOCKED = (
    "Your program waits and creates no node. Does something wait or sleep before the node is created, and is main() "
    "called?"
)

START = Allowance(NO_NODE_BUSY, NO_NODE_BLOCKED, START_CPU_S, BLOCKED_S)


def wait_until_up(hub: Hub, connected: Callable[[], bool], has_nodes: Callable[[], bool]) -> None:
    """Let the computer's time pass until the program has a node that is ready.

    A node is ready when it has its subscriptions (`connected`), or spins and has had time to create them. `has_nodes`
    returns whether the program has created any.

    Raises:
        Stopped: when there will be no node.
    """
    try:
        _wait_until_up(hub, connected, has_nodes)
    except Stopped as stopped:
        if stopped.story == NO_NODE_BUSY and has_nodes():
            raise Stopped(stopped.outcome, NOT_SPUN_BUSY) from None
        raise


def _wait_until_up(hub: Hub, connected: Callable[[], bool], has_nodes: Callable[[], bool]) -> None:
    began = hub.now
    hub.wait_until_idle()
    while not (has_nodes() and connected()):
        wakes = hub.next
        longest = LONGEST_FOR_SUBSCRIPTIONS if has_nodes() and hub.in_ros else LONGEST
        if wakes is None or wakes > began + longest:
            break
        hub.advance(wakes)
        hub.wait_until_idle()
    if not has_nodes():
        raise Stopped("did-not-start" if hub.next is None else "timed-out", NO_NODE_BLOCKED)
